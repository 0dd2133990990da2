//! The destination of the table of a study: a file, or standard output.

use std::io::Write as _;
use std::path::Path;

use jointplay::format::study::StudyFile;
use jointplay::report::study_table::{Encoded, Table};
use jointplay::study::plan::{Block, Totals};

use super::part_file::PartFile;
use crate::failure::Failure;

/// The destination of a table that is written chunk by chunk.
pub(super) enum Destination {
    /// A file that another run can resume.
    File(Box<PartFile>),
    /// Standard output; an interrupted run cannot be resumed.
    StandardOutput { chunks: u64, totals: Totals },
}

impl Destination {
    /// Starts a table on standard output.
    pub(super) fn standard_output(study: &StudyFile, table: &Table) -> Result<Self, Failure> {
        print(&table.head())?;
        let totals = Totals::for_study(&*study.plan);
        Ok(Self::StandardOutput { chunks: 0, totals })
    }

    /// Number of chunks written.
    pub(super) fn chunks(&self) -> u64 {
        match self {
            Self::File(part) => part.chunks(),
            Self::StandardOutput { chunks, .. } => *chunks,
        }
    }

    /// Statistics of the columns written so far.
    pub(super) fn totals(&self) -> &Totals {
        match self {
            Self::File(part) => part.totals(),
            Self::StandardOutput { totals, .. } => totals,
        }
    }

    /// Number of samples written.
    pub(super) fn samples(&self) -> u64 {
        self.totals().samples
    }

    /// Appends one chunk.
    pub(super) fn append(
        &mut self,
        table: &Table,
        blocks: &[Block],
        encoded: &Encoded,
    ) -> Result<(), Failure> {
        match self {
            Self::File(part) => part.append(table, blocks, encoded),
            Self::StandardOutput { chunks, totals } => {
                encoded.parts.iter().try_for_each(|bytes| print(bytes))?;
                totals.add(&Totals::of_chunk(blocks));
                *chunks += 1;
                Ok(())
            }
        }
    }

    /// Saves the chunks written before a failure; the incomplete file, where there is one to resume.
    pub(super) fn save(&mut self, table: &Table) -> Option<&Path> {
        match self {
            Self::File(part) => Some(part.save(table)),
            Self::StandardOutput { .. } => None,
        }
    }

    /// Closes the table after an interruption, and describes how to continue.
    pub(super) fn interrupt(&mut self, table: &Table, count: u64) -> Result<String, Failure> {
        let samples = self.samples();
        match self {
            Self::File(part) => {
                let files = part.interrupt(table)?;
                Ok(format!(
                    "{samples} of {count} samples are in {}; the same command with --resume continues to {}",
                    files.part.display(),
                    files.table.display()
                ))
            }
            Self::StandardOutput { .. } => {
                Ok(format!("{samples} of {count} samples were written to standard output"))
            }
        }
    }

    /// Completes the table.
    pub(super) fn finish(self, table: &Table) -> Result<(), Failure> {
        match self {
            Self::File(part) => part.finish(table),
            Self::StandardOutput { .. } => Ok(std::io::stdout().lock().flush()?),
        }
    }
}

fn print(bytes: &[u8]) -> Result<(), Failure> {
    Ok(std::io::stdout().lock().write_all(bytes)?)
}
