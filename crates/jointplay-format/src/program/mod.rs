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
//! | read what can be read of one | [`parse_recovering`] |
//! | lay its text out | [`format`](fn@format) |
//! | write one that is no text yet | [`write`](fn@write) |
//! | show where in the text something is wrong with it in its cell | [`explain`](fn@explain) |

mod cursor;
mod explain;
mod layout;
mod lexer;
mod parser;
mod problem;
mod words;
mod write;

pub use explain::{Explained, explain};
pub use layout::format;
pub use parser::{MAX_BYTES, MAX_DEPTH, parse, parse_recovering};
pub use problem::{Error, Problem};
pub use words::keywords;
pub use write::write;

/// The program of the cell that comes along: a lot of 25 wafers, processed, and brought back.
pub const EXAMPLE: &str = include_str!("../../../../cells/example.program");
