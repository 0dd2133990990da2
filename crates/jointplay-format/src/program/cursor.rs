//! Reads one line from left to right.

use std::cell::OnceCell;

use jointplay_cell::program::{AllowedValues, Name, Number, Quantity, SourceLocation, Unit};

use super::lexer::{Kind, Line, Token, unquoted};
use super::problem::{Error, Problem};
use super::words::{is_foreign_unit, meant, reserved, unit};
use crate::expression::{
    self, AngleUnit, ExpressionError, ExpressionProblem, Parsed, Parser, TokenKind, VariableName,
};
use crate::place;

/// The end of the line, in messages.
const END_OF_LINE: &str = "the end of the line";

/// A position in a line, with the alternatives that the grammar allows there.
pub(super) struct Cursor<'l, 't> {
    line: &'l Line<'t>,
    /// The tokens as those of an expression, once one is read.
    operands: OnceCell<Vec<expression::Token<'t>>>,
    at: usize,
    /// Alternatives that were tried here without success.
    expected: Vec<String>,
}

impl<'l, 't> Cursor<'l, 't> {
    pub(super) fn new(line: &'l Line<'t>) -> Self {
        Self { line, operands: OnceCell::new(), at: 0, expected: Vec::new() }
    }

    /// The token after the next one.
    pub(super) fn peek_second(&self) -> Option<&'l Token<'t>> {
        self.line.tokens.get(self.at + 1)
    }

    /// A position to which [`rewind`](Self::rewind) returns.
    pub(super) fn position(&self) -> usize {
        self.at
    }

    /// Returns to an earlier position.
    pub(super) fn rewind(&mut self, position: usize) {
        self.at = position;
        self.expected.clear();
    }

