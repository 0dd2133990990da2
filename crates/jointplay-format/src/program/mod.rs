//! Programs as text: one command a line.
//!
//! ```text
//!     HOME
//!     REPEAT 25 AS n              # every wafer of the lot
//!       TRANSFER port-1 SLOT n TO aligner WITH A
//!       TRANSFER aligner TO port-2 SLOT 26 - n WITH A
//!     END
//! ```
//! The grammar is in `docs/reference/programs.md`.
//!
//! | to… | use |
//! | --- | --- |
//! | read a program | [`parse`] |
//! | read the valid lines of a program | [`parse_recovering`] |
//! | recognise a program | [`is_program`] |
//! | format the text of a program | [`format`](fn@format) |
//! | write a program as text | [`write`](fn@write) |
//! | set parameters in the text of a program | [`with_parameters`] |
//! | name a phase of an instruction | [`phase_name`] |
//! | show a planning error in the text | [`explain`](fn@explain) |

mod commands;
mod condition;
mod cursor;
mod dimension;
mod explain;
mod layout;
mod lexer;
mod parser;
mod phase;
mod problem;
mod settings;
mod words;
mod write;

pub use explain::{Explained, explain};
pub use layout::format;
pub use parser::{MAX_BYTES, MAX_DEPTH, is_program, parse, parse_recovering};
pub use phase::phase_name;
pub use problem::{Error, Problem};
pub use settings::{Setting, SettingProblem, with_parameters};
pub(crate) use settings::{parameters, value_text};
pub use words::keywords;
pub use write::write;

/// Example program for the example cell: a lot of 25 wafers is processed and returned.
pub const EXAMPLE: &str = include_str!("../../cells/example.program");
