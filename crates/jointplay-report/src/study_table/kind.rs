//! File formats of a table of samples.

use std::path::Path;

/// File format of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableKind {
    /// Comma-separated values: every number with enough digits to read back exactly, an empty cell without an answer.
    Csv,
    /// Parquet: one row group per chunk, NaN without an answer.
    Parquet,
}

impl TableKind {
    /// The format that belongs to a file name's extension; `None` for any other.
    #[must_use]
    pub fn from_path(path: &Path) -> Option<Self> {
        Self::of_ending(path.extension()?.to_str()?)
    }

    /// The format with this extension; `None` for any other.
    #[must_use]
    pub fn of_ending(ending: &str) -> Option<Self> {
        [Self::Csv, Self::Parquet].into_iter().find(|kind| kind.ending() == ending)
    }

    /// Extension of the file name.
    #[must_use]
    pub fn ending(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
        }
    }
}
