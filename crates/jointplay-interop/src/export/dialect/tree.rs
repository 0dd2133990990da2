//! The tables of a dialect file.

use jointplay_format::toml_reader;

use super::problem::Problem;

pub(super) type Reader<'a> = toml_reader::Reader<'a, Problem>;
pub(super) type Table<'r, 'a> = toml_reader::Table<'r, 'a, Problem>;
