//! Reads one line from left to right.

use jointplay_cell::program::{Name, SourceLocation};

use super::lexer::{Kind, Line, Token, unquoted};
use super::problem::{Error, Problem};
use super::words::{Unit, is_foreign_unit, meant, reserved};
use crate::place;
use crate::units::{m_from_mm, shift};

/// A position in a line, with the alternatives that the grammar allows there.
pub(super) struct Cursor<'l, 't> {
    line: &'l Line<'t>,
    at: usize,
    /// Alternatives that were tried here without success.
    expected: Vec<String>,
}

impl<'l, 't> Cursor<'l, 't> {
    pub(super) fn new(line: &'l Line<'t>) -> Self {
        Self { line, at: 0, expected: Vec::new() }
    }

    pub(super) fn peek(&self) -> Option<&'l Token<'t>> {
        self.line.tokens.get(self.at)
    }

    pub(super) fn advance(&mut self) {
        self.at += 1;
        self.expected.clear();
    }

    /// Place of the next token, or the end of the line.
    pub(super) fn place(&self) -> SourceLocation {
        let end = self.line.tokens.last().map_or(1, |last| last.column + last.width());
        let column = self.peek().map_or(end, |token| token.column);
        SourceLocation { line: self.line.number, column }
    }

    /// A problem of the next token, or of the end of the line.
    pub(super) fn error(&self, problem: Problem) -> Error {
        self.error_at(self.place().column, self.peek().map_or(0, Token::width), problem)
    }

    pub(super) fn error_at(&self, column: usize, width: usize, problem: Problem) -> Error {
        let (line, text) = (self.line.number, self.line.text.to_owned());
        let place = place::Place { line, column, width, text };
        Error { place, problem: Box::new(problem) }
    }

    /// The error that the next token is none of the alternatives.
    pub(super) fn unexpected(&self) -> Error {
        let expected = self.expected.clone();
        let Some(token) = self.peek() else {
            let found = "the end of the line".to_owned();
            return self.error(Problem::Expected { expected, found, nearest: None });
        };
        let wants_name = expected.iter().any(|choice| choice.starts_with("the name"));
        self.error(match (token.kind, reserved(token.text)) {
            (Kind::Unclosed, _) => Problem::Unclosed { found: token.text.to_owned() },
            (Kind::Word, Some(_)) if wants_name => {
                Problem::Reserved { expected, word: token.text.to_owned() }
            }
            _ => {
                let words = expected.iter().map(String::as_str).filter(|it| reserved(it).is_some());
                let nearest = meant(token.text, words).filter(|_| token.kind == Kind::Word);
                let nearest = nearest.map(str::to_owned);
                Problem::Expected { nearest, found: shown(token), expected }
            }
        })
    }

    /// Advances past the next token if it is this word.
    pub(super) fn accept(&mut self, word: &str) -> bool {
        let found = self.peek().is_some_and(|token| token.is(word));
        if found {
            self.advance();
        } else {
            self.expected.push(word.to_owned());
        }
        found
    }

    pub(super) fn require(&mut self, word: &str) -> Result<(), Error> {
        if self.accept(word) { Ok(()) } else { Err(self.unexpected()) }
    }

    /// Advances past the next token if it is this sign.
    pub(super) fn accept_sign(&mut self, sign: &str) -> bool {
        let found = self.peek().is_some_and(|token| token.kind == Kind::Sign && token.text == sign);
        if found {
            self.advance();
        }
        found
    }

    /// The next token, if it is a name; `what` is the kind of the named object.
    pub(super) fn accept_name(&mut self, what: &str) -> Result<Option<Name>, Error> {
        let name = match self.peek() {
            Some(token) if token.kind == Kind::Quoted => unquoted(token),
            Some(token) if token.kind == Kind::Word && reserved(token.text).is_none() => {
                token.text.to_owned()
            }
            _ => {
                self.expected.push(format!("the name of {what}"));
                return Ok(None);
            }
        };
        if name.trim().is_empty() || name.contains(char::is_control) {
            return Err(self.error(Problem::Name { found: format!("{name:?}") }));
        }
        let place = self.place();
        self.advance();
        Ok(Some(Name { text: name, place }))
    }

