//! Errors of writing a table.

/// Error of writing a table.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// This build has no Parquet writer.
    #[error("this build of jointplay cannot write Parquet; write the table as CSV")]
    WithoutParquet,
    /// The Parquet writer rejects the table.
    #[error("the table cannot be encoded as Parquet; write it as CSV")]
    Encoding,
    /// The saved end of a table is not that of a Parquet file.
    #[error("the saved end of the table is not the end of a Parquet file; start the study again")]
    Footer,
    /// The file cannot be written.
    #[error("the table cannot be written: {0}")]
    Write(std::io::Error),
}

/// Only a failure of the disk is kept: the other messages of the library concern its own calls.
#[cfg(feature = "parquet")]
impl From<parquet::errors::ParquetError> for TableError {
    fn from(error: parquet::errors::ParquetError) -> Self {
        match error {
            parquet::errors::ParquetError::External(source) => {
                source.downcast::<std::io::Error>().map_or(Self::Encoding, |io| Self::Write(*io))
            }
            _ => Self::Encoding,
        }
    }
}

#[cfg(all(test, feature = "parquet"))]
mod tests {
    use super::*;
    use parquet::errors::ParquetError;

    #[test]
    fn no_text_of_the_parquet_library_reaches_the_message() {
        let text = "Column 3 out of bounds";
        let general = TableError::from(ParquetError::General(text.to_owned()));
        let external = TableError::from(ParquetError::External(text.into()));
        for error in [general, external] {
            assert!(matches!(error, TableError::Encoding), "{error:?}");
            assert!(!error.to_string().contains(text), "{error}");
        }
        let full = std::io::Error::from(std::io::ErrorKind::StorageFull);
        let error = TableError::from(ParquetError::External(Box::new(full)));
        assert!(matches!(error, TableError::Write(_)), "{error:?}");
    }
}
