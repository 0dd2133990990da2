//! Study files: what is varied, over which values or at random, and what is written of each sample.
//!
//! | to… | use |
//! | --- | --- |
//! | read a study file | [`parse`] → [`StudyFile`] |
//! | list those that come with the program | [`examples`] |
//! | know the columns of its table | [`StudyFile::columns`] |
//! | write the table, chunk by chunk | [`Table`] |
//! | keep how far a run has come | [`Marker`] |

mod examples;
mod marker;
mod names;
mod problem;
mod read;
mod spread;
mod table;
#[cfg(feature = "parquet")]
mod table_parquet;

pub use examples::{Example, example, examples};
pub use marker::{Marker, MarkerError};
pub use names::{Column, Source};
pub use problem::{Error, Problem};
pub use read::{MAX_BYTES, StudyFile, parse, robot_of};
pub use table::{Encoded, Index, Table, TableError, TableKind};
