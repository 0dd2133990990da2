//! The table of a study of any length: written chunk by chunk, resumable.
//!
//! | to… | use |
//! | --- | --- |
//! | write the table | [`Table`] |
//! | save the progress of a run | [`Marker`] |

mod kind;
mod marker;
#[cfg(feature = "parquet")]
mod parquet;
mod table;
mod value;

pub use kind::TableKind;
pub use marker::{Marker, MarkerError};
pub use table::{Encoded, Index, Table};
