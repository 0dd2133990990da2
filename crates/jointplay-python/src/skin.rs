//! Classes of the Python package that this module makes objects of.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyModule};

static ERRORS: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
static RESULTS: PyOnceLock<Py<PyModule>> = PyOnceLock::new();

/// A class of `jointplay._errors`.
pub(crate) fn error_class<'py>(py: Python<'py>, class: &str) -> PyResult<Bound<'py, PyAny>> {
    let module =
        ERRORS.get_or_try_init(py, || py.import("jointplay._errors").map(Bound::unbind))?;
    module.bind(py).getattr(class)
}

/// An object of a class of `jointplay._results`.
pub(crate) fn result<'py>(
    py: Python<'py>,
    class: &str,
    fields: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyAny>> {
    let module =
        RESULTS.get_or_try_init(py, || py.import("jointplay._results").map(Bound::unbind))?;
    module.bind(py).getattr(class)?.call((), Some(fields))
}

/// A dictionary of fields, each named as the expression given for it says.
macro_rules! fields {
    ($py:expr; $($name:ident = $value:expr),* $(,)?) => {{
        let fields = pyo3::types::PyDict::new($py);
        $( fields.set_item(pyo3::intern!($py, stringify!($name)), $value)?; )*
        fields
    }};
}
pub(crate) use fields;
