//! Errors of writing a table.

/// Why a table cannot be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// Parquet was left out when this was built.
    #[error("it was built without Parquet")]
    WithoutParquet,
    /// What the Parquet library says.
    #[error("the Parquet writer says: {0}")]
    Parquet(String),
}