    /// Names of the line that directly follow one of these words, as written.
    pub(super) fn names_after(&self, words: &[&str]) -> Vec<&'t str> {
        let pairs = self.line.tokens.windows(2).filter(|pair| {
            let is_name = match pair[1].kind {
                Kind::Quoted => true,
                Kind::Word => reserved(pair[1].text).is_none(),
                _ => false,
            };
            is_name && words.iter().any(|word| pair[0].is(word))
        });
        pairs.map(|pair| pair[1].text).collect()
    }

    /// The line up to the first of these words, its tokens separated by spaces.
    pub(super) fn text_before(&self, words: &[&str]) -> String {
        let is_before = |token: &&Token<'_>| !words.iter().any(|word| token.is(word));
        let before = self.line.tokens.iter().take_while(is_before);
        before.map(|token| token.text).collect::<Vec<_>>().join(" ")
    }

    pub(super) fn peek(&self) -> Option<&'l Token<'t>> {
        self.line.tokens.get(self.at)
    }

    pub(super) fn advance(&mut self) {
        self.at += 1;
        self.expected.clear();
    }

    /// Column of the end of the line, as the ends of an expression.
    fn end_of_line(&self) -> (usize, usize) {
        let column = self.line.tokens.last().map_or(1, |last| last.column + last.width());
        (column, column)
    }

    /// Place of the next token, or the end of the line.
    pub(super) fn place(&self) -> SourceLocation {
        let column = self.peek().map_or(self.end_of_line().0, |token| token.column);
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
            let found = END_OF_LINE.to_owned();
            return self.error(Problem::Expected { expected, found, nearest: None });
        };
        let wants_name = expected.iter().any(|choice| {
            choice.starts_with("the name")
                || choice.starts_with("the number")
                || choice.contains(" in ")
        });
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

    /// Requires a sign; `expected` are the alternatives in the message.
    pub(super) fn require_sign(&mut self, sign: &str, expected: &str) -> Result<(), Error> {
        if self.accept_sign(sign) { Ok(()) } else { Err(self.expecting(&[expected])) }
    }

    /// The error that the next token is none of these.
    pub(super) fn expecting(&mut self, expected: &[&str]) -> Error {
        self.expected.extend(expected.iter().map(|one| (*one).to_owned()));
        self.unexpected()
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

    /// A sum without unit; `what` is its meaning.
    pub(super) fn number(&mut self, what: &str) -> Result<Number, Error> {
        self.expression(what, |parser| parser.sum())
    }

    /// A sum without unit, whose value is checked if it is a literal number.
    pub(super) fn literal_or_number(
        &mut self,
        what: &'static str,
        allowed: AllowedValues,
    ) -> Result<Number, Error> {
        let (at, place) = (self.at, self.place());
        let number = self.number(what)?;
        if let Some(false) = number.expression.as_constant().map(|value| allowed.contains(value)) {
            let (found, allowed) = (self.text_since(at), allowed.to_string());
            let width = found.chars().count();
            let problem = Problem::Range { what, found, allowed };
            return Err(self.error_at(place.column, width, problem));
        }
        Ok(number)
    }

    /// The tokens since an earlier position, without blanks.
    fn text_since(&self, at: usize) -> String {
        self.line.tokens[at..self.at].iter().map(|token| token.text).collect()
    }

    /// A parser of the expression that starts at a token.
    fn parser(&self, start: usize) -> Parser<'_> {
        let all = self.operands.get_or_init(|| self.line.tokens.iter().map(operand).collect());
        Parser::new(&all[start..], self.end_of_line(), AngleUnit::Degree)
    }

    /// An expression at the next token.
    fn expression(
        &mut self,
        what: &str,
        read: impl for<'p> FnOnce(Parser<'p>) -> Result<Parsed, ExpressionError>,
    ) -> Result<Number, Error> {
        let place = self.place();
        let parsed = match read(self.parser(self.at)) {
            Ok(parsed) => parsed,
            Err(error) => return Err(self.expression_error(what, error)),
        };
        self.at += parsed.tokens;
        self.expected.clear();
        let name = |name: &VariableName| {
            if name.text.trim().is_empty() || name.text.contains(char::is_control) {
                let problem = Problem::Name { found: format!("{:?}", name.text) };
                return Err(self.error_at(name.column, name.span.len(), problem));
            }
            let place = SourceLocation { line: place.line, column: name.column };
            Ok(Name { text: name.text.clone(), place })
        };
        let expression = parsed.expression.try_map(name)?;
        Ok(Number { place, expression })
    }

    fn expression_error(&mut self, what: &str, error: ExpressionError) -> Error {
        let ExpressionError { span, problem } = error;
        match problem {
            ExpressionProblem::Syntax { column, .. } if column == self.place().column => {
                self.expected.push(what.to_owned());
                self.unexpected()
            }
            ExpressionProblem::Syntax { column, expected, found } => {
                let expected = vec![expected.to_owned()];
                let found =
                    if column == self.end_of_line().0 { END_OF_LINE.to_owned() } else { found };
                let problem = Problem::Expected { expected, found, nearest: None };
                self.error_at(column, span.len(), problem)
            }
            problem => self.error_at(span.start, span.len(), Problem::Expression(problem)),
        }
    }

    /// A number with one of the allowed units; a literal number is checked.
    pub(super) fn quantity(
        &mut self,
        what: &'static str,
        allowed: &[AllowedValues],
    ) -> Result<Quantity, Error> {
        let symbols = || {
            let units = allowed.iter().filter_map(|one| one.unit);
            units.map(|unit| unit.symbol().to_owned()).collect::<Vec<_>>()
        };
        let (start, place) = (self.at, self.place());
        let expected = format!("{what} in {}", symbols().join(" or "));
        let number = self.expression(&expected, |parser| parser.signed())?;
        let text = self.text_since(start);
        let Some((unit, written)) = self.accept_unit() else {
            if let Some(problem) = self.unbracketed() {
                return Err(problem);
            }
            if unit(&text).is_some() {
                self.rewind(start);
                return Err(self.expecting(&[&expected]));
            }
            let width = text.chars().count();
            let problem = Problem::NoUnit { number: text, allowed: symbols() };
            return Err(self.error_at(place.column, width, problem));
        };
        let Some((unit, values)) =
            allowed.iter().find_map(|one| Some((unit.filter(|it| one.unit == Some(*it))?, one)))
        else {
            let found = written.text.to_owned();
            let problem = Problem::Unit { number: text, found, allowed: symbols() };
            return Err(self.error_at(written.column, written.width(), problem));
        };
        if let Some(false) = number.expression.as_constant().map(|value| values.contains(value)) {
            let width = text.chars().count();
            let found = format!("{text} {}", unit.symbol());
            let problem = Problem::Range { what, found, allowed: values.to_string() };
            return Err(self.error_at(place.column, width, problem));
        }
        Ok(Quantity { number, unit })
    }

    /// A number with an optional unit.
    pub(super) fn number_with_unit(
        &mut self,
        what: &'static str,
    ) -> Result<(Number, Option<Unit>), Error> {
        let start = self.at;
        let number = self.number(what)?;
        let (used, text) = (self.at - start, self.text_since(start));
        let Some((unit, written)) = self.accept_unit() else { return Ok((number, None)) };
        let Some(unit) = unit else {
            let allowed = Unit::ALL.map(|unit| unit.symbol().to_owned()).to_vec();
            let problem = Problem::Unit { number: text, found: written.text.to_owned(), allowed };
            return Err(self.error_at(written.column, written.width(), problem));
        };
        let signed = self.parser(start).signed().ok();
        if signed.is_none_or(|signed| signed.tokens != used) {
            let first = &self.line.tokens[start];
            let width = written.column - first.column;
            return Err(self.error_at(first.column, width, Problem::NoParentheses));
        }
        Ok((number, Some(unit)))
    }

    /// A constant in a unit: the bound of a parameter.
    pub(super) fn bound(&mut self, needed: Option<Unit>) -> Result<f64, Error> {
        let (start, column) = (self.at, self.place().column);
        let (number, unit) = self.number_with_unit("the number of its bound")?;
        let text = self.text_since(start);
        let width = text.chars().count();
        if unit != needed {
            let allowed = needed.map_or_else(|| "no unit".to_owned(), |it| it.symbol().to_owned());
            let problem = Problem::BoundUnit { found: text, allowed };
            return Err(self.error_at(column, width, problem));
        }
        match number.expression.as_constant().filter(|value| value.is_finite()) {
            Some(value) => Ok(value),
            None => Err(self.error_at(column, width, Problem::BoundNumber { found: text })),
        }
    }

    /// The unit after a number, and its token; `None` for a unit that this language does not accept.
    fn accept_unit(&mut self) -> Option<(Option<Unit>, &'l Token<'t>)> {
        let number = &self.line.tokens[self.at.checked_sub(1)?];
        let written = self.peek().filter(|token| {
            let is_unit = unit(token.text).is_some() || is_foreign_unit(token.text);
            let touches = token.kind == Kind::Word && token.touches(number);
            (is_unit || token.text == "°" || touches) && token.kind != Kind::Quoted
        })?;
        self.advance();
        Some((unit(written.text), written))
    }

    /// The error of an operator after an operand, where only an expression in parentheses can follow.
    fn unbracketed(&self) -> Option<Error> {
        let next = self.peek()?;
        let is_operator = next.kind == Kind::Sign && "+-*/^".contains(next.text);
        is_operator.then(|| self.error(Problem::NoParentheses))
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

/// A token as that of an expression: keywords end it.
fn operand<'t>(token: &Token<'t>) -> expression::Token<'t> {
    let kind = match token.kind {
        Kind::Number(value) => TokenKind::Number(value),
        Kind::Word if reserved(token.text).is_none() => TokenKind::Name(token.text.into()),
        Kind::Quoted => TokenKind::Name(unquoted(token).into()),
        Kind::Word | Kind::Sign | Kind::Unclosed => TokenKind::Sign,
    };
    let span = token.column..token.column + token.width();
    expression::Token { kind, text: token.text, column: token.column, span }
}

/// The text of a token, without control characters.
fn shown(token: &Token<'_>) -> String {
    format!("`{}`", token.text.escape_debug())
}
