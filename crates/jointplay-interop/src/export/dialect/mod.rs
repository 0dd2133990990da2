//! Controller text: lines from the templates of a dialect file.
//!
//! A template is text with names in braces; `{{` and `}}` represent the braces themselves.
//!
//! | key | written | names |
//! | --- | --- | --- |
//! | `begin`, `end` | once | `cell`, `robot`, `axes`, `positions`, `time` |
//! | `instruction` | before the first motion of each instruction | `number`, `line`, `text` |
//! | `axes`, `line`, `still` | for each motion: of axes, along a line, none; these three or `point` | `number`, `phase`, `time`, `duration`, `positions`, `effector` |
//! | `point` | at equal intervals of time | `number`, `time`, `positions`, `velocities` |
//! | `blend` | between two blended motions | `overlap` |
//! | `taken`, `left` | where a wafer is taken or left | `effector`, `station`, `slot` |
//! | `axis` | for each axis within `positions` and `velocities`, with `between` between them | `name`, `value`, `number` |
//! | `comment` | violations of the motion, before everything else | `text` |

mod problem;
mod template;
mod write;

pub use problem::Problem;
use template::Template;

use jointplay_format::mechanism::{AngleUnit, LengthUnit};
use jointplay_format::place::Errors;
use jointplay_format::toml_reader::{self, Entry};

/// Longest accepted dialect file (bytes).
pub const MAX_BYTES: usize = 100_000;

/// Largest number of decimals.
const MOST_DECIMALS: usize = 12;

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
        let dialect = read(&top);
        top.finish();
        reader.done(dialect)
    }

    /// The neutral dialect.
    #[must_use]
    pub fn neutral() -> Self {
        Self::parse(DIALECTS[0].text).expect("the included dialect is valid, as a test checks")
    }
}

type Reader<'a> = toml_reader::Reader<'a, Problem>;
type Table<'r, 'a> = toml_reader::Table<'r, 'a, Problem>;

fn read(top: &Table) -> Option<Dialect> {
    let reader = top.reader;
    let text = |key| top.needed(key)?.text(reader).map(str::to_owned);
    let (name, about, between) = (text("name"), text("about"), text("between"));
    let extension = top.needed("extension").and_then(|entry| extension(reader, &entry));
    let length = unit(top, "length", &LengthUnit::ALL);
    let angle = unit(top, "angle", &AngleUnit::ALL);
    let decimals = |key| top.needed(key)?.count(reader, 0, MOST_DECIMALS);
    let (decimals, time_decimals) = (decimals("decimals"), decimals("time_decimals"));
    let one = |key, known| template(reader, &top.needed(key)?, known);
    let axis = one("axis", template::AXIS);
    let comment = one("comment", template::COMMENT);
    let all = |key, known| {
        top.entry(key).map_or_else(|| Some(Vec::new()), |entry| templates(reader, &entry, known))
    };
    let begin = all("begin", template::ENDS);
    let instruction = all("instruction", template::INSTRUCTION);
    let motion = motions(top);
    let blend = all("blend", template::BLEND);
    let taken = all("taken", template::WAFER);
    let left = all("left", template::WAFER);
    let end = all("end", template::ENDS);
    Some(Dialect {
        name: name?,
        about: about?,
        extension: extension?,
        length: length?,
        angle: angle?,
        decimals: decimals?,
        time_decimals: time_decimals?,
        axis: axis?,
        between: between?,
        comment: comment?,
        begin: begin?,
        instruction: instruction?,
        motion: motion?,
        blend: blend?,
        taken: taken?,
        left: left?,
        end: end?,
    })
}

fn template(reader: &Reader, entry: &Entry, known: &'static [&'static str]) -> Option<Template> {
    let read = Template::parse(entry.text(reader)?, known);
    read.map_err(|problem| entry.report(reader, problem)).ok()
}

fn templates(
    reader: &Reader,
    entry: &Entry,
    known: &'static [&'static str],
) -> Option<Vec<Template>> {
    // All templates are read, so that each error is reported.
    let list = entry.list(reader)?;
    let read: Vec<_> = list.iter().map(|one| template(reader, one, known)).collect();
    read.into_iter().collect()
}

fn motions(top: &Table) -> Option<Motions> {
    let list = |entry: Entry, known| templates(top.reader, &entry, known);
    let keys = ["axes", "line", "still", "point"];
    match keys.map(|key| top.entry(key)) {
        [Some(axes), Some(line), Some(still), None] => {
            let step = template::STEP;
            let (axes, line, still) = (list(axes, step), list(line, step), list(still, step));
            Some(Motions::Steps { axes: axes?, line: line?, still: still? })
        }
        [None, None, None, Some(point)] => list(point, template::POINT).map(Motions::Points),
        _ => {
            top.report(Problem::Motions);
            None
        }
    }
}

fn extension(reader: &Reader, entry: &Entry) -> Option<String> {
    let found = entry.text(reader)?.to_owned();
    let plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '.';
    if found.is_empty() || !found.chars().all(plain) {
        entry.report(reader, Problem::Extension { found });
        return None;
    }
    Some(found)
}

fn unit<U: Copy>(top: &Table, key: &'static str, all: &[(&str, U)]) -> Option<U> {
    top.needed(key)?.word(top.reader, &format!("unit of {key}"), all)
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
        refuse(
            "still = [\"WAIT {duration}\"]\n",
            "",
            "either `axes`, `line` and `still`, or `point`",
        );
    }
}
