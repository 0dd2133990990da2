//! From text to a study.

use std::collections::BTreeMap;

use super::file::StudyFile;
use super::sources::Sources;
use super::tree::Table;
use super::{Errors, Problem, cell_study, mechanism_study, platform};
use crate::toml_reader::read_document;

/// Longer texts are refused unread.
pub const MAX_BYTES: usize = 1_000_000;

/// Reads a study file.
///
/// # Arguments
/// * `sources` – returns the bytes of a file that the study names, or of a robot or mechanism of the catalogue, see [`included`](super::included)
///
/// # Errors
/// All errors in the order of their places: invalid TOML, missing and unknown keys, unknown names, values out of range.
pub fn parse(text: &str, sources: &mut Sources) -> Result<StudyFile, Errors> {
    read_document(text, MAX_BYTES, "a study", |top| {
        if !top.reader.is_clean() || top.has_other_kind("study") {
            return None;
        }
        let mut files = BTreeMap::new();
        let mut recorded = |name: &str| {
            let bytes = sources(name)?;
            files.insert(name.to_owned(), bytes.clone());
            Ok(bytes)
        };
        let study = read(top, text, &mut recorded);
        top.finish();
        study.map(|study| StudyFile { files, ..study })
    })
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
