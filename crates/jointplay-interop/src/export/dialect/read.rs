//! Reader of dialect files.

use jointplay_format::place::Errors;
use jointplay_format::toml_reader::{Entry, read_document};

use super::included::DIALECTS;
use super::language::{Dialect, Motions};
use super::pose::POSE;
use crate::controller_text::{
    AxisFormat, Codes, Kind, Names, Problem, Reader, Table, TemplateTable,
};

/// Longest accepted dialect file (bytes).
pub const MAX_BYTES: usize = 100_000;

// Names that a template may contain, by kind of template.
/// Names of the poses of all effectors, which the template `pose` defines.
const POSES: (&str, &str) = ("poses", "the key `pose`");
const ENDS: [(&str, Kind); 5] = [
    ("cell", Kind::Text),
    ("robot", Kind::Text),
    ("axes", Kind::Text),
    ("positions", Kind::Text),
    ("time", Kind::Time),
];
const INSTRUCTION: [(&str, Kind); 3] =
    [("number", Kind::Integer), ("line", Kind::Integer), ("text", Kind::Text)];
const STEP: [(&str, Kind); 6] = [
    ("number", Kind::Integer),
    ("phase", Kind::Text),
    ("time", Kind::Time),
    ("duration", Kind::Time),
    ("positions", Kind::Text),
    ("effector", Kind::Text),
];
const BLEND: [(&str, Kind); 1] = [("overlap", Kind::Time)];
const POINT: [(&str, Kind); 4] = [
    ("number", Kind::Integer),
    ("time", Kind::Time),
    ("positions", Kind::Text),
    ("velocities", Kind::Text),
];
const HANDOFF: [(&str, Kind); 3] =
    [("effector", Kind::Text), ("station", Kind::Text), ("slot", Kind::Integer)];
const COMMENT: [(&str, Kind); 1] = [("text", Kind::Text)];

impl Dialect {
    /// Reads a dialect file.
    ///
    /// # Errors
    /// All errors in the order of their places, at least one: invalid TOML, missing and unknown keys, unknown names and units, motions described in no manner or in two.
    pub fn parse(text: &str) -> Result<Self, Errors<Problem>> {
        read_document(text, MAX_BYTES, "a dialect", |top| {
            let dialect = read(top);
            top.finish();
            dialect
        })
    }

    /// The neutral dialect.
    #[must_use]
    pub fn neutral() -> Self {
        Self::parse(DIALECTS[0].text).expect("the included dialect is valid, as a test checks")
    }
}

fn read(top: &Table<'_, '_>) -> Option<Dialect> {
    let reader = top.reader;
    let text = |key| top.needed(key)?.text(reader).map(str::to_owned);
    let (name, about) = (text("name"), text("about"));
    let extension = top.needed("extension").and_then(|entry| extension(reader, &entry));
    let (file, are_decimals_valid) = TemplateTable::of_file(top);
    let station_codes = Codes::read(top, "station_codes");
    let effector_codes = Codes::read(top, "effector_codes");
    let kind = |codes: &Option<Codes>| codes.as_ref().map(|codes| codes.kind);
    let handoff = Names::new(&HANDOFF)
        .with("station_code", "the table `[station_codes]`", kind(&station_codes))
        .with("effector_code", "the table `[effector_codes]`", kind(&effector_codes))
        .and(&POSE);
    let with_poses = |names: Names| {
        let kind = top.entry("pose").map(|_| Kind::Text);
        names.with(POSES.0, POSES.1, kind)
    };
    let axis = AxisFormat::read(&file);
    let pose = match top.entry("pose") {
        Some(entry) => {
            let names = Names::new(&POSE).and(&[("effector", Kind::Text)]);
            let code = kind(&effector_codes);
            let names = names.with("effector_code", "the table `[effector_codes]`", code);
            file.template(&entry, &names).map(Some)
        }
        None => Some(None),
    };
    let comment = file
        .required("comment", &Names::new(&COMMENT))
        .filter(|comment| file.keeps_text("comment", comment.uses("text"), "{text}", "comments"));
    let begin = file.list("begin", &with_poses(Names::new(&ENDS)));
    let instruction = file.list("instruction", &Names::new(&INSTRUCTION));
    let motion = motions(&file, &with_poses);
    let blend = file.list("blend", &Names::new(&BLEND));
    let taken = file.list("taken", &handoff);
    let left = file.list("left", &handoff);
    let end = file.list("end", &with_poses(Names::new(&ENDS)));
    let output = file.output_or_default();
    if !are_decimals_valid {
        return None;
    }
    Some(Dialect {
        name: name?,
        about: about?,
        extension: extension?,
        time_decimals: file.decimals.times,
        axis: axis?,
        pose: pose?,
        comment: comment?,
        begin: begin?,
        instruction: instruction?,
        motion: motion?,
        blend: blend?,
        taken: taken?,
        left: left?,
        end: end?,
        station_codes,
        effector_codes,
        output: output?,
    })
}

/// The templates of motions.
fn motions(
    file: &TemplateTable<'_, '_, '_>,
    with_poses: &dyn Fn(Names) -> Names,
) -> Option<Motions> {
    let keys = ["axes", "line", "still", "point"];
    let step = with_poses(Names::new(&STEP));
    // Only a line has one effector.
    let of_line = step.clone().and(&POSE);
    match keys.map(|key| file.top.entry(key)) {
        [Some(axes), Some(line), Some(still), None] => {
            let [axes, line, still] = [(axes, &step), (line, &of_line), (still, &step)]
                .map(|(entry, names)| file.templates(&entry, names));
            Some(Motions::Steps { axes: axes?, line: line?, still: still? })
        }
        [None, None, None, Some(point)] => {
            let names = with_poses(Names::new(&POINT));
            file.templates(&point, &names).map(Motions::Points)
        }
        _ => {
            file.top.report(Problem::Motions);
            None
        }
    }
}

fn extension(reader: &Reader<'_>, entry: &Entry<'_, '_>) -> Option<String> {
    let found = entry.text(reader)?.to_owned();
    let plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '.';
    if found.is_empty() || !found.chars().all(plain) {
        entry.report(reader, Problem::Extension { found });
        return None;
    }
    Some(found)
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
        refuse("comment = \"# {text}\"", "comment = \"#\"", "`comment` has no {text}");
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
            ("[output]\nline = \"N{number}\"", "`line` has no {text}, and no {covered} with it"),
            ("[output]\ncovered = \"N{number}\"", "`covered` has no {text}: all lines"),
            (
                "[output]\ncovered = \"N{number}\"\nline = \"{covered}\"",
                "`line` has no {text}, and no {covered} with it",
            ),
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
