//! From text to a study.

use std::collections::BTreeMap;

use super::file::StudyFile;
use super::tree::{Reader, Table};
use super::{Errors, Problem, cell_study, mechanism_study, platform};
use crate::catalogue;

/// Longer texts are refused unread.
pub const MAX_BYTES: usize = 1_000_000;

/// Returns the bytes of a file that a study names, or the reason why it cannot be read.
pub type Sources<'f> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'f;

/// The text of a robot or mechanism of the catalogue.
///
/// # Errors
/// That there is none of this name, and which there are.
pub fn included(name: &str) -> Result<Vec<u8>, String> {
    match catalogue::find(name) {
        Some(entry) => Ok(entry.text.as_bytes().to_vec()),
        None => Err(format!(
            "{name:?} is not in the catalogue; a study takes a name of `jointplay catalogue`, or a file in its folder whose name ends in .toml"
        )),
    }
}

/// The sources of a study that was read before: its [`files`](StudyFile::files).
pub fn from_files(
    files: &BTreeMap<String, Vec<u8>>,
) -> impl FnMut(&str) -> Result<Vec<u8>, String> {
    |name| files.get(name).cloned().ok_or_else(|| format!("there is no file {name:?}"))
}

/// Reads a study file.
///
/// # Arguments
/// * `sources` – returns the bytes of a file that the study names, or of a robot or mechanism of the catalogue, see [`included`]
///
/// # Errors
/// All errors in the order of their places: invalid TOML, missing and unknown keys, unknown names, values out of range.
pub fn parse(text: &str, sources: &mut Sources) -> Result<StudyFile, Errors> {
    let reader = Reader::new(text);
    if !reader.has_at_most(MAX_BYTES) {
        return reader.done(None);
    }
    let document = reader.parse();
    let top = Table::new(&reader, "a study", document.get_ref(), 0..0);
    if !reader.is_clean() || has_other_kind(&top) {
        return reader.done(None);
    }
    let mut files = BTreeMap::new();
    let mut recorded = |name: &str| {
        let bytes = sources(name)?;
        files.insert(name.to_owned(), bytes.clone());
        Ok(bytes)
    };
    let study = read(&top, text, &mut recorded);
    let study = study.map(|study| StudyFile { files, ..study });
    top.finish();
    reader.done(study)
}

/// Whether the file names another kind, which is reported; the keys of such a file are not checked.
fn has_other_kind(top: &Table) -> bool {
    let Some(kind) = top.needed("kind") else { return false };
    kind.word(top.reader, "kind", &[("study", ())]).is_none() && kind.is_text()
}

fn read(top: &Table, text: &str, sources: &mut Sources) -> Option<StudyFile> {
    let reader = top.reader;
    let name = top.entry("name").map_or(Some("study".to_owned()), |entry| {
        let name = entry.text(reader)?.to_owned();
        if name.chars().any(char::is_control) {
            entry.report(reader, Problem::Name { found: name });
            return None;
        }
        Some(name)
    });
    match (top.entry("cell"), top.entry("mechanism")) {
        (Some(entry), _) => cell_study::read(top, &entry, name, text, sources),
        (None, Some(entry)) => mechanism_study::read(top, &entry, name, text, sources),
        (None, None) => platform::read(top, name, text, sources),
    }
}

/// The text of a file that a study names.
pub(super) fn text_of(name: &str, sources: &mut Sources) -> Result<String, String> {
    let bytes = sources(name)?;
    String::from_utf8(bytes)
        .map_err(|_| format!("cannot read the file {name:?}: it is not text in UTF-8"))
}
