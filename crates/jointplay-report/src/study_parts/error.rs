//! Errors of folders of parts.

use jointplay_study::Error as StudyError;

use crate::table_error::TableError;

/// Error of a folder of parts.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PartsError {
    /// A file that no run writes.
    #[error("{file} was not written by jointplay: {why}")]
    Malformed {
        /// Name of the file.
        file: String,
        /// What is malformed.
        why: String,
    },
    /// A folder of another version, whose numbers may differ in their last digits.
    #[error(
        "jointplay {found} began this study, and only the same version can continue it; this is {here}"
    )]
    Version {
        /// Version that began the study.
        found: String,
        /// This version.
        here: &'static str,
    },
    /// A part that another version computed, whose numbers may differ in their last digits.
    #[error(
        "{file} was written by jointplay {found}, and this is {here}: numbers may differ in their last digits; delete it, and the part is computed again"
    )]
    VersionOfPart {
        /// Name of the record.
        file: String,
        /// Version in the record.
        found: String,
        /// This version.
        here: &'static str,
    },
    /// A folder of a study of a mechanism or a cell, which was begun on another kind of processor.
    #[error(
        "this study was begun with the instruction set {found}, and this processor has {here}: numbers may differ in their last digits; compute all parts on one kind of processor"
    )]
    Processor {
        /// Instruction set that began the study.
        found: String,
        /// Instruction set of this processor.
        here: &'static str,
    },
    /// A folder of another study.
    #[error("the folder has the parts of another study; choose another folder\n  {}", differences.join("\n  "))]
    OtherStudy {
        /// What differs.
        differences: Vec<String>,
    },
    /// A folder with tables of another format.
    #[error("the parts are {found} tables, not {wanted} tables; choose {found}")]
    OtherTable {
        /// Format of the parts.
        found: &'static str,
        /// Requested format.
        wanted: &'static str,
    },
    /// A part that was copied from another folder, or renamed.
    #[error(
        "{file} belongs to part {found} of the study {digest}, not to part {wanted} of this one; delete it, and the part is computed again"
    )]
    OtherPart {
        /// Name of the record.
        file: String,
        /// Number in the record.
        found: u64,
        /// Number that was expected.
        wanted: u64,
        /// Digest of the study in the record.
        digest: String,
    },
    /// A table that has changed since it was written.
    #[error(
        "{file} is not the table that was written: {found} bytes with SHA-256 {found_sha256}, expected {bytes} bytes with {sha256}; delete {record}, and the part is computed again"
    )]
    Changed {
        /// Name of the table.
        file: String,
        /// Name of the record.
        record: String,
        /// Length in bytes.
        found: u64,
        /// Its SHA-256.
        found_sha256: String,
        /// Length when it was written, in bytes.
        bytes: u64,
        /// SHA-256 when it was written.
        sha256: String,
    },
    /// Parts that are not finished.
    #[error("{missing} of {parts} parts are missing, the first is part {first}")]
    Missing {
        /// How many are missing.
        missing: u64,
        /// How many there are.
        parts: u64,
        /// Number of the first missing one.
        first: u64,
    },
    /// An error of the table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// An error of the study.
    #[error(transparent)]
    Study(#[from] StudyError),
}

impl PartsError {
    pub(super) fn malformed(file: &str, why: impl Into<String>) -> Self {
        Self::Malformed { file: file.to_owned(), why: why.into() }
    }

    /// From an error of the JSON reader, without its own words.
    pub(super) fn json(file: &str, error: &serde_json::Error) -> Self {
        let (line, column) = (error.line(), error.column());
        let why = if error.is_data() {
            "a key is missing, unknown, or has a value of another kind".to_owned()
        } else {
            format!("no JSON at line {line}, column {column}")
        };
        Self::malformed(file, why)
    }
}
