//! Columns as an Arrow stream, by the Arrow PyCapsule interface.

use std::sync::Arc;

use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, RecordBatchIterator,
    StringArray, UInt8Array,
};
use arrow_schema::Schema;
use arrow_schema::ffi::FFI_ArrowSchema;
use numpy::prelude::*;
use numpy::{PyArray1, PyUntypedArray};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;

/// An Arrow stream of one batch with these columns, copied.
#[pyfunction]
pub(crate) fn arrow_stream<'py>(
    py: Python<'py>,
    columns: Vec<(String, Bound<'py, PyAny>)>,
) -> PyResult<Bound<'py, PyCapsule>> {
    let arrays = columns.into_iter().map(|(name, values)| Ok((name, arrow_array(&values)?)));
    let arrays = arrays.collect::<PyResult<Vec<(String, ArrayRef)>>>()?;
    let refused = |error: arrow_schema::ArrowError| PyValueError::new_err(error.to_string());
    let batch = if arrays.is_empty() {
        RecordBatch::new_empty(Arc::new(Schema::empty()))
    } else {
        RecordBatch::try_from_iter(arrays).map_err(refused)?
    };
    batch_stream(py, batch)
}

/// An Arrow stream of one batch.
pub(crate) fn batch_stream(py: Python<'_>, batch: RecordBatch) -> PyResult<Bound<'_, PyCapsule>> {
    let schema = batch.schema();
    let batches = RecordBatchIterator::new([Ok(batch)], schema);
    let stream = FFI_ArrowArrayStream::new(Box::new(batches));
    PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
}

/// A schema of Arrow.
pub(crate) fn schema_capsule<'py>(
    py: Python<'py>,
    schema: &Schema,
) -> PyResult<Bound<'py, PyCapsule>> {
    let schema = FFI_ArrowSchema::try_from(schema);
    let schema = schema.map_err(|error| PyValueError::new_err(error.to_string()))?;
    PyCapsule::new_with_value(py, schema, c"arrow_schema")
}

fn arrow_array(values: &Bound<'_, PyAny>) -> PyResult<ArrayRef> {
    if let Ok(values) = values.cast::<PyArray1<f64>>() {
        return Ok(Arc::new(Float64Array::from(values.to_vec()?)));
    }
    if let Ok(values) = values.cast::<PyArray1<u8>>() {
        return Ok(Arc::new(UInt8Array::from(values.to_vec()?)));
    }
    if let Ok(values) = values.cast::<PyArray1<i64>>() {
        return Ok(Arc::new(Int64Array::from(values.to_vec()?)));
    }
    if let Ok(values) = values.cast::<PyArray1<bool>>() {
        return Ok(Arc::new(BooleanArray::from(values.to_vec()?)));
    }
    let array = values.cast::<PyUntypedArray>()?;
    if array.dtype().kind() == b'U' {
        let texts: Vec<String> = values.call_method0("tolist")?.extract()?;
        return Ok(Arc::new(StringArray::from(texts)));
    }
    Err(PyTypeError::new_err(format!("no column of Arrow for the dtype {}", array.dtype())))
}
