//! Numbers written as expressions of named numbers, in files and in programs.
//!
//! | file | contents |
//! | --- | --- |
//! | `token` | tokens |
//! | `functions` | names of functions, and the unit of their angles |
//! | `parser` | from tokens to an expression |
//! | `formula` | expressions in the text of a value, and their evaluation |
//! | `problem` | errors |

mod formula;
mod functions;
mod parser;
mod problem;
mod token;

pub(crate) use formula::{Formula, Scope};
pub use functions::AngleUnit;
pub(crate) use problem::ExpressionError;
pub use problem::ExpressionProblem;
pub(crate) use token::is_free_name;
