//! Names and texts that can be printed.

use super::problem::Problem;
use super::tree::{Entry, Reader, Table};

/// A name of a joint, by which commands find it.
pub(super) fn joint_name(reader: &Reader, entry: &Entry) -> Option<String> {
    let found = printable_name(reader, entry)?;
    if found.contains([',', '=', '[', ']']) {
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
