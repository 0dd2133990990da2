//! Controller text: lines from the templates of a dialect, which is a file and no code.
//!
//! A template is text with names in braces; `{{` and `}}` stand for the braces themselves.
//!
//! | key | written | names |
//! | --- | --- | --- |
//! | `begin`, `end` | once | `cell`, `robot`, `axes`, `positions`, `time` |
//! | `instruction` | before the first motion of each instruction | `number`, `line`, `text` |
//! | `axes`, `line`, `still` | for each motion: of axes, along a line, none; these three or `point` | `number`, `phase`, `time`, `duration`, `positions`, `effector` |
//! | `point` | at even times | `number`, `time`, `positions`, `velocities` |
//! | `blend` | between two motions that run into each other | `overlap` |
//! | `taken`, `left` | where a wafer is taken or left | `effector`, `station`, `slot` |
//! | `axis` | for each axis within `positions` and `velocities`, with `between` between them | `name`, `value`, `number` |
//! | `comment` | what is wrong with the motion, first of all | `text` |

mod problem;
mod template;
mod write;

use serde::Deserialize;
use toml::Spanned;

pub use problem::Problem;
use template::Template;

use jointplay_format::mechanism::{AngleUnit, LengthUnit};
use jointplay_format::place::{Error, read};

/// Longer dialect files are refused, in bytes.
pub const MAX_BYTES: usize = 100_000;

/// Most digits behind the point.
const MOST_DECIMALS: i64 = 12;

/// How a controller is spoken to.
#[derive(Debug, Clone, PartialEq)]
pub struct Dialect {
    /// What it is called.
    pub name: String,
    /// What it is for, in a line.
    pub about: String,
    /// What names of its files end in.
    pub extension: String,
    length: LengthUnit,
    angle: AngleUnit,
    decimals: usize,
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
}

/// How motions are told.
#[derive(Debug, Clone, PartialEq)]
enum Motions {
    /// Each by its end and its duration.
    Steps { axes: Vec<Template>, line: Vec<Template>, still: Vec<Template> },
    /// By points at even times.
    Points(Vec<Template>),
}

/// A dialect that comes along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// What it is called.
    pub name: &'static str,
    /// Its file.
    pub text: &'static str,
}

/// Dialects that come along, the neutral one first.
pub const DIALECTS: [Entry; 2] = [
    Entry { name: "neutral", text: include_str!("neutral.toml") },
    Entry { name: "points", text: include_str!("points.toml") },
];

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    about: String,
    extension: Spanned<String>,
    length: Spanned<String>,
    angle: Spanned<String>,
    decimals: Spanned<i64>,
    time_decimals: Spanned<i64>,
    axis: Spanned<String>,
    between: String,
    comment: Spanned<String>,
    #[serde(default)]
    begin: Vec<Spanned<String>>,
    #[serde(default)]
    instruction: Vec<Spanned<String>>,
    axes: Option<Vec<Spanned<String>>>,
    line: Option<Vec<Spanned<String>>>,
    still: Option<Vec<Spanned<String>>>,
    point: Option<Vec<Spanned<String>>>,
    #[serde(default)]
    blend: Vec<Spanned<String>>,
    #[serde(default)]
    taken: Vec<Spanned<String>>,
    #[serde(default)]
    left: Vec<Spanned<String>>,
    #[serde(default)]
    end: Vec<Spanned<String>>,
}

