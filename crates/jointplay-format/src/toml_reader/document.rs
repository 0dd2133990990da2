//! Whole files.

use super::reader::Reader;
use super::table::Table;
use crate::file_problem::FileProblem;
use crate::place::Errors;

/// Reads the text of a file by its top table.
///
/// # Arguments
/// * `max_bytes` – length of the longest accepted text
/// * `whose` – the file in messages, such as `a study`
/// * `read` – `None` for a table with errors; calls [`Table::finish`] for unknown keys to be errors
///
/// # Errors
/// All errors in the order of their places.
pub fn read_document<P: From<FileProblem> + PartialEq, T>(
    text: &str,
    max_bytes: usize,
    whose: &str,
    read: impl FnOnce(&Table<'_, '_, P>) -> Option<T>,
) -> Result<T, Errors<P>> {
    let reader = Reader::new(text);
    if !reader.has_at_most(max_bytes) {
        return reader.done(None);
    }
    let document = reader.parse();
    let result = read(&Table::new(&reader, whose, document.get_ref(), 0..0));
    reader.done(result)
}
