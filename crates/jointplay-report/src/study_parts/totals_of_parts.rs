//! Totals of a study from those of its parts.

use jointplay_format::study::StudyFile;
use jointplay_study::plan::Totals;

use super::digest::digest;
use super::error::PartsError;
use super::names::PartNames;
use super::part::Record;
use crate::study_table::{TableKind, are_totals_of};

/// Adds the totals of parts in the order of their numbers, so that the sum has the bits of one machine.
pub struct TotalsOfParts {
    digest: String,
    samples: u64,
    parts: u64,
    /// Of a part.
    rows: u64,
    next: u64,
    totals: Totals,
}

impl TotalsOfParts {
    /// Of no parts yet.
    ///
    /// # Errors
    /// [`PartsError::Study`].
    pub fn new(study: &StudyFile) -> Result<Self, PartsError> {
        let plan = &study.plan;
        Ok(Self {
            digest: digest(study),
            samples: plan.samples()?,
            parts: plan.chunks()?,
            rows: plan.portions().chunk,
            next: 0,
            totals: Totals::for_study(&**plan),
        })
    }

    /// Adds the part that follows.
    ///
    /// # Arguments
    /// * `record` – contents of its record
    ///
    /// # Errors
    /// [`PartsError::Malformed`], [`PartsError::VersionOfPart`], [`PartsError::OtherPart`].
    pub fn add(&mut self, record: &str) -> Result<(), PartsError> {
        self.add_record(record).map(|_| ())
    }

    pub(super) fn add_record(&mut self, text: &str) -> Result<Record, PartsError> {
        let part = self.next;
        let file = PartNames::of(part, TableKind::Csv).record;
        let record = Record::parse(&file, text)?;
        if record.part != part || record.digest != self.digest {
            let Record { part: found, digest, .. } = record;
            return Err(PartsError::OtherPart { file, found, wanted: part, digest });
        }
        let malformed = |why: &str| PartsError::malformed(&file, why);
        let totals = record.totals.read().map_err(malformed)?;
        let rows = self.samples.saturating_sub(part.saturating_mul(self.rows)).min(self.rows);
        if !are_totals_of(&totals, &self.totals, rows) {
            return Err(malformed("its totals are not those of this part"));
        }
        self.totals.add(&totals);
        self.next += 1;
        Ok(record)
    }

    /// Number of the part that follows.
    #[must_use]
    pub fn next(&self) -> u64 {
        self.next
    }

    /// The totals of all parts.
    ///
    /// # Errors
    /// [`PartsError::Missing`].
    pub fn finish(self) -> Result<Totals, PartsError> {
        let Self { parts, next, totals, .. } = self;
        if next < parts {
            return Err(PartsError::Missing { missing: parts - next, parts, first: next });
        }
        Ok(totals)
    }
}
