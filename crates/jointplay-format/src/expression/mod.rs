//! Numbers written as expressions of named numbers, in files and in programs.
//!
//! | file | contents |
//! | --- | --- |
//! | `token` | tokens |
//! | `functions` | names of functions, and the unit of their angles |
//! | `parser` | from tokens to an expression |
//! | `formula` | expressions in the text of a value, and their evaluation |
//! | `write` | from an expression to text |
//! | `problem` | errors |

mod formula;
mod functions;
mod parser;
mod problem;
mod token;
mod write;

pub(crate) use formula::Scope;
pub use formula::{Formula, Variable};
pub use functions::AngleUnit;
pub(crate) use parser::{Parsed, Parser, VariableName};
pub use problem::{ExpressionError, ExpressionProblem};
pub(crate) use token::{Token, TokenKind, is_free_name, number_length};
pub(crate) use write::{Rank, text};
