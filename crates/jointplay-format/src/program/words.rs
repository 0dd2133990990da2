//! Keywords and units of the program language.

use jointplay_cell::program::Unit;

/// Words at the start of a line, in the order of the documentation.
pub(super) const COMMANDS: [&str; 18] = [
    "HOME",
    "MOVE",
    "GET",
    "PUT",
    "TRANSFER",
    "SWAP",
    "GOTO",
    "WAIT",
    "SPEED",
    "BLEND",
    "TILT",
    "CALL",
    "REPEAT",
    "IF",
    "ELSE",
    "ROUTINE",
    "PARAMETER",
    "END",
];

/// Words within lines.
const PARTICLES: [&str; 16] = [
    "LINE", "SLOT", "WITH", "TO", "BY", "TOWARD", "LEVEL", "AS", "OFF", "FROM", "HAS", "WAFER",
    "EMPTY", "NOT", "AND", "OR",
];

/// Axes of the base frame, in the displacement of a line.
pub(super) const DIRECTIONS: [&str; 3] = ["X", "Y", "Z"];

/// Reserved words of the program language, in upper case: first those that start a line.
pub fn keywords() -> impl Iterator<Item = &'static str> {
    COMMANDS.into_iter().chain(PARTICLES)
}

/// The keyword that equals this word in any letter case.
pub(super) fn reserved(word: &str) -> Option<&'static str> {
    COMMANDS.iter().chain(&PARTICLES).find(|known| known.eq_ignore_ascii_case(word)).copied()
}

/// Commands of other robots' languages, each with the command of this language.
const ELSEWHERE: [(&str, &str); 19] = [
    ("PICK", "GET"),
    ("FETCH", "GET"),
    ("TAKE", "GET"),
    ("PLACE", "PUT"),
    ("DROP", "PUT"),
    ("EXCHANGE", "SWAP"),
    ("XFER", "TRANSFER"),
    ("DELAY", "WAIT"),
    ("SLEEP", "WAIT"),
    ("LOOP", "REPEAT"),
    ("FOR", "REPEAT"),
    ("SUB", "ROUTINE"),
    ("DEF", "ROUTINE"),
    ("PROC", "ROUTINE"),
    ("VAR", "PARAMETER"),
    ("CONST", "PARAMETER"),
    ("ELSEIF", "ELSE"),
    ("ELIF", "ELSE"),
    ("ENDIF", "END"),
];

/// The most similar of the allowed words.
pub(super) fn meant<'a>(word: &str, could: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let upper = word.to_ascii_uppercase();
    let elsewhere = ELSEWHERE.iter().find(|(other, _)| *other == upper).map(|(_, ours)| *ours);
    // Letters swapped, omitted or doubled are common typing errors.
    let likeness = |known: &str| match elsewhere {
        Some(ours) => f64::from(u8::from(ours == known)),
        None => strsim::normalized_damerau_levenshtein(&upper, known),
    };
    could
        .map(|known| (likeness(known), known))
        .filter(|(likeness, _)| *likeness >= 0.5)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, known)| known)
}

/// The unit with a symbol, in any letter case.
pub(super) fn unit(word: &str) -> Option<Unit> {
    Unit::ALL.into_iter().find(|unit| unit.symbol().eq_ignore_ascii_case(word))
}

/// Units that other programs accept and this language does not.
const FOREIGN: [&str; 20] = [
    "m", "cm", "um", "nm", "µm", "μm", "in", "inch", "mil", "meter", "metre", "rad", "mrad",
    "degree", "degrees", "ms", "min", "h", "sec", "percent",
];

/// Whether a word after a number is a unit that this language does not accept.
pub(super) fn is_foreign_unit(word: &str) -> bool {
    FOREIGN.iter().any(|unit| unit.eq_ignore_ascii_case(word))
}

/// Whether a name can be written without quotes.
pub(super) fn is_plain(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(starts_word)
        && letters.all(continues_word)
        && reserved(name).is_none()
}

pub(super) fn starts_word(letter: char) -> bool {
    letter.is_alphabetic() || letter == '_'
}

pub(super) fn continues_word(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_' || letter == '-'
}
