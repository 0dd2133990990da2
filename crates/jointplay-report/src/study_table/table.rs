//! The table of a study, written chunk by chunk.

use jointplay_study::plan::Block;
use rayon::prelude::*;

use super::kind::TableKind;
use super::value::value_in_table;
use crate::table_error::TableError;
use jointplay_format::study::{Column, Source};

/// An encoded chunk of a table.
#[derive(Debug, Default)]
pub struct Encoded {
    /// Bytes of the chunk, in order.
    pub parts: Vec<Vec<u8>>,
    /// Positions of its columns.
    #[cfg(feature = "parquet")]
    pub(super) group: Option<super::parquet::Group>,
}

/// Encoder of a table.
pub struct Table {
    columns: Vec<Column>,
    kind: Kind,
}

enum Kind {
    Csv,
    #[cfg(feature = "parquet")]
    Parquet(super::parquet::Schema),
}

/// Positions of the chunks for the end of the table; empty for comma-separated values.
#[derive(Default)]
pub struct Index {
    #[cfg(feature = "parquet")]
    pub(super) groups: Vec<super::parquet::Group>,
}

impl Table {
    /// An encoder for a table with these columns.
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

    /// Bytes before the first chunk.
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

    /// The bytes of a chunk.
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

    /// A table of one chunk, as a file of its own.
    ///
    /// # Errors
    /// [`TableError::Encoding`].
    pub fn of_chunk(&self, blocks: &[Block]) -> Result<Vec<u8>, TableError> {
        let (mut bytes, mut index) = (self.head(), Index::default());
        let encoded = self.encode(blocks)?;
        self.note(&mut index, &encoded, bytes.len() as u64)?;
        bytes.extend(encoded.parts.concat());
        bytes.extend(self.foot(&index)?);
        Ok(bytes)
    }

    /// The chunk of a file written by [`Self::of_chunk`].
    ///
    /// # Errors
    /// [`TableError::Footer`] for anything else.
    pub fn chunk_of(&self, file: &[u8]) -> Result<Encoded, TableError> {
        let rest = file.strip_prefix(self.head().as_slice()).ok_or(TableError::Footer)?;
        match &self.kind {
            Kind::Csv => {
                #[cfg_attr(
                    not(feature = "parquet"),
                    expect(clippy::needless_update, reason = "only Parquet has groups")
                )]
                let encoded = Encoded { parts: vec![rest.to_vec()], ..Encoded::default() };
                Ok(encoded)
            }
            #[cfg(feature = "parquet")]
            Kind::Parquet(schema) => {
                let (bytes, group) = schema.chunk_of(file)?;
                Ok(Encoded { parts: vec![bytes.to_vec()], group: Some(group) })
            }
        }
    }

    /// Adds a chunk that begins at byte `at` of the file to the index.
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

    /// Bytes after the last chunk.
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

    /// Reads the result of [`Self::foot`].
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
            Kind::Parquet(schema) => Ok(Index { groups: schema.groups(foot)? }),
        }
    }
}

/// The rows of a block.
fn csv(columns: &[Column], block: &Block) -> Vec<u8> {
    /// Approximate length of a number in bytes.
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
