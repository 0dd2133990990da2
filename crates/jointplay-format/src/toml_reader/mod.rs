//! A recovering reader of TOML: tables are read key by key, and every error is recorded with its place.
//!
//! `P` is the problem type of a file, which includes the common ones by [`From`]`<`[`FileProblem`](crate::file_problem::FileProblem)`>`.

mod document;
mod expressions;
pub(crate) mod parameters;
mod range;
mod reader;
mod source;
mod table;

pub use document::read_document;
pub use range::{AllowedRange, LARGEST};
pub use reader::Reader;
pub use source::Inclusion;
pub(crate) use table::LONGEST_NAME;
pub use table::{Entry, Table};
