//! `jointplay cell run`: report, samples and pictures of a program.

use std::collections::BTreeSet;
use std::path::PathBuf;

use clap::Args;
use jointplay::format::number::counted;
use jointplay::interop::export::SampleOptions;

use super::export::{Rate, csv, rate};
use super::input::InputArgs;
use super::pictures::{PICTURES, pictures};
use super::text;
use crate::failure::Failure;
use crate::folder::{self, ForceArgs, Staged};
use crate::output;

const REPORT: &str = "report.json";
const SAMPLES: &str = "samples.csv";

/// Simulate a program and write its report, samples, top view and timing diagram
///
/// The samples of a program with violations are written only with --despite-errors; report and pictures are always written, and show the violations.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell run
  jointplay cell run --rate 1000 --out fine-run --format json

Exit codes: 0 no violations, 1 violations or unreachable, 2 bad input or usage, 130 interrupted.")]
pub(super) struct Run {
    #[command(flatten)]
    pub(super) input: InputArgs,
    /// Sampling rate
    #[arg(long, value_name = "HZ", default_value = "100", value_parser = rate)]
    rate: Rate,
    /// Folder for the results
    #[arg(short, long, value_name = "FOLDER", default_value = "cell-run")]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArgs,
    /// Also write the samples of a program with violations; a column counts the violations
    #[arg(long)]
    despite_errors: bool,
}

impl Run {
    pub(super) fn run(&self) -> Result<(), Failure> {
        folder::check_folder(&self.out, self.force)?;
        let own: BTreeSet<String> =
            PICTURES.into_iter().chain([REPORT, SAMPLES]).map(str::to_owned).collect();
        let planned = self.input.plan()?;
        let document = planned.document();
        let mut files = vec![(REPORT.to_owned(), (output::to_json(&document) + "\n").into_bytes())];
        files.extend(pictures(&planned)?);
        let mut staged = Staged::into(&self.out, self.force)?;
        for (name, bytes) in &files {
            staged.add(name, |writer| Ok(writer.write_all(bytes)?))?;
        }
        if planned.passed() || self.despite_errors {
            let options = SampleOptions::at_rate(self.rate.0);
            csv(&mut staged, SAMPLES, &planned.motion_export(), &options)?;
            files.push((SAMPLES.to_owned(), Vec::new()));
        }
        staged.publish()?;
        folder::remove_stale(&self.out, &own, &files)?;
        if self.input.format().json() {
            output::json(&document)?;
        } else {
            let mut text = text::report(&document, &planned);
            let written = counted(files.len(), "file");
            text.push_str(&format!("{written} written into {}\n", self.out.display()));
            output::text(&text)?;
        }
        planned.exit()
    }
}
