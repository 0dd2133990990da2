//! The robot and mechanism files that are included.

mod entries;
mod summary;

pub use entries::{Entry, entries, find};
