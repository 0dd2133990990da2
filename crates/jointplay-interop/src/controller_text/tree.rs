//! The tables of a file of a dialect or a host language.

use jointplay_format::toml_reader;

use super::problem::Problem;

pub(crate) type Reader<'a> = toml_reader::Reader<'a, Problem>;
pub(crate) type Table<'r, 'a> = toml_reader::Table<'r, 'a, Problem>;
