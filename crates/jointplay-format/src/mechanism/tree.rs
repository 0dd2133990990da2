//! The recovering reader, for mechanism files and loop closure files.

use super::problem::Problem;
use crate::toml_reader;

pub(super) use crate::toml_reader::{AllowedRange, Entry};

/// A text and its errors.
pub(super) type Reader<'a> = toml_reader::Reader<'a, Problem>;

/// A table of the file.
pub(super) type Table<'r, 'a> = toml_reader::Table<'r, 'a, Problem>;
