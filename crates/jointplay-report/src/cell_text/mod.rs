//! Texts of the report on a cell that the command and the report page have in common: labelled lines and tables.

mod facts;
mod segments;
mod tables;

pub use facts::{Fact, cell_facts};
pub use tables::{TableColumn, TextTable, cell_tables};
