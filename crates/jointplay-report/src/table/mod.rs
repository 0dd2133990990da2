//! Tables with one row for each sample and the unit in each column name.

mod column;
mod csv;
#[cfg(feature = "parquet")]
mod parquet;
mod samples;
#[cfg(test)]
mod tests;

pub use self::csv::{csv, write_csv};
#[cfg(feature = "parquet")]
pub use self::parquet::{ParquetTable, parquet};
pub use column::{Column, Values};
pub use samples::{column_name, column_value, columns};
