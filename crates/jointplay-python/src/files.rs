//! Files, read whole.

use std::io::Read as _;
use std::path::Path;

use pyo3::prelude::*;

use crate::errors;

/// The text of a file, refused where it is longer than `allowed` bytes.
pub(crate) fn read_text(py: Python<'_>, path: &Path, allowed: u64) -> PyResult<String> {
    let mut bytes = Vec::new();
    // Counted while reading, since pipes and devices do not report their length.
    let read = py.detach(|| std::fs::File::open(path)?.take(allowed + 1).read_to_end(&mut bytes));
    read.map_err(|error| named(py, &error, path))?;
    if bytes.len() as u64 > allowed {
        let message = format!("{} is larger than {allowed} bytes", path.display());
        return Err(errors::input(py, &message));
    }
    String::from_utf8(bytes)
        .map_err(|_| errors::input(py, &format!("{} is not text in UTF-8", path.display())))
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
    pyo3::exceptions::PyOSError::new_err((code, text, path.to_path_buf()))
}
