//! Text and JSON on standard output, and the formatting of numbers in text.

use std::fmt::Write as _;
use std::io::{ErrorKind, Write};

use clap::{Args, ValueEnum};
use jointplay::format::number::{fixed, rounded};
use jointplay::report::{BallClearanceReport, LimitReport, VirtualJointGroups};
use serde::Serialize;

use crate::console;
use crate::failure::Failure;

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TextFormat {
    /// text for reading
    Text,
    /// a JSON document for other programs
    Json,
}

/// The format of the answer on standard output; every command has it.
#[derive(Args, Clone, Copy)]
pub(crate) struct FormatArgs {
    /// Output format of the answer and of errors
    #[arg(long, global = true, value_enum, default_value = "text")]
    format: TextFormat,
}

impl FormatArgs {
    pub(crate) fn json(self) -> bool {
        self.format == TextFormat::Json
    }

    /// Prints a report: as a JSON document, or as the text that `text` makes of it.
    pub(crate) fn print<R: Serialize>(
        self,
        report: &R,
        text: impl FnOnce(&R) -> String,
    ) -> Result<(), Failure> {
        if self.json() { json(report) } else { self::text(&text(report)) }
    }
}

/// Prints text; a heading is a line that starts without a space.
pub(crate) fn text(text: &str) -> Result<(), Failure> {
    let bold = anstyle::Style::new().bold();
    let mut shown = String::with_capacity(text.len());
    for line in text.lines() {
        let heading = !line.is_empty() && !line.starts_with(' ');
        let written = if heading {
            writeln!(shown, "{bold}{line}{bold:#}")
        } else {
            writeln!(shown, "{line}")
        };
        written.expect("writing into memory does not fail");
    }
    all(anstream::stdout().lock(), &shown)
}

/// Prints a document as JSON.
pub(crate) fn json(document: &impl Serialize) -> Result<(), Failure> {
    raw(&format!("{}\n", to_json(document)))
}

/// A document as JSON text.
pub(crate) fn to_json(document: &impl Serialize) -> String {
    serde_json::to_string_pretty(document).expect("documents have string keys only")
}

/// Prints text without formatting.
pub(crate) fn raw(text: &str) -> Result<(), Failure> {
    all(std::io::stdout().lock(), text)
}

/// Writes all of a text, or as much of it as the reader wants: one that closes the pipe does not change the result of the command.
fn all(mut stdout: impl Write, text: &str) -> Result<(), Failure> {
    let written = stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush());
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => Ok(written?),
    }
}

/// Lists on standard error the elements of a model that were ignored.
pub(crate) fn ignored(elements: &[String]) {
    for element in elements {
        console::note(&format!("ignored: {element}"));
    }
}

/// Lines with the exceeded limits; empty for none.
pub(crate) fn limits(broken: &[LimitReport]) -> String {
    let mut text = String::new();
    if !broken.is_empty() {
        text.push_str("limits exceeded (ignored)\n");
        for limit in broken {
            let _ = writeln!(text, "  {}", limit.message);
        }
    }
    text
}

/// The clearance that a pose needs, and whether it is available.
pub(crate) fn ball_clearance(report: &BallClearanceReport) -> String {
    let [lower, upper] = [report.lower_bound_um, report.upper_bound_um].map(|um| fixed(um, 3));
    let needed = if lower == upper {
        format!("{upper} µm needed")
    } else {
        format!(
            "{upper} µm needed where the model places the platform, at least {lower} µm anywhere"
        )
    };
    let available = match (report.available_um, report.is_sufficient) {
        (Some(um), Some(true)) => format!("{} µm available: sufficient", rounded(um, 3)),
        (Some(um), Some(false)) => format!("{} µm available: too small", rounded(um, 3)),
        (Some(um), None) => format!("{} µm available: not decided", rounded(um, 3)),
        (None, _) => "none in the robot file".to_owned(),
    };
    format!(
        "balls, displacement from the centres of their sockets\n  displacement (µm)    {}\n  radial clearance     {needed}; {available}\n",
        three(&report.displacements_um, 3)
    )
}

/// Three numbers in columns.
pub(crate) fn three(values: &[f64], decimals: usize) -> String {
    values.iter().map(|&value| format!("{:>14}", fixed(value, decimals))).collect()
}

/// A number with a prefix, such as 3.21 M.
pub(crate) fn short(value: f64) -> String {
    for (factor, prefix) in [(1e12, " T"), (1e9, " G"), (1e6, " M"), (1e3, " k")] {
        if value >= factor {
            return format!("{:.3}{prefix}", value / factor);
        }
    }
    format!("{value:.0}")
}

/// A singular value, nine characters wide, with an exponent if it is small.
pub(crate) fn magnitude(value: f64) -> String {
    if value == 0.0 || value >= 1e-3 { format!("{value:>9.6}") } else { format!("{value:>9.2e}") }
}

/// The characteristic length, if there are angular joints.
pub(crate) fn characteristic_length(joints: &VirtualJointGroups, length_mm: f64) -> String {
    if joints.0.iter().any(|(name, _)| name.ends_with("_deg")) {
        format!(", characteristic length {} mm", rounded(length_mm, 6))
    } else {
        String::new()
    }
}
