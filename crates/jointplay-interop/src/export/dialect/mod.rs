//! Controller text: lines from the templates of a dialect file.
//!
//! A template is text with fields in braces: a name or an expression of numbers, and a format, as in `{slot:02}` or `{1000 * duration:.0f}`; `{{` and `}}` represent the braces themselves.
//!
//! | key | written | names |
//! | --- | --- | --- |
//! | `begin`, `end` | once | `cell`, `robot`, `axes`, `positions`, `time` |
//! | `instruction` | before the first motion of each instruction | `number`, `line`, `text` |
//! | `axes`, `line`, `still` | for each motion: of axes, along a line, none; these three or `point` | `number`, `phase`, `time`, `duration`, `positions`, `effector` |
//! | `point` | at equal intervals of time | `number`, `time`, `positions`, `velocities` |
//! | `blend` | between two blended motions | `overlap` |
//! | `taken`, `left` | where a wafer is taken or left | `effector`, `station`, `slot`, `effector_code`, `station_code` |
//! | `axis` | for each axis within `positions` and `velocities`, with `between` between them | `name`, `value`, `number` |
//! | `comment` | violations of the motion, before everything else | `text` |
//!
//! The table `[output]` has the form of the lines, with numbers and checksums; `[station_codes]` and `[effector_codes]` have the codes of the controller for the names of the cell.

mod checksum;
mod codes;
mod format_spec;
mod output;
mod problem;
mod read;
mod template;
mod write;

pub use problem::Problem;

use codes::Codes;
use jointplay_format::mechanism::{AngleUnit, LengthUnit};
use jointplay_format::place::Errors;
use output::OutputFormat;
use read::{Reader, Table};
use template::Template;

/// Longest accepted dialect file (bytes).
pub const MAX_BYTES: usize = 100_000;

/// Language of a controller.
#[derive(Debug, Clone, PartialEq)]
pub struct Dialect {
    /// Name of the dialect.
    pub name: String,
    /// Purpose of the dialect, in one line.
    pub about: String,
    /// Extension of its files.
    pub extension: String,
    length: LengthUnit,
    angle: AngleUnit,
    time_decimals: usize,
    axis: Template,
    between: String,
    comment: Template,
    begin: Vec<Template>,
    instruction: Vec<Template>,
    motion: Motions,
    blend: Vec<Template>,
    taken: Vec<Template>,
    left: Vec<Template>,
    end: Vec<Template>,
    station_codes: Option<Codes>,
    effector_codes: Option<Codes>,
    output: OutputFormat,
}

/// Description of motions.
#[derive(Debug, Clone, PartialEq)]
enum Motions {
    /// By the end and the duration of each motion.
    Steps { axes: Vec<Template>, line: Vec<Template>, still: Vec<Template> },
    /// By points at equal intervals of time.
    Points(Vec<Template>),
}

/// An included dialect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IncludedDialect {
    /// Name of the dialect.
    pub name: &'static str,
    /// Text of its file.
    pub text: &'static str,
}

/// The included dialects, the neutral one first.
pub const DIALECTS: [IncludedDialect; 2] = [
    IncludedDialect { name: "neutral", text: include_str!("neutral.toml") },
    IncludedDialect { name: "points", text: include_str!("points.toml") },
];

impl Dialect {
    /// Reads a dialect file.
    ///
    /// # Errors
    /// All errors in the order of their places, at least one: invalid TOML, missing and unknown keys, unknown names and units, motions described in no manner or in two.
    pub fn parse(text: &str) -> Result<Self, Errors<Problem>> {
        let reader = Reader::new(text);
        if !reader.has_at_most(MAX_BYTES) {
            return reader.done(None);
        }
        let document = reader.parse();
        let top = Table::new(&reader, "a dialect", document.get_ref(), 0..0);
        let dialect = read::read(&top);
        top.finish();
        reader.done(dialect)
    }

    /// The neutral dialect.
    #[must_use]
    pub fn neutral() -> Self {
        Self::parse(DIALECTS[0].text).expect("the included dialect is valid, as a test checks")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_included_dialect_is_valid() {
        for entry in DIALECTS {
            assert_eq!(Dialect::parse(entry.text).unwrap().name, entry.name);
        }
        assert_eq!(Dialect::neutral().name, "neutral");
    }

    /// Replaces a line of the neutral dialect, and checks an error message.
    #[track_caller]
    fn refuse(from: &str, to: &str, message: &str) {
        let text = DIALECTS[0].text.replace(from, to);
        assert_ne!(text, DIALECTS[0].text);
        let errors = Dialect::parse(&text).unwrap_err();
        let shown: Vec<String> = errors.iter().map(|error| error.with_excerpt("x.toml")).collect();
        let shown = shown.join("\n");
        assert!(shown.contains(message), "{shown}");
        assert!(to.is_empty() || shown.contains(to.lines().next().unwrap()), "{shown}");
    }

    #[test]
    fn invalid_dialects_are_rejected_with_the_place_of_each_error() {
        refuse("length = \"mm\"", "length = \"furlong\"", "known: ");
        refuse("angle = \"deg\"", "angle = \"turns\"", "known: ");
        refuse("WAIT {duration}", "WAIT {durations}", "did you mean `duration`");
        refuse("WAIT {duration}", "WAIT {duration", "ends without");
        refuse("WAIT {duration}", "WAIT duration}", "}}");
        refuse("\ndecimals = 6", "\ndecimals = 20", "from 0 to 12");
        refuse("extension = \"txt\"", "extension = \"../x\"", "letters and digits");
        refuse("still =", "stil =", "unknown key");
        refuse("WAIT {duration}", "WAIT {duration:d}", "not a format of a number with decimals");
        refuse("{station} {slot}", "{station_code} {slot}", "needs the table `[station_codes]`");
        let output = |table: &str| format!("end = [\"END {{time}}\"]\n{table}");
        for (table, message) in [
            ("[output]\nchecksum = \"crc\"", "known: xor, sum, lrc, crc-16/xmodem"),
            ("[output]\nline = \"{text}*{checksum}\"", "`{checksum}` needs the key `checksum`"),
            ("[output]\nlast = [\"{checksum}\"]", "needs the key `file_checksum`"),
            ("[output]\nline_end = \"cr\"", "known: lf, crlf"),
            ("[output]\ncover = \"x\"", "did you mean `covered`?"),
            ("[output]\nexcept = [1]", "has to be a text"),
            ("[station_codes]\nLP1 = 1\nLP2 = \"P2\"", "all texts, or all whole numbers"),
            ("[station_codes]\nLP1 = 1.5", "a whole number"),
        ] {
            let text = DIALECTS[0].text.replace("end = [\"END {time}\"]", &output(table));
            let errors = Dialect::parse(&text).unwrap_err().with_excerpt("x.toml");
            assert!(errors.contains(message), "{table}: {errors}");
        }
        refuse(
            "still = [\"WAIT {duration}\"]\n",
            "",
            "either `axes`, `line` and `still`, or `point`",
        );
    }
}
