//! Plans of studies: their chunks as Arrow, and the files of their parts.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use arrow_array::RecordBatch;
use jointplay::format::cell;
use jointplay::format::study::{self, Column, MAX_BYTES, Source, StudyFile};
use jointplay::report::study_parts::{
    self, MANIFEST, Manifest, PartNames, PartWriter, PartsError, TotalsOfParts,
};
use jointplay::report::study_table::{TableKind, arrow_schema, record_batch};
use jointplay::report::{self, SHARES};
use jointplay::study::plan::{self, Totals};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyCapsule, PyDict, PyTuple};
use rayon::ThreadPool;

use crate::arrow::{batch_stream, schema_capsule};
use crate::skin::fields;
use crate::study_gathering::PyGathering;
use crate::threads::{checked_count, pool_of};
use crate::{errors, files};

/// Text of the study, the files that it names, and its name in messages, for pickling.
type Parts<'py> = (String, Bound<'py, PyDict>, String);

/// A study of any length: what varies, over which values, and what is computed of each sample.
///
/// Made by `from_file`, `from_toml` or `example`; a plan never changes, and pickles as its text with the files that it names.
/// Samples depend on the plan and their number alone, so that chunks can be computed anywhere and in any order.
#[pyclass(name = "Plan", module = "jointplay.study", frozen)]
pub(crate) struct PyPlan {
    study: StudyFile,
    label: String,
    samples: u64,
    chunks: u64,
    digest: String,
}

