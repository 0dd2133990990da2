//! Tables as Parquet files.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type};
use parquet::data_type::{DoubleType, Int32Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types;

use super::column::{Column, Values};
use crate::table_error::TableError;

/// A table as a Parquet file, Snappy-compressed, with one row group.
///
/// # Errors
/// [`TableError::Encoding`].
pub fn parquet(columns: &[Column]) -> Result<Vec<u8>, TableError> {
    let mut table = ParquetTable::new(columns, Vec::new())?;
    table.push(columns)?;
    table.finish()
}

/// Writer of a Parquet file in parts, each a row group.
pub struct ParquetTable<W: Write + Send> {
    writer: SerializedFileWriter<W>,
}

impl<W: Write + Send> ParquetTable<W> {
    /// An empty file.
    ///
    /// # Arguments
    /// * `columns` – of any part: their names and types
    /// * `columns` – names and types, the same for all parts
    /// # Errors
    /// [`TableError::Encoding`], [`TableError::Write`].
    pub fn new(columns: &[Column], writer: W) -> Result<Self, TableError> {
        let fields = columns
            .iter()
            .map(|column| {
                let physical = match column.values {
                    Values::Real(_) => Type::DOUBLE,
                    Values::Count(_) => Type::INT32,
                };
                let field = types::Type::primitive_type_builder(&column.name, physical)
                    .with_repetition(Repetition::REQUIRED)
                    .build()?;
                Ok(Arc::new(field))
            })
            .collect::<Result<Vec<_>, ParquetError>>()?;
        let schema = types::Type::group_type_builder("samples").with_fields(fields).build()?;
        let properties =
            Arc::new(WriterProperties::builder().set_compression(Compression::SNAPPY).build());
        Ok(Self { writer: SerializedFileWriter::new(writer, Arc::new(schema), properties)? })
    }

    /// Adds rows as a row group.
    ///
    /// # Errors
    /// [`TableError::Encoding`], [`TableError::Write`].
    pub fn push(&mut self, columns: &[Column]) -> Result<(), TableError> {
        let mut group = self.writer.next_row_group()?;
        for column in columns {
            let Some(mut target) = group.next_column()? else { break };
            match &column.values {
                Values::Real(values) => {
                    target.typed::<DoubleType>().write_batch(values, None, None)?;
                }
                Values::Count(values) => {
                    let signed: Vec<i32> =
                        values.iter().map(|&v| i32::try_from(v).unwrap_or(i32::MAX)).collect();
                    target.typed::<Int32Type>().write_batch(&signed, None, None)?;
                }
            }
            target.close()?;
        }
        group.close()?;
        Ok(())
    }

    /// Completes the file and returns the writer.
    ///
    /// # Errors
    /// [`TableError::Encoding`], [`TableError::Write`].
    pub fn finish(self) -> Result<W, TableError> {
        Ok(self.writer.into_inner()?)
    }
}
