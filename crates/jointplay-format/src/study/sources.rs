//! The files that a study names.

use std::collections::BTreeMap;

use crate::catalogue;

/// Returns the bytes of a file that a study names, or the reason why it cannot be read.
pub type Sources<'f> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'f;

/// The text of a robot or mechanism of the catalogue.
///
/// # Errors
/// Message for an unknown name, with the known ones.
pub fn included(name: &str) -> Result<Vec<u8>, String> {
    match catalogue::find(name) {
        Some(entry) => Ok(entry.text.as_bytes().to_vec()),
        None => Err(format!(
            "{name:?} is not in the catalogue; a study takes a name of `jointplay catalogue`, or a file in its folder whose name ends in .toml"
        )),
    }
}

/// The sources of a study that was read before: its [`files`](super::StudyFile::files).
pub fn from_files(
    files: &BTreeMap<String, Vec<u8>>,
) -> impl FnMut(&str) -> Result<Vec<u8>, String> {
    |name| files.get(name).cloned().ok_or_else(|| format!("there is no file {name:?}"))
}

/// The text of a file that a study names.
pub(super) fn text_of(name: &str, sources: &mut Sources) -> Result<String, String> {
    let bytes = sources(name)?;
    String::from_utf8(bytes)
        .map_err(|_| format!("cannot read the file {name:?}: it is not text in UTF-8"))
}
