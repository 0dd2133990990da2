//! Texts of the report on a cell that the command and the report page have in common: labelled lines and tables.

mod facts;
mod segments;
mod tables;
mod text_table;

pub use facts::{Fact, cell_facts};
pub use tables::cell_tables;
pub use text_table::{TableColumn, TextTable};