#[pymethods]
impl PyPlan {
    /// The plan of a study file.
    ///
    /// Parameters
    /// ----------
    /// path : path-like
    ///     The file; robot, mechanism, cell and program files that it names are in its folder or below.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     With line and column of the first error; the message has all of them.
    /// OSError
    ///     For a file that cannot be read.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let text = files::read_text(py, &path, MAX_BYTES as u64)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse(py, &text, path.display().to_string(), &mut |name| {
            read_named(name, Some(folder))
        })
    }

    /// The plan of the text of a study file.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     The text; see the reference of study files.
    /// folder : path-like, optional
    ///     Folder of the files that the text names; without it, the text can name none.
    #[staticmethod]
    #[pyo3(signature = (text, *, folder=None))]
    fn from_toml(py: Python<'_>, text: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        Self::parse(py, text, "text".to_owned(), &mut |name| read_named(name, folder.as_deref()))
    }

    /// An included example: `'center-shift'`, `'play-over-the-workspace'`, `'slider-crank'`, `'station-positions'` or `'tolerances'`.
    #[staticmethod]
    #[pyo3(signature = (name="center-shift"))]
    fn example(py: Python<'_>, name: &str) -> PyResult<Self> {
        let found = study::example(name).ok_or_else(|| {
            let known: Vec<String> =
                study::examples().iter().map(|example| example.name.to_owned()).collect();
            errors::unknown_name(py, "the study", name, &known)
        })?;
        Self::parse(py, found.text, format!("{name}.toml"), &mut study::included)
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.study.name
    }

    /// Text of its file.
    #[getter]
    fn text(&self) -> &str {
        &self.study.text
    }

    /// Number of samples.
    #[getter]
    fn samples(&self) -> u64 {
        self.samples
    }

    /// Number of chunks of 65,536 samples, of mechanisms 2048, of cells 64; the last may be shorter.
    #[getter]
    fn chunks(&self) -> u64 {
        self.chunks
    }

    /// SHA-256 of everything that decides the numbers, in hexadecimal: plans with equal digests have equal tables.
    #[getter]
    fn digest(&self) -> &str {
        &self.digest
    }

    /// Names of the columns, with their units at the end.
    #[getter]
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.study.columns.iter().map(|column| &column.name))
    }

    /// Unit of each column that has one, as codes of UCUM.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for Column { name, source } in &self.study.columns {
            if let Source::Number { unit, .. } = source
                && let Some(code) = unit.code()
            {
                units.set_item(name, code)?;
            }
        }
        Ok(units)
    }

    /// Columns of all chunks, for `pyarrow.schema(plan.schema)`; columns with a unit have it in their metadata.
    #[getter]
    fn schema(&self) -> PySchema {
        PySchema { columns: self.study.columns.clone() }
    }

    /// Computes a chunk, without the GIL.
    ///
    /// Parameters
    /// ----------
    /// number : int
    ///     Number of the chunk, from 0.
    /// threads : int, optional
    ///     Number of threads; default: one per core. The result does not depend on it.
    ///
    /// Returns
    /// -------
    /// Chunk
    #[pyo3(signature = (number, *, threads=None))]
    fn chunk(
        &self,
        py: Python<'_>,
        number: &Bound<'_, PyAny>,
        threads: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyChunk> {
        let (number, pool) = (self.number(py, number)?, pool_of(threads)?);
        let batch = py.detach(|| {
            let blocks = pool.install(|| plan::compute_chunk(&*self.study.plan, number))?;
            Ok(record_batch(&self.study.columns, &blocks)?)
        });
        let batch = batch.map_err(|error: PartsError| errors::parts(py, &error))?;
        Ok(PyChunk { batch })
    }

    /// A folder of parts of this study, one for each chunk: local, or of an object store by `fsspec`.
    ///
    /// Parameters
    /// ----------
    /// location : path-like
    ///     A local folder, or the URL of a folder that `fsspec` knows, such as ``s3://bucket/run``.
    /// filesystem : optional
    ///     A file system of fsspec or pyarrow; `location` is then a path in it.
    /// storage_options : dict, optional
    ///     Options of the file system of a URL.
    /// format : str
    ///     ``'parquet'`` or ``'csv'``.
    /// threads : int, optional
    ///     Number of threads for each part; default: 1, since engines start one task per core.
    ///
    /// Returns
    /// -------
    /// Parts
    #[pyo3(signature = (location, *, filesystem=None, storage_options=None, format="parquet", threads=None))]
    fn parts<'py>(
        slf: &Bound<'py, Self>,
        location: Bound<'py, PyAny>,
        filesystem: Option<Bound<'py, PyAny>>,
        storage_options: Option<Bound<'py, PyAny>>,
        format: &str,
        threads: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        kind(py, format)?;
        checked_count(threads.as_ref())?;
        let options = fields!(py;
            plan = slf,
            location = location,
            filesystem = filesystem,
            storage_options = storage_options,
            format = format,
            threads = threads.unwrap_or(1_u8.into_pyobject(py)?.into_any()),
        );
        py.import("jointplay._parts")?.getattr("Parts")?.call((), Some(&options))
    }

    /// Names of the two files of a part.
    fn _part_names(
        &self,
        py: Python<'_>,
        part: &Bound<'_, PyAny>,
        format: &str,
    ) -> PyResult<(String, String)> {
        let PartNames { table, record } = PartNames::of(self.number(py, part)?, kind(py, format)?);
        Ok((table, record))
    }

    /// Contents of the two files of a part, computed without the GIL.
    fn _part_files<'py>(
        &self,
        py: Python<'py>,
        part: &Bound<'_, PyAny>,
        format: &str,
        threads: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyBytes>)> {
        let (part, kind, pool) = (self.number(py, part)?, kind(py, format)?, pool_of(threads)?);
        let files = py.detach(|| {
            pool.install(|| {
                let blocks = plan::compute_chunk(&*self.study.plan, part)?;
                PartWriter::new(&self.study, kind)?.files(part, &blocks)
            })
        });
        let files = files.map_err(|error| errors::parts(py, &error))?;
        Ok((PyBytes::new(py, &files.table), PyBytes::new(py, files.record.as_bytes())))
    }

    /// Name and contents of the description of a folder of parts.
    fn _manifest<'py>(
        &self,
        py: Python<'py>,
        format: &str,
    ) -> PyResult<(&'static str, Bound<'py, PyBytes>)> {
        let text = self.manifest(py, format)?.to_json();
        let text = text.map_err(|error| errors::parts(py, &error))?;
        Ok((MANIFEST, PyBytes::new(py, text.as_bytes())))
    }

    /// Refuses the description of a folder with parts of another study, or in another format.
    fn _check_manifest(&self, py: Python<'_>, contents: &[u8], format: &str) -> PyResult<()> {
        let kind = kind(py, format)?;
        let check = || {
            let manifest = Manifest::parse(&String::from_utf8_lossy(contents))?;
            manifest.check(&self.study)?;
            if manifest.kind != kind {
                let (found, wanted) = (manifest.kind.ending(), kind.ending());
                return Err(PartsError::OtherTable { found, wanted });
            }
            Ok(())
        };
        check().map_err(|error| errors::parts(py, &error))
    }

    /// Numbers of the finished parts among files with these names.
    fn _done(
        &self,
        py: Python<'_>,
        names: BTreeSet<String>,
        format: &str,
    ) -> PyResult<BTreeSet<u64>> {
        let kind = kind(py, format)?;
        let numbers = names.iter().filter_map(|name| PartNames::part_of_record(name));
        let finished =
            |part: &u64| *part < self.chunks && names.contains(&PartNames::of(*part, kind).table);
        Ok(numbers.filter(finished).collect())
    }

    /// Progress of the study: parts that are finished and missing.
    fn _status<'py>(&self, py: Python<'py>, done: BTreeSet<u64>) -> PyResult<Bound<'py, PyAny>> {
        let report = study_parts::status(&self.study, &done);
        document(py, &report.map_err(|error| errors::parts(py, &error))?)
    }

    /// The summary of all parts from their records in order.
    fn _summary<'py>(
        &self,
        py: Python<'py>,
        records: Vec<Vec<u8>>,
        threads: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let sum = || {
            let mut totals = TotalsOfParts::new(&self.study)?;
            for record in &records {
                totals.add(&String::from_utf8_lossy(record))?;
            }
            totals.finish()
        };
        let totals = py.detach(sum).map_err(|error| errors::parts(py, &error))?;
        self.summarize(py, &totals, &*pool_of(threads)?)
    }

    /// The table of all parts, to be made part by part.
    fn _gathering(slf: &Bound<'_, Self>, format: &str) -> PyResult<PyGathering> {
        let py = slf.py();
        PyGathering::new(py, &slf.get().manifest(py, format)?)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Parts<'py>)> {
        let this = slf.get();
        let files = PyDict::new(slf.py());
        for (name, bytes) in &this.study.files {
            files.set_item(name, PyBytes::new(slf.py(), bytes))?;
        }
        let parts = (this.study.text.clone(), files, this.label.clone());
        Ok((slf.getattr("_again")?, parts))
    }

    /// For pickling.
    #[staticmethod]
    fn _again(
        py: Python<'_>,
        text: &str,
        files: BTreeMap<String, Vec<u8>>,
        label: String,
    ) -> PyResult<Self> {
        Self::parse(py, text, label, &mut study::from_files(&files))
    }

    /// For Dask: plans with equal digests are the same.
    fn __dask_tokenize__(&self) -> &str {
        &self.digest
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.digest == other.digest
    }

    fn __hash__(&self) -> u64 {
        // Hexadecimal digits of a hash already.
        u64::from_str_radix(&self.digest[..16], 16).unwrap_or_default()
    }

    fn __repr__(&self) -> String {
        let Self { study, samples, chunks, .. } = self;
        format!("Plan({:?}, {samples} samples in {chunks} chunks)", study.name)
    }
}

