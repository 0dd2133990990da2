//! The two files of a work cell, the cell file and the program file, read and written together.

use std::collections::BTreeMap;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

use jointplay::cell::workcell::Cell;
use jointplay::format::{cell, program};
use jointplay::report::sha256;
use jointplay_files::{NewFile, explain_read, explain_write, replace_both};

/// Name of the built-in example, accepted in place of a file path.
pub const EXAMPLE: &str = "example";

/// Reads a text of at most so many bytes.
pub(crate) fn read_text(path: &Path, most: usize) -> std::io::Result<String> {
    let mut text = String::new();
    let most = most as u64;
    if std::fs::File::open(path)?.take(most + 1).read_to_string(&mut text)? as u64 > most {
        let why = format!("it has more than the {most} bytes that are allowed");
        return Err(std::io::Error::new(std::io::ErrorKind::FileTooLarge, why));
    }
    Ok(text)
}

/// Files that a cell names, each with the digest of its contents; none for one that could not be read.
pub(crate) type NamedFiles = BTreeMap<String, Option<String>>;

/// The texts of a cell and its program, with the path of the cell file.
#[derive(Debug, Clone)]
pub struct CellFiles {
    /// Path of the cell file; `None` for the built-in example.
    path: Option<PathBuf>,
    cell: String,
    program: String,
}

impl CellFiles {
    /// The built-in example.
    #[must_use]
    pub fn example() -> Self {
        Self { path: None, cell: cell::EXAMPLE.to_owned(), program: program::EXAMPLE.to_owned() }
    }

    /// Reads a cell file and its program file: the file next to it with the same name and the extension `.program`.
    ///
    /// A missing program file is an empty program. Errors in the texts are not an error here: the studio opens them for editing, see [`Self::errors`].
    ///
    /// # Errors
    /// A file that cannot be read, with the reason of the operating system.
    pub fn open(path: &Path) -> Result<Self, String> {
        let cell = read_text(path, cell::MAX_BYTES).map_err(|error| unreadable(path, &error))?;
        let program_path = program_path(path);
        let program = match read_text(&program_path, program::MAX_BYTES) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(unreadable(&program_path, &error)),
        };
        Ok(Self { path: Some(path.to_owned()), cell, program })
    }

    /// All errors in the cell file, each with an excerpt of its line.
    #[must_use]
    pub fn errors(&self) -> Vec<String> {
        let label = self.path.as_ref().map_or_else(String::new, |path| path.display().to_string());
        let Err(problems) = self.parse(&self.cell) else { return Vec::new() };
        problems.iter().map(|problem| problem.with_excerpt(&label)).collect()
    }

    /// The current contents of the same files on disk.
    pub(crate) fn reload(&self) -> Result<Self, String> {
        self.path.as_deref().map_or_else(|| Ok(self.clone()), Self::open)
    }

    /// The same files with other texts, not yet written.
    pub(crate) fn with_texts(&self, cell: String, program: String) -> Self {
        Self { path: self.path.clone(), cell, program }
    }

    /// Digest of both texts.
    pub(crate) fn version(&self) -> String {
        digest(&[self.cell.as_bytes(), self.program.as_bytes()])
    }

    /// Digest of the absolute path of the cell file; constant for the example, which is not a file.
    pub(crate) fn identity(&self) -> String {
        let Some(path) = &self.path else { return digest(&[]) };
        let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        digest(&[absolute.as_os_str().as_encoded_bytes()])
    }

    /// The texts of cell and program.
    pub(crate) fn into_texts(self) -> (String, String) {
        (self.cell, self.program)
    }

    /// Name of the cell file, without its folder.
    pub(crate) fn name(&self) -> Option<String> {
        let name = self.path.as_ref()?.file_name()?;
        Some(name.to_string_lossy().into_owned())
    }

    /// Parses the text of a cell file; files that it names are looked up in the folder of this cell file.
    pub(crate) fn parse(&self, text: &str) -> Result<Cell, cell::Errors> {
        self.parse_with_named(text).0
    }

    /// As [`Self::parse`], with the files that the text names.
    pub(crate) fn parse_with_named(&self, text: &str) -> (Result<Cell, cell::Errors>, NamedFiles) {
        let mut named = NamedFiles::new();
        let cell = cell::read(text, &mut |name| {
            let found = self.named(name);
            named.insert(name.to_owned(), found.as_deref().ok().map(sha256));
            found
        });
        (cell, named)
    }

    /// Whether the files on disk still have the contents that were read.
    pub(crate) fn still_have(&self, named: &NamedFiles) -> bool {
        named.iter().all(|(name, digest)| self.named(name).as_deref().ok().map(sha256) == *digest)
    }

    /// The bytes of a file that a cell names, in the folder of this cell file.
    pub(crate) fn named(&self, name: &str) -> Result<Vec<u8>, String> {
        let folder = self.path.as_deref().and_then(Path::parent);
        let folder = folder.ok_or("the built-in example has no folder to read files from")?;
        let allowed = cell::MAX_MESH_BYTES as u64;
        jointplay_files::read(folder, name, allowed).map_err(|why| why.to_string())
    }

    /// Writes both files completely, or neither.
    pub(crate) fn write(&self) -> Result<(), String> {
        let path = self.path.as_ref().ok_or("the built-in example is read-only: create a file with `jointplay cell example` and start the studio with it")?;
        let program_path = program_path(path);
        let new_cell = complete(path, &self.cell).map_err(|error| unwritable(path, &error))?;
        let new_program = complete(&program_path, &self.program)
            .map_err(|error| unwritable(&program_path, &error))?;
        replace_both(new_cell, new_program).map_err(|(path, error)| unwritable(&path, &error))
    }
}

/// Path of the program file of a cell file.
fn program_path(cell: &Path) -> PathBuf {
    cell.with_extension("program")
}

/// Digest of some texts, the same in every version of the program: browsers store it with drafts.
pub(crate) fn digest(texts: &[&[u8]]) -> String {
    let mut bytes = Vec::new();
    for text in texts {
        // With its length: texts that are divided otherwise have another digest.
        bytes.extend_from_slice(&(text.len() as u64).to_le_bytes());
        bytes.extend_from_slice(text);
    }
    sha256(&bytes)
}

/// The future contents of a file, which the disk has.
fn complete(path: &Path, text: &str) -> std::io::Result<NewFile> {
    let mut file = NewFile::begin(path)?;
    file.write_all(text.as_bytes())?;
    file.sync()?;
    Ok(file)
}

/// The message for a file that cannot be read.
pub(crate) fn unreadable(path: &Path, error: &std::io::Error) -> String {
    format!("cannot read {}: {}", path.display(), explain_read(error))
}

/// The message for a file that cannot be written.
pub(crate) fn unwritable(path: &Path, error: &std::io::Error) -> String {
    format!("cannot write {}: {}", path.display(), explain_write(error))
}

/// Reason why texts were not saved.
#[derive(Debug)]
pub(crate) enum SaveError {
    /// The files on disk have changed since the version that the texts replace.
    Changed(String),
    /// The files cannot be written.
    Unwritable(String),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digests_are_the_same_in_every_version() {
        let expected = "af5570f5a1810b7af78caf4bc70a660f0df51e42baf91d4de5b2328de0e83dfc";
        assert_eq!(digest(&[b""]), expected);
        assert_ne!(digest(&[b"ab", b"c"]), digest(&[b"a", b"bc"]));
        assert_eq!(CellFiles::example().identity(), sha256(b""));
    }
}
