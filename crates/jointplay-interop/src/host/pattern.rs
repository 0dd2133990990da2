//! Patterns of commands: text with fields.

use std::ops::Range;

use jointplay_cell::workcell::Cell;
use jointplay_format::place::{listed, nearest};

use super::field::{FIELDS, Field, FieldKind};
use super::refusal::Mismatch;
use crate::controller_text::{Codes, CommandProblem as Problem, Pieces, Unpaired, Value};

/// Longest identifier of a command (characters).
const LONGEST_IDENTIFIER: usize = 32;

/// Largest magnitude of a number in a command; larger numbers have no meaning in a cell.
const MAX_NUMBER: f64 = 1e9;

/// Text with fields.
///
/// A space of the text matches one or more spaces and tabs; everything else matches itself.
/// A field takes as much as it can.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pattern {
    /// Text, and the field that follows it.
    parts: Vec<(String, Field)>,
    rest: String,
}

/// Values of the fields of a pattern, by their names in templates.
pub(super) type Values = Vec<(&'static str, Value)>;

/// Names in a cell, and their codes.
#[derive(Clone, Copy)]
pub(super) struct Vocabulary<'a> {
    pub(super) cell: &'a Cell,
    pub(super) station_codes: Option<&'a Codes>,
    pub(super) effector_codes: Option<&'a Codes>,
}

impl Pattern {
    /// Parses a pattern.
    ///
    /// # Errors
    /// The first problem, with its part of the text.
    pub(super) fn parse(text: &str) -> Result<Self, (Range<usize>, Problem)> {
        let mut parts: Vec<(String, Field)> = Vec::new();
        let mut rest = String::new();
        for piece in Pieces::of(text) {
            let (plain, field) = piece.map_err(|brace| match brace {
                Unpaired::Opening(part) | Unpaired::Closing(part) => (part, Problem::Brace),
            })?;
            let Some(span) = field else {
                rest = plain;
                break;
            };
            let field = find(&text[span.clone()]).map_err(|why| (span.clone(), why))?;
            let name = field.name;
            let is_same = |(_, other): &(String, Field)| other.in_templates == field.in_templates;
            if parts.iter().any(is_same) {
                return Err((span, Problem::Twice { name }));
            }
            let joins = |(_, before): &(String, Field)| {
                use FieldKind::{Identifier, Integer, Real};
                matches!(before.kind, Identifier | Integer | Real)
            };
            if plain.is_empty() && parts.last().is_some_and(joins) {
                return Err((span, Problem::NotSeparated { name }));
            }
            parts.push((plain, field));
        }
        let words = parts.iter().map(|(word, _)| word).chain([&rest]);
        if words.into_iter().all(|word| word.trim().is_empty()) {
            return Err((0..text.len(), Problem::NoWord));
        }
        Ok(Self { parts, rest })
    }

    pub(super) fn fields(&self) -> impl Iterator<Item = Field> {
        self.parts.iter().map(|(_, field)| *field)
    }

    /// Values of the fields in a line.
    ///
    /// # Errors
    /// The first part of the line that does not fit.
    pub(super) fn values(
        &self,
        line: &str,
        vocabulary: Vocabulary<'_>,
    ) -> Result<Values, Mismatch> {
        let mut values = Values::new();
        let mut left = line;
        for (index, (text, field)) in self.parts.iter().enumerate() {
            left = after(text, left).ok_or_else(|| {
                let expected = match text.trim() {
                    "" if left.is_empty() => format!("{{{}}}", field.name),
                    "" => "a space".to_owned(),
                    word => format!("{word:?}"),
                };
                Mismatch::Text { fields: index, found: first_word(left), expected }
            })?;
            let (taken, value) = vocabulary.value(*field, left).map_err(|expected| {
                Mismatch::Field { fields: index, found: first_word(left), expected }
            })?;
            left = &left[taken..];
            values.push((field.in_templates, value));
        }
        let fields = self.parts.len();
        match after(&self.rest, left) {
            Some("") => Ok(values),
            Some(more) => {
                let expected = "the end of the line".to_owned();
                Err(Mismatch::Text { fields, found: first_word(more), expected })
            }
            None => {
                let expected = format!("{:?}", self.rest.trim());
                Err(Mismatch::Text { fields, found: first_word(left), expected })
            }
        }
    }
}

