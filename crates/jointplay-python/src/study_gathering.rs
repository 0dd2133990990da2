//! The table of a study, made of its parts.

use std::sync::{Mutex, PoisonError};

use jointplay::report::study_parts::{Gathering, Manifest, PartNames};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors;

/// Puts parts together, in order.
#[pyclass(name = "Gathering", module = "jointplay.study", frozen)]
pub(crate) struct PyGathering {
    /// Taken at the end.
    gathering: Mutex<Option<Gathering>>,
}

#[pymethods]
impl PyGathering {
    /// Bytes before those of the parts.
    fn head<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        self.with(|gathering| Ok(PyBytes::new(py, &gathering.head())))
    }

    /// Names of the two files of the part that follows.
    fn next(&self) -> PyResult<(String, String)> {
        self.with(|gathering| {
            let PartNames { table, record } = gathering.next();
            Ok((table, record))
        })
    }

    /// Adds the part that follows; its bytes in the table.
    fn add<'py>(
        &self,
        py: Python<'py>,
        record: &[u8],
        table: &[u8],
    ) -> PyResult<Bound<'py, PyBytes>> {
        self.with(|gathering| {
            let bytes = gathering.add(&String::from_utf8_lossy(record), table);
            Ok(PyBytes::new(py, &bytes.map_err(|error| errors::parts(py, &error))?))
        })
    }

    /// Bytes after those of the parts.
    fn finish<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut gathering = self.gathering.lock().unwrap_or_else(PoisonError::into_inner);
        let gathering = gathering.take().ok_or_else(|| errors::internal("gathered twice"))?;
        let (foot, _) = gathering.finish().map_err(|error| errors::parts(py, &error))?;
        Ok(PyBytes::new(py, &foot))
    }
}

impl PyGathering {
    pub(crate) fn new(py: Python<'_>, manifest: &Manifest) -> PyResult<Self> {
        let gathering = Gathering::new(manifest).map_err(|error| errors::parts(py, &error))?;
        Ok(Self { gathering: Mutex::new(Some(gathering)) })
    }

    fn with<T>(&self, work: impl FnOnce(&mut Gathering) -> PyResult<T>) -> PyResult<T> {
        let mut gathering = self.gathering.lock().unwrap_or_else(PoisonError::into_inner);
        work(gathering.as_mut().ok_or_else(|| errors::internal("gathered twice"))?)
    }
}
