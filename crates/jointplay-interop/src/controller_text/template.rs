//! Text with fields in braces: names and expressions, with formats.

use std::ops::Range;

use jointplay_format::expression::{AngleUnit, ExpressionProblem, Formula};
use jointplay_format::file_problem::FileProblem;
use jointplay_format::number::number;
use jointplay_format::place::{Error, Place, nearest};

use super::format_spec::{FormatSpec, Kind, Value};
use super::pieces::{Pieces, Unpaired};
use super::problem::Problem;

/// Longest text of a filled template (bytes): templates of lines contain filled ones, each of them any number of times.
const MOST_TEXT: usize = 1 << 16;

/// Most fields of a template; each of them has the line of the file in its place.
const MOST_FIELDS: usize = 1000;

/// Names that a template may contain.
#[derive(Debug, Clone, Default)]
pub(crate) struct Names {
    pub(crate) known: Vec<(&'static str, Kind)>,
    /// Names that a key of the file would define, with the key.
    pub(crate) undefined: Vec<(&'static str, &'static str)>,
}

impl Names {
    pub(crate) fn new(known: &[(&'static str, Kind)]) -> Self {
        Self { known: known.to_vec(), undefined: Vec::new() }
    }

    /// Adds names.
    pub(crate) fn and(mut self, more: &[(&'static str, Kind)]) -> Self {
        self.known.extend(more);
        self
    }

    /// Adds a name that exists where a key of the file defines it.
    pub(crate) fn with(
        mut self,
        name: &'static str,
        key: &'static str,
        kind: Option<Kind>,
    ) -> Self {
        match kind {
            Some(kind) => self.known.push((name, kind)),
            None => self.undefined.push((name, key)),
        }
        self
    }

    fn unknown(&self, found: &str) -> Problem {
        if let Some(&(name, key)) = self.undefined.iter().find(|(name, _)| *name == found) {
            return Problem::UndefinedName { name, key };
        }
        let known = self.known.iter().map(|(name, _)| *name);
        Problem::Name {
            found: found.to_owned(),
            nearest: nearest(found, known.clone()),
            known: known.collect::<Vec<_>>().join(", "),
        }
    }
}

/// Digits after the point of numbers without a precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Decimals {
    pub(crate) values: usize,
    pub(crate) times: usize,
}

impl Decimals {
    fn for_kind(self, kind: Kind) -> usize {
        if kind == Kind::Time { self.times } else { self.values }
    }
}

/// Text with fields.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Template {
    /// Text, and the field that follows it.
    parts: Vec<(String, Field)>,
    rest: String,
}

/// A field of a template.
#[derive(Debug, Clone, PartialEq)]
struct Field {
    source: Source,
    spec: FormatSpec,
    /// The field without its format, as written.
    text: String,
    place: Place,
}

#[derive(Debug, Clone, PartialEq)]
enum Source {
    Name(&'static str),
    /// An expression, and whether its value has to be whole.
    Expression {
        formula: Formula,
        is_whole: bool,
    },
}

impl Template {
    /// Parses a template.
    ///
    /// # Arguments
    /// * `place` – place of a part of the text in the file
    ///
    /// # Errors
    /// The first problem, with its part of the text.
    pub(crate) fn parse(
        text: &str,
        names: &Names,
        decimals: Decimals,
        place: impl Fn(Range<usize>) -> Place,
    ) -> Result<Self, (Range<usize>, Problem)> {
        let mut parts = Vec::new();
        let mut rest = String::new();
        for piece in Pieces::of(text) {
            let (plain, field) = piece.map_err(|brace| match brace {
                Unpaired::Opening(part) => (part, Problem::Open),
                Unpaired::Closing(part) => (part, Problem::Close),
            })?;
            let Some(Range { start, end }) = field else {
                rest = plain;
                break;
            };
            if parts.len() == MOST_FIELDS {
                let problem = Problem::TooManyFields { allowed: MOST_FIELDS };
                return Err((start - 1..text.len(), problem));
            }
            let (source, format) = match text[start..end].split_once(':') {
                Some((source, format)) => (source, Some(format)),
                None => (&text[start..end], None),
            };
            let field = Field::parse(source, format, names, decimals, place(start..end));
            let field = field.map_err(|error| match error {
                FieldError::Source(part, problem) => {
                    (start + part.start..start + part.end, problem)
                }
                FieldError::Format(problem) => (start + source.len() + 1..end, problem),
            })?;
            parts.push((plain, field));
        }
        Ok(Self { parts, rest })
    }

    /// Whether a field contains a name.
    pub(crate) fn uses(&self, name: &str) -> bool {
        self.parts.iter().any(|(_, field)| match &field.source {
            Source::Name(own) => *own == name,
            Source::Expression { formula, .. } => formula.names().any(|own| own == name),
        })
    }

    /// The text before the first field, if this field is the value of a name without padding.
    pub(crate) fn literal_before(&self, name: &str) -> Option<&str> {
        let (literal, field) = self.parts.first()?;
        let is_value = matches!(&field.source, Source::Name(own) if *own == name);
        (is_value && !field.spec.pads()).then_some(literal)
    }

    /// The text with the values of its fields.
    ///
    /// # Errors
    /// [`Problem::NoValue`] and [`Problem::NotWhole`] of an expression, and [`Problem::TextTooLong`], with the place of the field in the file.
    pub(crate) fn fill(&self, value: impl Fn(&str) -> Value) -> Result<String, Error<Problem>> {
        let mut filled = String::new();
        for (text, field) in &self.parts {
            filled.push_str(text);
            let invalid =
                |problem| Error { place: field.place.clone(), problem: Box::new(problem) };
            let value = field.value(&value).map_err(invalid)?;
            filled.push_str(&field.spec.apply(&value));
            if filled.len() > MOST_TEXT {
                return Err(invalid(Problem::TextTooLong { allowed: MOST_TEXT }));
            }
        }
        filled.push_str(&self.rest);
        Ok(filled)
    }
}

enum FieldError {
    /// A part of the name or expression.
    Source(Range<usize>, Problem),
    Format(Problem),
}

impl Field {
    fn parse(
        text: &str,
        format: Option<&str>,
        names: &Names,
        decimals: Decimals,
        place: Place,
    ) -> Result<Self, FieldError> {
        let kind_of = |name: &str| names.known.iter().find(|(known, _)| *known == name);
        let format = format.unwrap_or_default();
        let (source, kind) = match kind_of(text.trim()) {
            Some(&(name, kind)) => (Source::Name(name), kind),
            None => expression(text, format, names)?,
        };
        let spec =
            FormatSpec::parse(format, kind, decimals.for_kind(kind)).map_err(FieldError::Format)?;
        Ok(Self { source, spec, text: text.trim().to_owned(), place })
    }

    fn value(&self, value: impl Fn(&str) -> Value) -> Result<Value, Problem> {
        let (formula, is_whole) = match &self.source {
            Source::Name(name) => return Ok(value(name)),
            Source::Expression { formula, is_whole } => (formula, *is_whole),
        };
        let number_of = |name: &str| match value(name) {
            Value::Integer(value) => Some(value as f64),
            Value::Real(value) => Some(value),
            Value::Text(_) => None,
        };
        let arguments = || {
            let mut shown: Vec<String> = Vec::new();
            for name in formula.names() {
                let one = number_of(name).map(|value| format!("{name} = {}", number(value)));
                shown.extend(one.filter(|one| !shown.contains(one)));
            }
            shown.join(", ")
        };
        let found = formula.evaluate_with(&number_of).map_err(|error| match error.problem {
            ExpressionProblem::NotFinite { value } => {
                let expression = self.text.clone();
                Problem::NoValue { expression, value, arguments: arguments() }
            }
            other => FileProblem::from(other).into(),
        })?;
        if !is_whole {
            return Ok(Value::Real(found));
        }
        // Whole numbers of this size are exact.
        if found.fract() != 0.0 || found.abs() > 1e15 {
            let expression = self.text.clone();
            return Err(Problem::NotWhole { expression, value: found, arguments: arguments() });
        }
        Ok(Value::Integer(found as i64))
    }
}

/// An expression of names, and the kind of its value.
fn expression(text: &str, format: &str, names: &Names) -> Result<(Source, Kind), FieldError> {
    let whole = || 0..text.len();
    let formula = Formula::parse(text, AngleUnit::Degree).map_err(|error| {
        // Of a single word, the known names help more.
        let is_word = text.chars().all(|letter| letter.is_alphanumeric() || letter == '_');
        match is_word {
            true => FieldError::Source(whole(), names.unknown(text)),
            false => FieldError::Source(error.span, FileProblem::from(error.problem).into()),
        }
    })?;
    let (mut are_whole, mut are_times) = (true, true);
    for variable in formula.variables() {
        let kind =
            names.known.iter().find(|(known, _)| *known == variable.name).map(|(_, kind)| *kind);
        match kind {
            Some(Kind::Text) => {
                let name = variable.name.to_owned();
                return Err(FieldError::Source(variable.span, Problem::TextInExpression { name }));
            }
            Some(kind) => {
                are_whole &= kind == Kind::Integer;
                are_times &= kind == Kind::Time;
            }
            None if variable.name == "pi" => are_whole = false,
            None => return Err(FieldError::Source(variable.span, names.unknown(variable.name))),
        }
    }
    if formula.names().next().is_none() {
        // Its value is known here, and so is a division by zero.
        formula.evaluate_with(&|_| None).map_err(|error| {
            FieldError::Source(error.span, FileProblem::from(error.problem).into())
        })?;
    }
    let has_decimals = format.contains('.') || format.ends_with(['f', 'e', 'E']);
    let is_whole = FormatSpec::names_whole_type(format) || (are_whole && !has_decimals);
    let kind = match (is_whole, are_times) {
        (true, _) => Kind::Integer,
        (_, true) => Kind::Time,
        _ => Kind::Real,
    };
    Ok((Source::Expression { formula, is_whole }, kind))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [(&str, Kind); 3] =
        [("slot", Kind::Integer), ("time", Kind::Time), ("text", Kind::Text)];

    fn parse(text: &str) -> Result<Template, (Range<usize>, Problem)> {
        let names = Names::new(&NAMES).with("code", "the table `[codes]`", None);
        Template::parse(text, &names, Decimals { values: 3, times: 1 }, |part| {
            Place::of(text, part)
        })
    }

    fn value(name: &str) -> Value {
        match name {
            "slot" => Value::Integer(3),
            "time" => Value::Real(0.5),
            _ => Value::Text("abc".to_owned()),
        }
    }

    #[test]
    fn fields_are_filled_with_values_of_names_and_expressions() {
        for (template, filled) in [
            ("{{{text}}} {text:>5}!", "{abc}   abc!"),
            ("S{slot:02} {slot - 1:02} {10 * slot + 5:X}", "S03 02 23"),
            ("{time} {1000 * time:.0f} {time * slot} {slot / 2:.2f}", "0.5 500 1.500 1.50"),
            ("{round(1000 * time):+06d} {mod(slot, 2)} {-slot}", "+00500 1 -3"),
            ("µ{ slot }m {2 * pi:.4}", "µ3m 6.2832"),
        ] {
            assert_eq!(parse(template).unwrap().fill(value).unwrap(), filled, "{template}");
        }
    }

    #[track_caller]
    fn refuse(template: &str, part: &str, message: &str) {
        let (span, problem) = parse(template).unwrap_err();
        assert_eq!(&template[span], part, "{problem}");
        assert!(problem.to_string().contains(message), "{problem}");
    }

    #[test]
    fn invalid_fields_are_rejected_with_their_part_of_the_template() {
        refuse(
            "S{slots}",
            "slots",
            "`{slots}` is not a name of this template (did you mean `slot`?); known here: slot, time, text",
        );
        refuse("µ {slot + sloth}", "sloth", "did you mean `slot`?");
        refuse("{code:02}", "code", "`{code}` needs the table `[codes]`");
        refuse("{2 * code}", "code", "needs the table");
        refuse(
            "{slot:2.1d}",
            "2.1d",
            "`2.1d` is not a format of a whole number; allowed in this order",
        );
        refuse("{time:d}", "d", "round(…)");
        refuse("{text:+}", "+", "is not a format of a text");
        refuse("{text + 1}", "text", "expressions have numbers only");
        refuse("{1 / 0}", "1 / 0", "infinite");
        refuse("{slot *}", "", "expected a number");
        refuse("{}", "", "is not a name");
        refuse("a{slot", "{slot", "ends without");
        refuse("slot}", "}", "}}");
    }

    /// Before, a file of 80 kB made of each line of a host gigabytes of text.
    #[test]
    fn texts_that_many_fields_make_long_are_rejected_at_the_field_that_is_too_much() {
        let long = |_: &str| Value::Text("a".repeat(MOST_TEXT / 64));
        let lines = |count: usize| parse(&"{text}".repeat(count)).unwrap().fill(long);
        assert_eq!(lines(64).unwrap().len(), MOST_TEXT);
        let error = lines(100).unwrap_err();
        assert!(error.to_string().contains("longer than 65536 bytes"), "{error}");
        assert_eq!(error.place.column, 64 * "{text}".len() + 2);
    }

    /// Before, the places of 65,536 fields in one line took 25 GB.
    #[test]
    fn templates_with_thousands_of_fields_are_rejected() {
        assert!(parse(&"{text}".repeat(MOST_FIELDS)).is_ok());
        let (part, problem) = parse(&"{text}".repeat(MOST_FIELDS + 1)).unwrap_err();
        assert_eq!(part.start, MOST_FIELDS * "{text}".len());
        assert_eq!(problem.to_string(), "a template has at most 1000 fields");
    }

    #[test]
    fn expressions_without_a_value_are_rejected_with_the_values_of_their_names() {
        let message = |template: &str| {
            let error = parse(template).unwrap().fill(value).unwrap_err();
            (error.place.column, error.to_string())
        };
        let (column, shown) = message("N {1 / (slot - 3):.3f}");
        assert_eq!(column, 4);
        assert!(shown.contains("`1 / (slot - 3)` is infinite for slot = 3"), "{shown}");
        let (_, shown) = message("{slot / 2:02}");
        assert!(shown.contains("`slot / 2` is 1.5 for slot = 3"), "{shown}");
        let (_, shown) = message("{sqrt(time - 1)}");
        assert!(shown.contains("is not a number for time = 0.5"), "{shown}");
    }
}
