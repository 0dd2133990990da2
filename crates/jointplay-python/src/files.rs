//! Files, read whole.

use std::io::Read as _;
use std::path::Path;

use jointplay::interop::import::{self, Expanded, IncludeError};
use pyo3::prelude::*;

use crate::errors;

/// Bytes that distinguish an archive from text.
const ARCHIVE_START: u64 = 4;

/// The text of a file, refused where it is longer than `allowed` bytes; of a document of FreeCAD, an archive, the text of its objects.
pub(crate) fn read_text(py: Python<'_>, path: &Path, allowed: u64) -> PyResult<String> {
    let mut bytes = Vec::new();
    // Counted while reading, since pipes and devices do not report their length.
    let read = py.detach(|| {
        let mut file = std::fs::File::open(path)?;
        file.by_ref().take(ARCHIVE_START).read_to_end(&mut bytes)?;
        if import::is_archive(&bytes) {
            return Ok(Some(import::document_text(file)));
        }
        file.take(allowed + 1 - bytes.len() as u64).read_to_end(&mut bytes)?;
        Ok(None)
    });
    if let Some(document) = read.map_err(|error| named(py, &error, path))? {
        return document
            .map_err(|error| errors::input(py, &format!("{}: {error}", path.display())));
    }
    if bytes.len() as u64 > allowed {
        let message = format!("{} is larger than {allowed} bytes", path.display());
        return Err(errors::input(py, &message));
    }
    let text = String::from_utf8(bytes);
    // A document that was unpacked is text in XML.
    if import::is_document_name(path) && !text.as_ref().is_ok_and(|text| import::is_model(text)) {
        let error = import::ArchiveError::NoArchive;
        return Err(errors::input(py, &format!("{}: {error}", path.display())));
    }
    text.map_err(|_| errors::input(py, &format!("{} is not text in UTF-8", path.display())))
}

/// The bytes of a file, refused where it is longer than `allowed` bytes.
pub(crate) fn read_bytes(py: Python<'_>, path: &Path, allowed: u64) -> PyResult<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = py.detach(|| {
        std::fs::File::open(path)?.take(allowed + 1).read_to_end(&mut bytes).map(|_| ())
    });
    read.map_err(|error| named(py, &error, path))?;
    if bytes.len() as u64 > allowed {
        let message = format!("{} is larger than {allowed} bytes", path.display());
        return Err(errors::input(py, &message));
    }
    Ok(bytes)
}

/// A model with the files of its folder that it includes.
pub(crate) fn expand_includes(
    py: Python<'_>,
    text: &str,
    path: &Path,
    allowed: u64,
) -> PyResult<Expanded> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut read = |name: &str| {
        let bytes =
            jointplay_files::read(folder, name, allowed).map_err(|refused| refused.to_string())?;
        String::from_utf8(bytes).map_err(|_| "it is not text in UTF-8".to_owned())
    };
    import::expand_includes(text, &mut read).map_err(|found| included(py, path, found))
}

/// An error of a model, or of a file that it includes.
pub(crate) fn included(py: Python<'_>, path: &Path, found: IncludeError) -> PyErr {
    let folder = path.parent().unwrap_or(Path::new(""));
    let file = found.file.map_or_else(|| path.to_owned(), |file| folder.join(file));
    errors::file(py, &file.display().to_string(), &[found.error])
}

/// The error that Python's own `open` raises.
fn named(py: Python<'_>, error: &std::io::Error, path: &Path) -> PyErr {
    let Some(code) = error.raw_os_error() else {
        return std::io::Error::other(error.to_string()).into();
    };
    let text = py
        .import("os")
        .and_then(|os| os.call_method1("strerror", (code,))?.extract::<String>())
        .unwrap_or_else(|_| error.to_string());
    // `OSError` makes itself the right one of its subclasses for the number.
    pyo3::exceptions::PyOSError::new_err((code, text, path.as_os_str().to_owned()))
}