    pub(super) fn name(&mut self, what: &str) -> Result<Name, Error> {
        self.accept_name(what)?.ok_or_else(|| self.unexpected())
    }

    /// A whole number from `min` to `max`, if the next token is a number.
    pub(super) fn accept_whole(
        &mut self,
        what: &'static str,
        min: i64,
        max: i64,
    ) -> Result<Option<i64>, Error> {
        let Some(&Token { kind: Kind::Number(value), text, .. }) = self.peek() else {
            self.expected.push("a whole number".to_owned());
            return Ok(None);
        };
        #[expect(clippy::cast_precision_loss, reason = "limits are far below 2⁵³")]
        if !(value.fract() == 0.0 && value >= min as f64 && value <= max as f64) {
            let allowed = format!("a whole number from {min} to {max}");
            return Err(self.error(Problem::Range { what, found: text.to_owned(), allowed }));
        }
        self.advance();
        #[expect(clippy::cast_possible_truncation, reason = "whole, and within the limits")]
        Ok(Some(value as i64))
    }

    /// A number with one of these units, in SI, from `min` to `max` in the unit as written; its unit.
    pub(super) fn quantity(
        &mut self,
        what: &'static str,
        allowed: &[(Unit, f64, f64)],
    ) -> Result<(f64, Unit), Error> {
        let units = || allowed.iter().map(|(unit, ..)| unit.symbol().to_owned()).collect();
        let Some(number) = self.peek().copied() else {
            return Err(self.no_number(what, allowed));
        };
        let Kind::Number(value) = number.kind else {
            return Err(self.no_number(what, allowed));
        };
        let next = self.line.tokens.get(self.at + 1).copied();
        let written = next.filter(|token| {
            let unit = Unit::of(token.text).is_some() || is_foreign_unit(token.text);
            unit || token.text == "°" || (token.kind == Kind::Word && token.touches(&number))
        });
        let Some(written) = written else {
            let problem = Problem::NoUnit { number: number.text.to_owned(), allowed: units() };
            return Err(self.error(problem));
        };
        let unit = Unit::of(written.text);
        let Some(&(unit, min, max)) = allowed.iter().find(|(known, ..)| Some(*known) == unit)
        else {
            let (number, found) = (number.text.to_owned(), written.text.to_owned());
            let problem = Problem::Unit { number, found, allowed: units() };
            return Err(self.error_at(written.column, written.width(), problem));
        };
        if !(min..=max).contains(&value) {
            let symbol = unit.symbol();
            let found = format!("{} {symbol}", number.text);
            let allowed = format!("from {min} to {max} {symbol}");
            return Err(self.error(Problem::Range { what, found, allowed }));
        }
        self.advance();
        self.advance();
        let si = match unit {
            Unit::Millimeter => m_from_mm(value),
            Unit::Degree => value.to_radians(),
            Unit::Second => value,
            Unit::Percent => shift(value, -2),
        };
        Ok((si, unit))
    }

    fn no_number(&mut self, what: &str, allowed: &[(Unit, f64, f64)]) -> Error {
        let units: Vec<&str> = allowed.iter().map(|(unit, ..)| unit.symbol()).collect();
        self.expected.push(format!("{what} in {}", units.join(" or ")));
        self.unexpected()
    }

    /// Requires the end of the line.
    pub(super) fn end(&mut self) -> Result<(), Error> {
        if self.peek().is_none() {
            return Ok(());
        }
        self.expected.push("the end of the line".to_owned());
        Err(self.unexpected())
    }
}

/// The text of a token, without control characters.
fn shown(token: &Token<'_>) -> String {
    format!("`{}`", token.text.escape_debug())
}
