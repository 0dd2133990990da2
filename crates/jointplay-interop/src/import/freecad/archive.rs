//! The document in a file of FreeCAD (`.FCStd`): an archive, of which only `Document.xml` is read.

use std::cell::Cell;
use std::io::{Error, ErrorKind, Read, Result, Seek, SeekFrom};
use std::path::Path;
use std::rc::Rc;

use jointplay_format::place::listed;
use zip::ZipArchive;
use zip::result::ZipError;

use crate::fmu::MODEL_DESCRIPTION;

/// Largest text of a document (bytes).
pub const MAX_DOCUMENT_BYTES: usize = 32_000_000;
/// Most bytes read to find the entries of an archive: the list of more than 100,000 entries.
const MAX_DIRECTORY_BYTES: u64 = 16_000_000;
/// The entry with the objects.
const DOCUMENT: &str = "Document.xml";
/// Extension of documents.
const EXTENSION: &str = "FCStd";

/// Error of a file of FreeCAD.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArchiveError {
    /// A file that is no complete archive, or cannot be read.
    #[error("the archive of FreeCAD cannot be read: {message}")]
    Damaged {
        /// The reason.
        message: String,
    },
    /// A file with the name of a document that is no archive.
    #[error(
        "a document of FreeCAD (.{EXTENSION}) is a zip archive, which begins with the letters PK; this file does not"
    )]
    NoArchive,
    /// A functional mock-up unit.
    #[error("the archive is a functional mock-up unit (FMU), and no file of FreeCAD")]
    Fmu,
    /// An archive of something else.
    #[error(
        "the archive has no {DOCUMENT}, so that it is no file of FreeCAD; it has {}",
        listed(found)
    )]
    NoDocument {
        /// The first names in it.
        found: Vec<String>,
    },
    /// A document that is too long, as packed files can be that are small themselves.
    #[error("{DOCUMENT} has more than {MAX_DOCUMENT_BYTES} bytes")]
    TooLong,
    /// A document that is not in UTF-8.
    #[error("{DOCUMENT} is not text in UTF-8")]
    NoText,
}

/// Whether a file has the name of a document of FreeCAD.
#[must_use]
pub fn is_document_name(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION))
}

/// Whether a file is an archive, by its first bytes.
#[must_use]
pub fn is_archive(start: &[u8]) -> bool {
    start.starts_with(b"PK\x03\x04")
}

/// The text of `Document.xml` in a file of FreeCAD, for [`parse`](super::super::parse).
///
/// Shapes are not read: memory is that of the text and of the list of entries.
///
/// # Errors
/// [`ArchiveError`].
///
/// # Source
/// \[FCStd\]
pub fn document_text(file: impl Read + Seek) -> std::result::Result<String, ArchiveError> {
    let left = Rc::new(Cell::new(MAX_DIRECTORY_BYTES));
    let bounded = Bounded { file, left: Rc::clone(&left) };
    let mut archive = ZipArchive::new(bounded).map_err(damaged)?;
    left.set(MAX_DOCUMENT_BYTES as u64 + MAX_DIRECTORY_BYTES);
    if archive.index_for_name(DOCUMENT).is_none() {
        if archive.index_for_name(MODEL_DESCRIPTION).is_some() {
            return Err(ArchiveError::Fmu);
        }
        let names = archive.file_names().filter_map(|name| name.ok()).take(5);
        let found = names.map(|name| name.chars().take(60).collect()).collect();
        return Err(ArchiveError::NoDocument { found });
    }
    let entry = archive.by_name(DOCUMENT).map_err(damaged)?;
    let mut bytes = Vec::new();
    // Counted while unpacking: the length that an archive states may be another.
    let read = entry.take(MAX_DOCUMENT_BYTES as u64 + 1).read_to_end(&mut bytes);
    if bytes.len() > MAX_DOCUMENT_BYTES {
        return Err(ArchiveError::TooLong);
    }
    read.map_err(|error| damaged(ZipError::Io(error)))?;
    String::from_utf8(bytes).map_err(|_| ArchiveError::NoText)
}

