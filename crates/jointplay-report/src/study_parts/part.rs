//! One part: its table, and the record that is written after it.

use jointplay_format::study::StudyFile;
use jointplay_study::plan::{Block, Totals};
use serde::{Deserialize, Serialize};

use super::digest::{VERSION, digest, other_version};
use super::error::PartsError;
use super::names::PartNames;
use crate::sha256::sha256;
use crate::study_table::{Table, TableKind, TotalsDocument};

/// The files of a finished part, in the order of their writing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PartFiles {
    /// Their names.
    pub names: PartNames,
    /// Contents of the table.
    pub table: Vec<u8>,
    /// Contents of the record (JSON).
    pub record: String,
}

/// Makes the files of parts.
pub struct PartWriter {
    digest: String,
    table: Table,
    kind: TableKind,
}

impl PartWriter {
    /// Of a study, with tables of this format.
    ///
    /// # Errors
    /// As [`Table::new`].
    pub fn new(study: &StudyFile, kind: TableKind) -> Result<Self, PartsError> {
        let table = Table::new(kind, study.columns.clone())?;
        Ok(Self { digest: digest(study), table, kind })
    }

    /// The files of a part.
    ///
    /// # Arguments
    /// * `blocks` – the samples of its chunk
    ///
    /// # Errors
    /// As [`Table::encode`].
    pub fn files(&self, part: u64, blocks: &[Block]) -> Result<PartFiles, PartsError> {
        let names = PartNames::of(part, self.kind);
        let table = self.table.of_chunk(blocks)?;
        let record = Record {
            jointplay: VERSION.to_owned(),
            digest: self.digest.clone(),
            part,
            table: names.table.clone(),
            bytes: table.len() as u64,
            sha256: sha256(&table),
            totals: TotalsDocument::new(&Totals::of_chunk(blocks)),
        };
        let record = serde_json::to_string_pretty(&record);
        let record = record.expect("a document of texts and whole numbers") + "\n";
        Ok(PartFiles { names, table, record })
    }
}

/// The record of a part.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Record {
    jointplay: String,
    /// Of the study.
    pub(super) digest: String,
    pub(super) part: u64,
    /// Name of the table.
    pub(super) table: String,
    /// Length of the table (bytes).
    pub(super) bytes: u64,
    /// Of the table.
    pub(super) sha256: String,
    pub(super) totals: TotalsDocument,
}

impl Record {
    /// Reads a record.
    ///
    /// # Errors
    /// [`PartsError::Malformed`], [`PartsError::VersionOfPart`].
    pub(super) fn parse(file: &str, text: &str) -> Result<Self, PartsError> {
        let invalid = |error| PartsError::json(file, &error);
        let value = serde_json::from_str(text).map_err(invalid)?;
        if let Some(found) = other_version(&value) {
            let (file, found) = (file.to_owned(), found.to_owned());
            return Err(PartsError::VersionOfPart { file, found, here: VERSION });
        }
        serde_json::from_value(value).map_err(invalid)
    }
}