fn find(name: &str) -> Result<Field, Problem> {
    FIELDS.into_iter().find(|field| field.name == name).ok_or_else(|| {
        let known = FIELDS.iter().map(|field| field.name);
        Problem::Field {
            found: name.to_owned(),
            nearest: nearest(name, known.clone()),
            known: known.collect::<Vec<_>>().join(", "),
        }
    })
}

/// The first word of the rest of a line, nothing at its end.
fn first_word(rest: &str) -> String {
    rest.split_whitespace().next().unwrap_or_default().to_owned()
}

/// The rest of a line after a text; `None` where the line does not begin with it.
fn after<'l>(text: &str, line: &'l str) -> Option<&'l str> {
    let blank = |letter: char| letter == ' ' || letter == '\t';
    let mut left = line;
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        if letter == ' ' {
            while letters.next_if_eq(&' ').is_some() {}
            let rest = left.trim_start_matches(blank);
            if rest.len() == left.len() {
                return None;
            }
            left = rest;
        } else {
            left = left.strip_prefix(letter)?;
        }
    }
    Some(left)
}

impl Vocabulary<'_> {
    /// The length and the value of a field at the start of a text.
    ///
    /// # Errors
    /// Description of the allowed values.
    fn value(self, field: Field, text: &str) -> Result<(usize, Value), String> {
        match field.kind {
            FieldKind::Station => self.name(text, &self.stations(), "a station"),
            FieldKind::Effector => self.name(text, &self.effectors(), "an effector"),
            FieldKind::Axis => self.name(text, &self.axes(), "an axis"),
            FieldKind::StationCode => code(text, self.station_codes, "a code of a station"),
            FieldKind::EffectorCode => code(text, self.effector_codes, "a code of an effector"),
            FieldKind::Identifier => {
                let allowed = |letter: char| {
                    letter.is_ascii_alphanumeric() || matches!(letter, '_' | '.' | '-')
                };
                let end = text.find(|letter| !allowed(letter)).unwrap_or(text.len());
                match end {
                    1..=LONGEST_IDENTIFIER => Ok((end, Value::Text(text[..end].to_owned()))),
                    _ => Err(format!(
                        "an identifier of 1 to {LONGEST_IDENTIFIER} letters, digits, _, . and -"
                    )),
                }
            }
            FieldKind::Integer => {
                let end = text.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(text.len());
                let number: Option<i64> = text[..end].parse().ok();
                let number = number.filter(|&number| number as f64 <= MAX_NUMBER);
                Ok((end, Value::Integer(number.ok_or("a whole number")?)))
            }
            FieldKind::Real => {
                let signed = text.strip_prefix(['+', '-']).unwrap_or(text);
                let digits = signed.find(|letter: char| !letter.is_ascii_digit() && letter != '.');
                let end = text.len() - signed.len() + digits.unwrap_or(signed.len());
                let number: Option<f64> = text[..end].parse().ok();
                let number = number.filter(|number| number.abs() <= MAX_NUMBER);
                Ok((end, Value::Real(number.ok_or("a number")?)))
            }
        }
    }

    fn stations(self) -> Vec<String> {
        self.cell.stations.iter().map(|station| station.name.clone()).collect()
    }

    fn effectors(self) -> Vec<String> {
        let robot = &self.cell.robot;
        robot.effectors().map(|id| self.cell.effector_name(id).to_owned()).collect()
    }

    fn axes(self) -> Vec<String> {
        self.cell.robot.axes.iter().map(|axis| axis.name.clone()).collect()
    }

    /// The longest name that a text begins with.
    fn name(self, text: &str, names: &[String], what: &str) -> Result<(usize, Value), String> {
        let fitting = names.iter().filter(|name| text.starts_with(name.as_str()));
        match fitting.max_by_key(|name| name.len()) {
            Some(name) => Ok((name.len(), Value::Text(name.clone()))),
            None => Err(format!("{what}: {}", listed(names))),
        }
    }
}

/// The name of the longest code that a text begins with.
fn code(text: &str, codes: Option<&Codes>, what: &str) -> Result<(usize, Value), String> {
    let codes: Vec<(String, &str)> = codes.map(Codes::texts).unwrap_or_default();
    let fitting = codes.iter().filter(|(code, _)| text.starts_with(code.as_str()));
    match fitting.max_by_key(|(code, _)| code.len()) {
        Some((code, name)) => Ok((code.len(), Value::Text((*name).to_owned()))),
        None => {
            let known: Vec<String> = codes.into_iter().map(|(code, _)| code).collect();
            Err(format!("{what}: {}", listed(&known)))
        }
    }
}