fn damaged(error: ZipError) -> ArchiveError {
    use ZipError as E;
    let message = match error {
        E::Io(error) if is_of_storage(error.kind()) => error.to_string(),
        E::UnsupportedArchive(_) | E::CompressionMethodNotSupported(_) | E::InvalidPassword => {
            "it is packed in a manner that FreeCAD does not use".to_owned()
        }
        // Messages of the library name its own types and the parts of archives.
        _ => "it is damaged or incomplete".to_owned(),
    };
    ArchiveError::Damaged { message }
}

/// Whether an error of reading has another cause than the bytes of the archive.
fn is_of_storage(kind: ErrorKind) -> bool {
    use ErrorKind as E;
    !matches!(kind, E::InvalidData | E::InvalidInput | E::UnexpectedEof | E::Other)
}

/// A file of which a bounded number of bytes is read.
struct Bounded<F> {
    file: F,
    left: Rc<Cell<u64>>,
}

impl<F: Read> Read for Bounded<F> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        let count = self.file.read(buffer)?;
        let left = self.left.get().checked_sub(count as u64);
        self.left.set(left.ok_or_else(|| Error::new(ErrorKind::FileTooLarge, "too many entries"))?);
        Ok(count)
    }
}

impl<F: Seek> Seek for Bounded<F> {
    fn seek(&mut self, position: SeekFrom) -> Result<u64> {
        self.file.seek(position)
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Write as _};

    use proptest::prelude::*;
    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;

    fn packed(entries: &[(&str, &[u8])]) -> Vec<u8> {
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in entries {
            archive.start_file(*name, SimpleFileOptions::default()).unwrap();
            archive.write_all(content).unwrap();
        }
        archive.finish().unwrap().into_inner()
    }

    #[track_caller]
    fn refuse(bytes: &[u8], message: &str) {
        let error = document_text(Cursor::new(bytes)).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }

    #[test]
    fn the_document_is_unpacked_and_others_are_refused() {
        let good = packed(&[("PartShape.brp", b"shape"), (DOCUMENT, b"<Document/>")]);
        assert!(is_archive(&good) && !is_archive(b"<Document/>"));
        assert_eq!(document_text(Cursor::new(&good)).unwrap(), "<Document/>");
        refuse(&good[..good.len() / 2], "it is damaged or incomplete");
        refuse(b"", "it is damaged or incomplete");
        refuse(b"PK\x03\x04", "it is damaged or incomplete");
        refuse(&packed(&[("word/document.xml", b"<w/>")]), "it has word/document.xml");
        refuse(
            &packed(&[("binaries/a.so", b""), (MODEL_DESCRIPTION, b"<fmi/>")]),
            "functional mock-up unit",
        );
        refuse(&packed(&[(DOCUMENT, b"\xff\xfe")]), "not text in UTF-8");
        // An archive of 32 kB that unpacks to more than the longest document.
        let bomb = packed(&[(DOCUMENT, &vec![b' '; MAX_DOCUMENT_BYTES + 1])]);
        assert!(bomb.len() < 100_000);
        refuse(&bomb, "more than 32000000 bytes");
    }

    #[test]
    fn documents_are_recognised_by_their_names() {
        let names = ["a.FCStd", "folder/ä.fcstd", "b.fcstd1", "FCStd", "a.FCStd/robot.toml"];
        let found = names.map(|name| is_document_name(Path::new(name)));
        assert_eq!(found, [true, true, false, false, false]);
    }

    #[test]
    fn bytes_are_counted_while_entries_are_listed() {
        let left = Rc::new(Cell::new(10));
        let mut bounded = Bounded { file: Cursor::new([0; 20]), left };
        assert!(bounded.read(&mut [0; 10]).is_ok());
        assert_eq!(bounded.read(&mut [0; 1]).unwrap_err().kind(), ErrorKind::FileTooLarge);
    }

    proptest! {
        #[test]
        fn damaged_archives_do_not_panic(
            place in 0.0..1.0_f64, bytes in prop::collection::vec(any::<u8>(), 1..8),
        ) {
            let mut archive = packed(&[("a", b"shape"), (DOCUMENT, b"<Document></Document>")]);
            let start = (place * archive.len() as f64) as usize;
            for (byte, new) in archive[start..].iter_mut().zip(bytes) {
                *byte = new;
            }
            let _ = document_text(Cursor::new(archive));
        }
    }
}
