//! Formatting of a program's text.

use super::lexer::{Kind, Line, Token, lines};
use super::parser::parse;
use super::problem::Error;
use super::words::{DIRECTIONS, reserved, unit};

/// Indentation of a block.
pub(super) const INDENT: &str = "  ";

/// Formats a program: keywords in capitals, one space between tokens, indented blocks, at most one empty line in a row; comments remain.
///
/// # Errors
/// As [`parse`]: a text with errors is not formatted.
pub fn format(text: &str) -> Result<String, Vec<Error>> {
    parse(text)?;
    let (mut out, mut depth, mut empty) = (String::new(), 0_usize, false);
    for line in lines(text) {
        if line.tokens.is_empty() && line.comment.is_none() {
            empty = !out.is_empty();
            continue;
        }
        if empty {
            out.push('\n');
            empty = false;
        }
        let starts = |word| line.tokens.first().is_some_and(|first| first.is(word));
        if starts("END") || starts("ELSE") {
            depth = depth.saturating_sub(1);
        }
        for _ in 0..depth {
            out.push_str(INDENT);
        }
        depth += usize::from(["REPEAT", "IF", "ELSE", "ROUTINE"].into_iter().any(starts));
        out.push_str(&laid_out(&line));
        out.push('\n');
    }
    Ok(out)
}

fn laid_out(line: &Line<'_>) -> String {
    let mut text = String::new();
    let mut state = LineState::default();
    for token in &line.tokens {
        let before = state.last;
        let written = state.next(token);
        if separated(before, state.last, token) {
            text.push(' ');
        }
        text.push_str(&written);
    }
    if let Some(comment) = line.comment {
        if !text.is_empty() {
            text.push_str("  ");
        }
        let inner = comment.trim_start_matches('#');
        let marks = &comment[..comment.len() - inner.len()];
        text.push_str(marks);
        if !inner.is_empty() && !inner.starts_with(char::is_whitespace) {
            text.push(' ');
        }
        text.push_str(inner);
    }
    text
}

/// Role of a token in its line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Role {
    /// The start of the line.
    #[default]
    Start,
    Keyword,
    /// An axis or a direction, before its position.
    Axis,
    /// The end of an operand: a number, a name or a closing parenthesis.
    Operand,
    Unit,
    /// A sign before an operand.
    Sign,
    Open,
    /// Any other sign: an operator between operands, a comparison, a comma.
    Operator,
}

/// Roles of the tokens of a line, from left to right.
#[derive(Default)]
struct LineState {
    last: Role,
    /// Whether the line is a MOVE, and a name is an axis.
    expects_axis: bool,
    /// Whether the line is a MOVE.
    moves: bool,
    /// Whether directions follow.
    by: bool,
    /// Number of open parentheses.
    depth: usize,
}

impl LineState {
    /// Passes a token, and returns its text.
    fn next(&mut self, token: &Token<'_>) -> String {
        if let (Kind::Word, Some(keyword)) = (token.kind, reserved(token.text)) {
            self.moves |= keyword == "MOVE";
            self.by |= keyword == "BY";
            (self.expects_axis, self.last) = (self.moves, Role::Keyword);
            return keyword.to_owned();
        }
        let follows_operand = self.last == Role::Operand;
        let is_operand = matches!(token.kind, Kind::Number(_) | Kind::Word | Kind::Quoted);
        // Two operands do not follow each other: the second one is a unit.
        if let (true, Some(unit)) = (follows_operand && self.depth == 0, unit(token.text)) {
            (self.expects_axis, self.last) = (self.moves, Role::Unit);
            return unit.symbol().to_owned();
        }
        if is_operand && self.expects_axis && self.depth == 0 {
            (self.expects_axis, self.last) = (false, Role::Axis);
            let direction = DIRECTIONS.into_iter().find(|word| self.by && token.is(word));
            return direction.unwrap_or(token.text).to_owned();
        }
        self.last = match token.text {
            _ if is_operand => Role::Operand,
            "(" => {
                self.depth += 1;
                Role::Open
            }
            ")" => {
                self.depth = self.depth.saturating_sub(1);
                Role::Operand
            }
            "+" | "-" if !follows_operand => Role::Sign,
            _ => Role::Operator,
        };
        token.text.to_owned()
    }
}

/// Whether a space separates a token from the one before it.
fn separated(before: Role, role: Role, token: &Token<'_>) -> bool {
    match before {
        Role::Start | Role::Sign | Role::Open => false,
        // Arguments follow the name without a space.
        Role::Operand if role == Role::Open => false,
        _ => !matches!(token.text, ")" | ","),
    }
}
