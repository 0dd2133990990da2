//! Formatting of a program's text.

use super::lexer::{Kind, Line, Token, lines};
use super::parser::parse;
use super::problem::Error;
use super::words::{DIRECTIONS, Unit, reserved};

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
        if starts("END") {
            depth = depth.saturating_sub(1);
        }
        for _ in 0..depth {
            out.push_str(INDENT);
        }
        depth += usize::from(starts("REPEAT") || starts("ROUTINE"));
        out.push_str(&laid_out(&line));
        out.push('\n');
    }
    Ok(out)
}

fn laid_out(line: &Line<'_>) -> String {
    let mut text = String::new();
    for (index, token) in line.tokens.iter().enumerate() {
        if index > 0 {
            text.push(' ');
        }
        text.push_str(&written(&line.tokens[..index], token));
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

/// The text of a token, given the tokens before it.
fn written(before: &[Token<'_>], token: &Token<'_>) -> String {
    match (token.kind, before) {
        (Kind::Word, _) if reserved(token.text).is_some() => token.text.to_ascii_uppercase(),
        (Kind::Word, [.., last]) if matches!(last.kind, Kind::Number(_)) => Unit::of(token.text)
            .map_or_else(|| token.text.to_owned(), |unit| unit.symbol().to_owned()),
        // Directions are keywords only after BY; elsewhere they may be axes or effectors.
        (Kind::Word, _) if before.iter().any(|it| it.is("BY")) => {
            let direction = DIRECTIONS.into_iter().find(|direction| token.is(direction));
            direction.unwrap_or(token.text).to_owned()
        }
        (Kind::Number(_), [.., slot, Token { kind: Kind::Word | Kind::Quoted, .. }])
            if slot.is("SLOT") =>
        {
            let (sign, digits) = token.text.split_at(1);
            format!("{sign} {digits}")
        }
        _ => token.text.to_owned(),
    }
}
