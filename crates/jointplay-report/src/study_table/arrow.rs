//! Chunks of a study as record batches of Arrow.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_schema::{DataType, Field, Schema};
use jointplay_format::study::{Column, Source};
use jointplay_study::plan::Block;

use super::value::{Values, values};
use crate::table_error::TableError;

/// Key of the unit in the metadata of a column.
const UNIT: &str = "unit";

/// Columns of a table as a schema of Arrow; the metadata of a column with a unit has its UCUM code under `unit`.
#[must_use]
pub fn arrow_schema(columns: &[Column]) -> Schema {
    let field = |column: &Column| {
        let (kind, unit) = match column.source {
            Source::Sample | Source::Draw => (DataType::Int64, None),
            Source::Number { unit, .. } => (DataType::Float64, unit.code()),
            Source::Status { .. } => (DataType::Utf8, None),
        };
        let metadata = unit.map(|unit| (UNIT.to_owned(), unit.to_owned()));
        Field::new(&column.name, kind, false).with_metadata(HashMap::from_iter(metadata))
    };
    Schema::new(columns.iter().map(field).collect::<Vec<_>>())
}

/// The rows of a chunk, with the values of its Parquet table.
///
/// # Errors
/// [`TableError::Encoding`].
pub fn record_batch(columns: &[Column], blocks: &[Block]) -> Result<RecordBatch, TableError> {
    let array = |column: &Column| -> ArrayRef {
        let (mut counts, mut numbers, mut words) = (Vec::new(), Vec::new(), Vec::new());
        for block in blocks {
            match values(column, block) {
                Values::Counts(more) => counts.extend(more),
                Values::Numbers(more) => numbers.extend(more),
                Values::Words(more) => words.extend(more),
            }
        }
        match column.source {
            Source::Sample | Source::Draw => Arc::new(Int64Array::from(counts)),
            Source::Number { .. } => Arc::new(Float64Array::from(numbers)),
            Source::Status { .. } => Arc::new(StringArray::from(words)),
        }
    };
    let arrays = columns.iter().map(array).collect();
    RecordBatch::try_new(Arc::new(arrow_schema(columns)), arrays).map_err(|_| TableError::Encoding)
}
