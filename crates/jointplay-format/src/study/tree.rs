//! The recovering reader, for study files.

use super::problem::Problem;
use crate::file_problem::FileProblem;
use crate::toml_reader;

pub(super) use crate::toml_reader::{AllowedRange, Entry};

/// A text and its errors.
pub(super) type Reader<'a> = toml_reader::Reader<'a, Problem>;

/// A table of the file.
pub(super) type Table<'r, 'a> = toml_reader::Table<'r, 'a, Problem>;

/// The entries of a list with at least one.
pub(super) fn entries<'r, 'a>(
    entry: &Entry<'r, 'a>,
    reader: &Reader,
) -> Option<Vec<Entry<'r, 'a>>> {
    let list = entry.list(reader)?;
    if list.is_empty() {
        entry.report(reader, Problem::Empty { key: entry.key.to_owned() });
        return None;
    }
    Some(list)
}

/// Reports the same entry a second time.
pub(super) fn report_twice(entry: &Entry, reader: &Reader, found: &str) {
    let problem = Problem::Twice { key: entry.key.to_owned(), found: found.to_owned() };
    entry.report(reader, problem);
}

/// A whole number of at least `least`, if the key is present.
pub(super) fn count(top: &Table, key: &'static str, least: i64) -> Option<Option<u64>> {
    let Some(entry) = top.entry(key) else { return Some(None) };
    let found = entry.integer(top.reader)?;
    match u64::try_from(found) {
        Ok(count) if found >= least => Some(Some(count)),
        _ => {
            let (key, needed) = (key.to_owned(), format!("at least {least}"));
            let problem = FileProblem::OutOfRange { key, value: found as f64, needed };
            entry.report(top.reader, problem);
            None
        }
    }
}