impl PyPlan {
    fn parse(
        py: Python<'_>,
        text: &str,
        label: String,
        sources: &mut study::Sources,
    ) -> PyResult<Self> {
        let study =
            study::parse(text, sources).map_err(|found| errors::file(py, &label, &found))?;
        let counts = || Ok((study.plan.samples()?, study.plan.chunks()?));
        let (samples, chunks) = counts().map_err(|error| errors::study(py, &error))?;
        let digest = study_parts::digest(&study);
        Ok(Self { study, label, samples, chunks, digest })
    }

    /// The number of a chunk, refused beyond the last.
    fn number(&self, py: Python<'_>, number: &Bound<'_, PyAny>) -> PyResult<u64> {
        let found = number.extract().ok().filter(|found| *found < self.chunks);
        found.ok_or_else(|| {
            let shown = number.repr().map(|text| text.to_string()).unwrap_or_default();
            let shown: String = shown.chars().take(20).collect();
            let chunks = self.chunks;
            let message = format!(
                "there is no chunk {shown}: they are numbered from 0, and there are {chunks}"
            );
            errors::input(py, &message)
        })
    }

    fn manifest(&self, py: Python<'_>, format: &str) -> PyResult<Manifest> {
        Ok(Manifest { study: self.study.clone(), kind: kind(py, format)? })
    }

