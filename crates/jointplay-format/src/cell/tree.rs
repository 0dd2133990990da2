//! The recovering reader, for cell files and files of robots with arms.

use super::problem::Fault;
use crate::toml_reader;

pub(super) use crate::toml_reader::{AllowedRange, Entry};

/// A text with the errors found in it.
pub(super) type Reader<'a> = toml_reader::Reader<'a, Fault>;

/// A table of the file.
pub(super) type Table<'r, 'a> = toml_reader::Table<'r, 'a, Fault>;
