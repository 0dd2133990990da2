//! Programs as text: one command a line.
//!
//! ```text
//!     HOME
//!     REPEAT 25 AS n              # every wafer of the lot
//!       TRANSFER port-1 SLOT n TO aligner WITH A
//!       TRANSFER aligner TO port-2 SLOT 26 - n WITH A
//!     END
//! ```
//! The grammar is in `docs/programs.md`.
//!
//! | to… | use |
//! | --- | --- |
//! | read a program | [`parse`] |
//! | lay its text out | [`format`](fn@format) |
//! | write one that is no text yet | [`write`] |
//! | show where in the text something is wrong with it | [`place`] |

mod cursor;
mod layout;
mod lexer;
mod parser;
mod problem;
mod words;
mod write;

pub use layout::format;
pub use parser::{MAX_BYTES, MAX_DEPTH, parse};
pub use problem::{Error, Problem};
pub use write::write;

/// The program of the cell that comes along: a lot of 25 wafers, processed, and brought back.
pub const EXAMPLE: &str = include_str!("../../../../cells/example.program");

/// What stands at a place of a text, for messages that show it.
#[must_use]
pub fn place(text: &str, at: jointplay_cell::program::Place) -> crate::place::Place {
    let line = lexer::lines(text).nth(at.line.saturating_sub(1));
    let token = line.as_ref().and_then(|it| it.tokens.iter().find(|it| it.column == at.column));
    crate::place::Place {
        line: at.line,
        column: at.column,
        width: token.map_or(0, lexer::Token::width),
        text: line.as_ref().map_or_else(String::new, |line| line.text.to_owned()),
    }
}
