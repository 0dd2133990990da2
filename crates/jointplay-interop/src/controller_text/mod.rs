//! Texts of controllers: lines from templates, with numbers, codes and checksums.

mod axis_format;
mod checksum;
mod codes;
mod command_problem;
mod format_spec;
mod output;
mod pieces;
mod problem;
mod template;
mod template_table;
mod tree;

pub(crate) use axis_format::{AxisFormat, count, one_line};
pub(crate) use checksum::Checksum;
pub(crate) use codes::Codes;
pub use command_problem::CommandProblem;
pub(crate) use format_spec::{Kind, Value};
pub(crate) use output::{Output, OutputFormat};
pub(crate) use pieces::{Pieces, Unpaired};
pub use problem::Problem;
pub(crate) use template::{Decimals, Names, Template};
pub(crate) use template_table::TemplateTable;
pub(crate) use tree::{Reader, Table};
