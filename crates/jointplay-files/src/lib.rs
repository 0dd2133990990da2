//! Files of the command and the studio: those that input names, and those that are written whole.
//!
//! | to… | use |
//! | --- | --- |
//! | read a file that another file names | [`read`], or [`find`] for its path |
//! | replace a file by complete contents | [`NewFile`], [`write_durable`] |
//! | replace two files, or neither | [`replace_both`] |
//! | explain why the system refuses a file | [`explain_read`], [`explain_write`] |

#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a failing test may panic"))]

mod explained;
mod named;
mod whole;

pub use explained::{explain_read, explain_write};
pub use named::{Refused, find, read};
pub use whole::{NewFile, PARTIAL_PREFIX, replace_both, sync_folder, write_durable};
