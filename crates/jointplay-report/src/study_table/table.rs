//! The table of a study, written chunk by chunk.

use jointplay_study::plan::Block;
use rayon::prelude::*;

use super::kind::TableKind;
use super::value::value_in_table;
use crate::table_error::TableError;
use jointplay_format::study::{Column, Source};

/// A chunk on its way into a file.
#[derive(Debug, Default)]
pub struct Encoded {
    /// Its bytes, in order.
    pub parts: Vec<Vec<u8>>,
    /// Where its columns are.
    #[cfg(feature = "parquet")]
    pub(super) group: Option<super::parquet::Group>,
}

/// A table on its way into a file.
pub struct Table {
    columns: Vec<Column>,
    kind: Kind,
}

enum Kind {
    Csv,
    #[cfg(feature = "parquet")]
    Parquet(super::parquet::Schema),
}

/// What a table has to say of its chunks at its end; nothing for comma-separated values.
#[derive(Default)]
pub struct Index {
    #[cfg(feature = "parquet")]
    pub(super) groups: Vec<super::parquet::Group>,
}

impl Table {
    /// A table of these columns.
    ///
    /// # Errors
    /// [`TableError::WithoutParquet`], [`TableError::Encoding`].
    pub fn new(kind: TableKind, columns: Vec<Column>) -> Result<Self, TableError> {
        let kind = match kind {
            TableKind::Csv => Kind::Csv,
            #[cfg(feature = "parquet")]
            TableKind::Parquet => Kind::Parquet(super::parquet::Schema::new(&columns)?),
            #[cfg(not(feature = "parquet"))]
            TableKind::Parquet => return Err(TableError::WithoutParquet),
        };
        Ok(Self { columns, kind })
    }

    /// What stands before the first chunk.
    #[must_use]
    pub fn head(&self) -> Vec<u8> {
        match &self.kind {
            Kind::Csv => {
                let names: Vec<&str> = self.columns.iter().map(|c| c.name.as_str()).collect();
                (names.join(",") + "\n").into_bytes()
            }
            #[cfg(feature = "parquet")]
            Kind::Parquet(_) => super::parquet::MAGIC.to_vec(),
        }
    }

    /// A chunk as it will stand in the file.
    ///
    /// # Errors
    /// [`TableError::Encoding`].
    pub fn encode(&self, blocks: &[Block]) -> Result<Encoded, TableError> {
        match &self.kind {
            Kind::Csv => {
                let parts = blocks.par_iter().map(|block| csv(&self.columns, block)).collect();
                #[cfg_attr(
                    not(feature = "parquet"),
                    expect(clippy::needless_update, reason = "only Parquet has groups")
                )]
                let encoded = Encoded { parts, ..Encoded::default() };
                Ok(encoded)
            }
            #[cfg(feature = "parquet")]
            Kind::Parquet(schema) => {
                let (bytes, group) = schema.encode(&self.columns, blocks)?;
                Ok(Encoded { parts: vec![bytes], group: Some(group) })
            }
        }
    }

    /// Notes that a chunk stands in the file from byte `at` on.
    ///
    /// # Errors
    /// [`TableError::Encoding`].
    #[cfg_attr(
        not(feature = "parquet"),
        expect(unused_variables, reason = "only Parquet keeps an index")
    )]
    pub fn note(&self, index: &mut Index, encoded: &Encoded, at: u64) -> Result<(), TableError> {
        #[cfg(feature = "parquet")]
        if let Some(group) = &encoded.group {
            index.groups.push(super::parquet::placed(group, at)?);
        }
        Ok(())
    }

    /// What stands after the last chunk.
    ///
    /// # Errors
    /// [`TableError::Encoding`].
    #[cfg_attr(
        not(feature = "parquet"),
        expect(unused_variables, reason = "only Parquet keeps an index")
    )]
    pub fn foot(&self, index: &Index) -> Result<Vec<u8>, TableError> {
        match &self.kind {
            Kind::Csv => Ok(Vec::new()),
            #[cfg(feature = "parquet")]
            Kind::Parquet(schema) => schema.foot(&index.groups),
        }
    }

    /// Reads back the result of [`Self::foot`].
    ///
    /// # Errors
    /// [`TableError::Footer`] for anything else.
    #[cfg_attr(
        not(feature = "parquet"),
        expect(unused_variables, reason = "only Parquet keeps an index")
    )]
    pub fn index(&self, foot: &[u8]) -> Result<Index, TableError> {
        match &self.kind {
            Kind::Csv => Ok(Index::default()),
            #[cfg(feature = "parquet")]
            Kind::Parquet(_) => Ok(Index { groups: super::parquet::groups(foot)? }),
        }
    }
}

/// The rows of a block.
fn csv(columns: &[Column], block: &Block) -> Vec<u8> {
    /// About as many bytes as a number takes.
    const CELL: usize = 18;
    let mut text = Vec::with_capacity(block.samples.len() * columns.len() * CELL);
    let (mut numbers, mut counts) = (zmij::Buffer::new(), itoa::Buffer::new());
    for row in 0..block.samples.len() {
        for (place, column) in columns.iter().enumerate() {
            if place > 0 {
                text.push(b',');
            }
            let cell = match column.source {
                Source::Sample => counts.format(block.samples[row]),
                Source::Draw => counts.format(block.draws[row]),
                Source::Status { model } => block.outcomes[model][row].name(),
                Source::Number { index, unit, typed, .. } => {
                    let value = block.columns[index][row];
                    if value.is_nan() {
                        ""
                    } else {
                        numbers.format(value_in_table(value, unit, typed))
                    }
                }
            };
            text.extend_from_slice(cell.as_bytes());
        }
        text.push(b'\n');
    }
    text
}
