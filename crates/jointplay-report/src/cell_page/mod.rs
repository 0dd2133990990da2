//! The report on a cell as a page: HTML without scripts and without other files, fit for printing.

mod key_figures;
mod page;

pub use key_figures::{KeyFigure, key_figures};
pub use page::{CellPage, PagePicture, PageProgram};
