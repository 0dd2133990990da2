//! What is wrong with a program in its cell, shown in its text.

use jointplay_cell::program::{Place, ProgramError, ProgramProblem};

use super::lexer::{Token, line_at};
use crate::place::{self, Error, nearest, suggestion};

/// What is wrong with a program in its cell, as a message.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Explained {
    /// The message.
    pub message: String,
}

/// Shows in the text of a program what is wrong with it in its cell.
#[must_use]
pub fn explain(text: &str, error: &ProgramError) -> Error<Explained> {
    let mut message = error.to_string();
    if let ProgramProblem::Unknown { found, known, .. } = &error.problem {
        let lower = found.to_lowercase();
        // Names are told apart by case, which hasty typing does not.
        let alike = known.iter().find(|name| name.to_lowercase() == lower);
        let nearest = alike.cloned().or_else(|| nearest(found, known.iter().map(String::as_str)));
        message += &suggestion(&nearest);
    }
    Error { place: shown(text, error.place), problem: Box::new(Explained { message }) }
}

/// The line of a place, and how much of it is meant.
fn shown(text: &str, at: Place) -> place::Place {
    let line = line_at(text, at.line);
    let token = line.as_ref().and_then(|line| line.tokens.iter().find(|it| it.column == at.column));
    place::Place {
        line: at.line,
        column: at.column.max(1),
        width: token.map_or(0, Token::width),
        text: line.as_ref().map_or_else(String::new, |line| line.text.to_owned()),
    }
}