impl Dialect {
    /// Reads a dialect file.
    ///
    /// # Errors
    /// [`Problem`] with its place: no TOML, unknown keys and names, units that are none, motions told in no way or in two.
    pub fn parse(text: &str) -> Result<Self, Error<Problem>> {
        if text.len() > MAX_BYTES {
            let problem = Problem::TooLong { found: text.len(), allowed: MAX_BYTES };
            return Err(Error::at(text, 0..0, problem));
        }
        let file: File = read(text)?;
        let one = |source: &Spanned<String>, known: &'static [&'static str]| {
            Template::parse(source.get_ref(), known)
                .map_err(|problem| Error::at(text, source.span(), problem))
        };
        let all = |sources: &[Spanned<String>], known: &'static [&'static str]| {
            sources.iter().map(|source| one(source, known)).collect::<Result<Vec<_>, _>>()
        };
        let decimals = |key: &'static str, value: &Spanned<i64>| {
            let found = *value.get_ref();
            match usize::try_from(found) {
                Ok(count) if found <= MOST_DECIMALS => Ok(count),
                _ => Err(Error::at(text, value.span(), Problem::Decimals { key, found })),
            }
        };
        let length = unit(text, "length", &file.length, &LengthUnit::ALL)?;
        let angle = unit(text, "angle", &file.angle, &AngleUnit::ALL)?;
        let plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '.';
        if !file.extension.get_ref().chars().all(plain) || file.extension.get_ref().is_empty() {
            let found = file.extension.get_ref().clone();
            return Err(Error::at(text, file.extension.span(), Problem::Extension { found }));
        }
        let motion = match (&file.axes, &file.line, &file.still, &file.point) {
            (Some(axes), Some(line), Some(still), None) => Motions::Steps {
                axes: all(axes, template::STEP)?,
                line: all(line, template::STEP)?,
                still: all(still, template::STEP)?,
            },
            (None, None, None, Some(point)) => Motions::Points(all(point, template::POINT)?),
            _ => return Err(Error::at(text, 0..0, Problem::Motions)),
        };
        Ok(Self {
            length,
            angle,
            decimals: decimals("decimals", &file.decimals)?,
            time_decimals: decimals("time_decimals", &file.time_decimals)?,
            axis: one(&file.axis, template::AXIS)?,
            comment: one(&file.comment, template::COMMENT)?,
            begin: all(&file.begin, template::ENDS)?,
            instruction: all(&file.instruction, template::INSTRUCTION)?,
            motion,
            blend: all(&file.blend, template::BLEND)?,
            taken: all(&file.taken, template::WAFER)?,
            left: all(&file.left, template::WAFER)?,
            end: all(&file.end, template::ENDS)?,
            name: file.name,
            about: file.about,
            extension: file.extension.into_inner(),
            between: file.between,
        })
    }

    /// The neutral dialect.
    #[must_use]
    pub fn neutral() -> Self {
        Self::parse(DIALECTS[0].text).expect("it is held to this by a test")
    }
}

/// The unit of a name.
fn unit<U: Copy>(
    text: &str,
    key: &'static str,
    name: &Spanned<String>,
    all: &[(&str, U)],
) -> Result<U, Error<Problem>> {
    let found = name.get_ref();
    all.iter().find(|(known, _)| known == found).map(|&(_, unit)| unit).ok_or_else(|| {
        let known: Vec<&str> = all.iter().map(|&(known, _)| known).collect();
        let problem = Problem::Unit { key, found: found.clone(), known: known.join(", ") };
        Error::at(text, name.span(), problem)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dialect_that_comes_along_can_be_read() {
        for entry in DIALECTS {
            assert_eq!(Dialect::parse(entry.text).unwrap().name, entry.name);
        }
        assert_eq!(Dialect::neutral().name, "neutral");
    }

    /// Replaces a line of the neutral dialect, and expects a message at a line.
    #[track_caller]
    fn refuse(from: &str, to: &str, message: &str) {
        let text = DIALECTS[0].text.replace(from, to);
        assert_ne!(text, DIALECTS[0].text);
        let error = Dialect::parse(&text).unwrap_err();
        let shown = error.with_excerpt("x.toml");
        assert!(shown.contains(message), "{shown}");
        assert!(to.is_empty() || shown.contains(to.lines().next().unwrap()), "{shown}");
    }

    #[test]
    fn what_is_no_dialect_is_refused_at_its_place() {
        refuse("length = \"mm\"", "length = \"furlong\"", "known: ");
        refuse("angle = \"deg\"", "angle = \"turns\"", "known: ");
        refuse("WAIT {duration}", "WAIT {durations}", "did you mean `duration`");
        refuse("WAIT {duration}", "WAIT {duration", "ends without");
        refuse("WAIT {duration}", "WAIT duration}", "}}");
        refuse("\ndecimals = 6", "\ndecimals = 20", "0 to 12");
        refuse("extension = \"txt\"", "extension = \"../x\"", "letters and digits");
        refuse("still =", "stil =", "unknown key");
        refuse(
            "still = [\"WAIT {duration}\"]\n",
            "",
            "either `axes`, `line` and `still`, or `point`",
        );
    }
}
