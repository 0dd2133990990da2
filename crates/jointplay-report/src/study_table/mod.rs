//! The table of a study of any length: written chunk by chunk, resumable.
//!
//! | to… | use |
//! | --- | --- |
//! | write the table | [`Table`] |
//! | save the progress of a run | [`Marker`] |
//! | hand a chunk to other libraries | [`record_batch`], with the feature `parquet` |

#[cfg(feature = "parquet")]
mod arrow;
#[cfg(feature = "parquet")]
mod compact_struct;
mod kind;
mod marker;
#[cfg(feature = "parquet")]
mod parquet;
mod table;
mod totals_document;
mod value;

#[cfg(feature = "parquet")]
pub use arrow::{arrow_schema, record_batch};
pub use kind::TableKind;
pub use marker::{Marker, MarkerError};
pub use table::{Encoded, Index, Table};
pub(crate) use totals_document::{TotalsDocument, are_totals_of};
