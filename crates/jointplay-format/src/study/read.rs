//! From text to a study.

use super::file::StudyFile;
use super::tree::{Reader, Table};
use super::{Errors, Problem, mechanism_study, platform};
use crate::catalogue;

/// Longer texts are refused unread.
pub const MAX_BYTES: usize = 1_000_000;

/// The text of a robot or mechanism of the catalogue.
///
/// # Errors
/// That there is none of this name, and which there are.
pub fn mechanism_of(name: &str) -> Result<String, String> {
    match catalogue::find(name) {
        Some(entry) => Ok(entry.text.to_owned()),
        None => Err(format!(
            "{name:?} is not in the catalogue; a study takes a name of `jointplay catalogue`, or a file in its folder whose name ends in .toml"
        )),
    }
}

/// Reads a study file.
///
/// # Arguments
/// * `mechanism` – returns the text of the robot or mechanism that the study names, or the reason why it cannot
///
/// # Errors
/// All errors in the order of their places: invalid TOML, missing and unknown keys, unknown names, values out of range.
pub fn parse(
    text: &str,
    mechanism: impl FnOnce(&str) -> Result<String, String>,
) -> Result<StudyFile, Errors> {
    let reader = Reader::new(text);
    if !reader.has_at_most(MAX_BYTES) {
        return reader.done(None);
    }
    let document = reader.parse();
    let top = Table::new(&reader, "a study", document.get_ref(), 0..0);
    if !reader.is_clean() || has_other_kind(&top) {
        return reader.done(None);
    }
    let study = read(&top, text, mechanism);
    top.finish();
    reader.done(study)
}

/// Whether the file names another kind, which is reported; the keys of such a file are not checked.
fn has_other_kind(top: &Table) -> bool {
    let Some(kind) = top.needed("kind") else { return false };
    kind.word(top.reader, "kind", &[("study", ())]).is_none() && kind.is_text()
}

fn read(
    top: &Table,
    text: &str,
    mechanism: impl FnOnce(&str) -> Result<String, String>,
) -> Option<StudyFile> {
    let reader = top.reader;
    let name = top.entry("name").map_or(Some("study".to_owned()), |entry| {
        let name = entry.text(reader)?.to_owned();
        if name.chars().any(char::is_control) {
            entry.report(reader, Problem::Name { found: name });
            return None;
        }
        Some(name)
    });
    match top.entry("mechanism") {
        Some(entry) => mechanism_study::read(top, &entry, name, text, mechanism),
        None => platform::read(top, name, text, mechanism),
    }
}
