//! Names and texts that can be printed.

use std::borrow::Cow;

use super::problem::Problem;
use super::tree::{Entry, Reader, Table};

/// The letter in place of one that has a meaning in commands, such as `crank=10,nut[1]=5`; `None` for all other letters.
fn replacement(letter: char) -> Option<char> {
    match letter {
        ',' | '=' => Some('_'),
        '[' => Some('('),
        ']' => Some(')'),
        _ => None,
    }
}

/// The name itself if joints and couplings of a file can have it, and otherwise one that differs in the forbidden letters only.
///
/// ```
/// use jointplay_format::mechanism::allowed_joint_name;
/// assert_eq!(allowed_joint_name("hook[0]"), "hook(0)");
/// assert_eq!(allowed_joint_name("crank"), "crank");
/// ```
#[must_use]
pub fn allowed_joint_name(name: &str) -> Cow<'_, str> {
    if !name.chars().any(|letter| replacement(letter).is_some()) {
        return Cow::Borrowed(name);
    }
    name.chars().map(|letter| replacement(letter).unwrap_or(letter)).collect()
}

/// A name of a joint, by which commands find it.
pub(super) fn joint_name(reader: &Reader, entry: &Entry) -> Option<String> {
    let found = printable_name(reader, entry)?;
    if allowed_joint_name(&found) != found {
        entry.report(reader, Problem::JointName { found });
        return None;
    }
    Some(found)
}

/// A name that can be printed.
pub(super) fn printable_name(reader: &Reader, entry: &Entry) -> Option<String> {
    let found = entry.text(reader)?.to_owned();
    if found.trim().is_empty() || found.chars().any(char::is_control) {
        entry.report(reader, Problem::Name { key: entry.key.to_owned(), found });
        return None;
    }
    Some(found)
}

/// An optional text that can be printed, of any number of lines.
pub(super) fn prose(table: &Table, key: &'static str) -> Option<String> {
    let entry = table.entry(key)?;
    let found = entry.text(table.reader)?.to_owned();
    if found.chars().any(|character| character.is_control() && !"\r\n\t".contains(character)) {
        entry.report(table.reader, Problem::Name { key: key.to_owned(), found });
        return None;
    }
    Some(found)
}
