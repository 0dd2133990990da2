//! Classes of the Python package that this module makes objects of.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyModule};

static PACKAGE: PyOnceLock<Py<PyModule>> = PyOnceLock::new();

/// A class of the package, by its name.
pub(crate) fn class<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let package = PACKAGE.get_or_try_init(py, || py.import("jointplay").map(Bound::unbind))?;
    package.bind(py).getattr(name)
}

/// An object of a class of the package.
pub(crate) fn result<'py>(
    py: Python<'py>,
    name: &str,
    fields: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyAny>> {
    class(py, name)?.call((), Some(fields))
}

/// A dictionary of fields by name.
macro_rules! fields {
    ($py:expr; $($name:ident = $value:expr),* $(,)?) => {{
        let fields = pyo3::types::PyDict::new($py);
        $( fields.set_item(pyo3::intern!($py, stringify!($name)), $value)?; )*
        fields
    }};
}
pub(crate) use fields;
