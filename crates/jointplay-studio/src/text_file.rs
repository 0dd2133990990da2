//! A text file on disk that the page edits.

use std::path::Path;

use jointplay::format::mechanism::MAX_BYTES;

use crate::cell_files::{SaveError, digest, read_text, unreadable, unwritable};

/// Reads the text of a file; the limit is that of mechanisms, the largest of all kinds.
pub(crate) fn read(path: &Path) -> Result<String, String> {
    read_text(path, MAX_BYTES).map_err(|error| unreadable(path, &error))
}

/// Writes the text of a file completely, or not at all; with `replaces`, only if the file on disk still has this version.
///
/// # Arguments
/// * `name` – name of the file in messages
/// * `path` – `None` for a text that is no file
/// * `noun` – what the file is, such as `a robot file`
pub(crate) fn save(
    (name, noun): (&str, &str),
    path: Option<&Path>,
    text: &str,
    replaces: Option<&str>,
) -> Result<(), SaveError> {
    let Some(path) = path else {
        let why = format!("{name} is not {noun} on disk: download the text");
        return Err(SaveError::Unwritable(why));
    };
    if let Some(version) = replaces {
        let on_disk = read(path).map_err(SaveError::Changed)?;
        if version_of(&on_disk) != version {
            let why = format!(
                "{name} was changed on disk after it was read: reload it, or save without `replaces` to overwrite it"
            );
            return Err(SaveError::Changed(why));
        }
    }
    jointplay_files::write_durable(path, text.as_bytes())
        .map_err(|error| SaveError::Unwritable(unwritable(path, &error)))
}

/// Version of a text.
pub(crate) fn version_of(text: &str) -> String {
    digest(&[text.as_bytes()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_has_grown_beyond_the_limit_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        std::fs::write(&path, "kind = \"mechanism\"\n").unwrap();
        assert_eq!(read(&path).unwrap(), "kind = \"mechanism\"\n");
        let file = std::fs::File::options().write(true).open(&path).unwrap();
        file.set_len(4_000_001).unwrap();
        let why = read(&path).unwrap_err();
        assert!(why.contains("more than the 4000000 bytes that are allowed"), "{why}");
    }
}
