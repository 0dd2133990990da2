//! The table of a study from its parts.

use jointplay_study::plan::Totals;

use super::error::PartsError;
use super::manifest::Manifest;
use super::names::PartNames;
use super::part::Record;
use super::totals_of_parts::TotalsOfParts;
use crate::sha256::sha256;
use crate::study_table::{Index, Table, TableKind};
use crate::table_error::TableError;

/// Puts parts together to the bytes of a run on one machine.
pub struct Gathering {
    kind: TableKind,
    table: Table,
    index: Index,
    /// Length of the table so far (bytes).
    at: u64,
    totals: TotalsOfParts,
}

impl Gathering {
    /// Of no parts yet.
    ///
    /// # Errors
    /// [`PartsError::Table`], [`PartsError::Study`].
    pub fn new(manifest: &Manifest) -> Result<Self, PartsError> {
        let Manifest { study, kind } = manifest;
        let table = Table::new(*kind, study.columns.clone())?;
        let at = table.head().len() as u64;
        let totals = TotalsOfParts::new(study)?;
        Ok(Self { kind: *kind, table, index: Index::default(), at, totals })
    }

    /// Bytes of the table before those of the parts.
    #[must_use]
    pub fn head(&self) -> Vec<u8> {
        self.table.head()
    }

    /// Names of the files of the part that follows.
    #[must_use]
    pub fn next(&self) -> PartNames {
        PartNames::of(self.totals.next(), self.kind)
    }

    /// Length that the table of the part that follows has by its record (bytes).
    ///
    /// # Arguments
    /// * `record` – contents of the record
    ///
    /// # Errors
    /// [`PartsError::Malformed`], [`PartsError::VersionOfPart`].
    pub fn table_length(&self, record: &str) -> Result<u64, PartsError> {
        Record::parse(&self.next().record, record).map(|record| record.bytes)
    }

    /// Adds the part that follows; its bytes in the table.
    ///
    /// # Arguments
    /// * `record`, `table` – contents of its two files
    ///
    /// # Errors
    /// As [`TotalsOfParts::add`]; [`PartsError::Changed`].
    pub fn add(&mut self, record: &str, table: &[u8]) -> Result<Vec<u8>, PartsError> {
        let names = self.next();
        let record = self.totals.add_record(record)?;
        if record.table != names.table {
            let why = format!("it names the table {}, not {}", record.table, names.table);
            return Err(PartsError::malformed(&names.record, why));
        }
        let (found, found_sha256) = (table.len() as u64, sha256(table));
        if (found, &found_sha256) != (record.bytes, &record.sha256) {
            return Err(PartsError::Changed {
                file: names.table,
                record: names.record,
                found,
                found_sha256,
                bytes: record.bytes,
                sha256: record.sha256,
            });
        }
        let chunk = self.table.chunk_of(table).map_err(|error| match error {
            TableError::Footer => {
                let why = "it is not a table of one chunk with the columns of the study";
                PartsError::malformed(&names.table, why)
            }
            other => other.into(),
        })?;
        self.table.note(&mut self.index, &chunk, self.at)?;
        let bytes = chunk.parts.concat();
        self.at += bytes.len() as u64;
        Ok(bytes)
    }

    /// Bytes of the table after those of the parts, and the totals of all.
    ///
    /// # Errors
    /// [`PartsError::Missing`].
    pub fn finish(self) -> Result<(Vec<u8>, Totals), PartsError> {
        let totals = self.totals.finish()?;
        Ok((self.table.foot(&self.index)?, totals))
    }
}