    /// The summary of all samples from their totals.
    pub(crate) fn summarize<'py>(
        &self,
        py: Python<'py>,
        totals: &Totals,
        pool: &ThreadPool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let quantiles = py.detach(|| pool.install(|| plan::quantiles(&*self.study.plan, &SHARES)));
        let quantiles = quantiles.map_err(|error| errors::study(py, &error))?;
        document(py, &report::totals(&self.study, totals, &quantiles))
    }
}

/// Samples of a chunk; PyArrow, Polars, pandas and DuckDB read it as a table.
#[pyclass(name = "Chunk", module = "jointplay.study", frozen)]
pub(crate) struct PyChunk {
    batch: RecordBatch,
}

#[pymethods]
impl PyChunk {
    /// The columns as an Arrow stream of one batch, by the Arrow PyCapsule interface; they are not copied.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let _ = requested_schema;
        batch_stream(py, self.batch.clone())
    }

    fn __len__(&self) -> usize {
        self.batch.num_rows()
    }

    fn __repr__(&self) -> String {
        format!("Chunk({} samples, {} columns)", self.batch.num_rows(), self.batch.num_columns())
    }
}

/// Columns of a study.
#[pyclass(name = "Schema", module = "jointplay.study", frozen)]
pub(crate) struct PySchema {
    columns: Vec<Column>,
}

#[pymethods]
impl PySchema {
    /// The schema by the Arrow PyCapsule interface.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        schema_capsule(py, &arrow_schema(&self.columns))
    }

    fn __repr__(&self) -> String {
        let names: Vec<&str> = self.columns.iter().map(|column| &*column.name).collect();
        format!("Schema({})", names.join(", "))
    }
}

/// The text of the robot or mechanism that a study names.
/// A file that a study names: an entry of the catalogue, or a file in the folder of the study or below.
fn read_named(name: &str, folder: Option<&Path>) -> Result<Vec<u8>, String> {
    // Names of the catalogue have no ending.
    match folder.filter(|_| name.contains('.')) {
        Some(folder) => jointplay_files::read(folder, name, cell::MAX_MESH_BYTES as u64)
            .map_err(|why| format!("cannot read the file {name:?}: {why}")),
        None => study::included(name),
    }
}

fn kind(py: Python<'_>, format: &str) -> PyResult<TableKind> {
    TableKind::of_ending(format).ok_or_else(|| {
        let known = [TableKind::Csv, TableKind::Parquet].map(|kind| kind.ending().to_owned());
        errors::unknown_name(py, "the format", format, &known)
    })
}

/// A report as a dictionary.
pub(crate) fn document<'py>(
    py: Python<'py>,
    report: &impl serde::Serialize,
) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(report);
    let text = text.map_err(|error| errors::internal(&error.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}
