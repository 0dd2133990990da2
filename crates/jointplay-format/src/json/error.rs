//! Why a request cannot be read, as facts.

use std::fmt;

use serde_json::Value;

use crate::place::nearest;

/// Most characters of a value or name in an error.
const MOST_QUOTED: usize = 60;

/// Why a request cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}{problem}", prefix(.field))]
pub struct JsonError {
    /// The field, such as `command.rods_m[1]`; empty for the request itself.
    pub field: String,
    /// What is incorrect there.
    pub problem: Problem,
}

/// What is incorrect with a field.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The text is not JSON.
    #[error("not valid JSON: {0}")]
    NotJson(serde_json::Error),
    /// A value of another type, or out of its range.
    #[error("expected {allowed}, got {found}")]
    Type {
        /// What is allowed.
        allowed: Allowed,
        /// What was found.
        found: Found,
    },
    /// A list of another length.
    #[error("expected a list of {allowed}, got a list of {found}")]
    Length {
        /// Number of elements that the list needs.
        allowed: usize,
        /// Number of elements that it has.
        found: usize,
    },
    /// An object has a field that is not known.
    #[error("unknown field `{name}`{}; known: {}", meant(.name, .known), .known.join(", "))]
    UnknownField {
        /// Name of the field.
        name: String,
        /// Names of the known fields.
        known: &'static [&'static str],
    },
    /// An object has not all its fields.
    #[error("missing field `{name}`")]
    MissingField {
        /// Name of the field.
        name: &'static str,
    },
    /// An object has no kind.
    #[error("missing field `kind`; known: {}", listed(.known))]
    MissingKind {
        /// The known kinds.
        known: &'static [&'static str],
    },
    /// A condition of the type that is read.
    #[error("{0}")]
    Condition(String),
}

/// What is allowed in a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Allowed {
    /// A number.
    Number,
    /// A whole number in a range, both ends included.
    WholeNumber {
        /// The least one.
        min: i128,
        /// The largest one.
        max: i128,
    },
    /// True or false.
    Truth,
    /// A text.
    Text,
    /// One of these texts.
    OneOf(&'static [&'static str]),
    /// A list.
    List,
    /// An object.
    Object,
    /// An object of one of these kinds.
    ObjectOfKind(&'static [&'static str]),
    /// No value.
    Null,
}

/// What a field has.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Found {
    /// A value, in JSON; shortened if it is long.
    Value(String),
    /// A list.
    List,
    /// An object.
    Object,
}

impl JsonError {
    /// The same error, with its field in another one.
    #[must_use]
    pub fn within(mut self, outer: &str) -> Self {
        let separator = if self.field.is_empty() || self.field.starts_with('[') { "" } else { "." };
        if !outer.is_empty() {
            self.field = format!("{}{separator}{}", shortened(outer), self.field);
        }
        self
    }
}

impl Problem {
    /// The problem of a field.
    #[must_use]
    pub fn at(self, field: &str) -> JsonError {
        JsonError { field: shortened(field), problem: self }
    }
}

impl Found {
    /// What a value is.
    #[must_use]
    pub fn of(value: &Value) -> Self {
        match value {
            Value::Array(_) => Self::List,
            Value::Object(_) => Self::Object,
            other => Self::Value(shortened(&other.to_string())),
        }
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Number => formatter.write_str("a number"),
            Self::WholeNumber { min, max } if max < i64::MAX.into() => {
                write!(formatter, "a whole number from {min} to {max}")
            }
            Self::WholeNumber { min: 0, .. } => formatter.write_str("a whole number from 0"),
            Self::WholeNumber { .. } => formatter.write_str("a whole number"),
            Self::Truth => formatter.write_str("true or false"),
            Self::Text => formatter.write_str("a text"),
            Self::OneOf([only]) => write!(formatter, "{only:?}"),
            Self::OneOf(known) => write!(formatter, "one of {}", listed(known)),
            Self::List => formatter.write_str("a list"),
            Self::Object => formatter.write_str("an object"),
            Self::ObjectOfKind(known) => {
                write!(formatter, "an object with a `kind` of {}", listed(known))
            }
            Self::Null => formatter.write_str("null"),
        }
    }
}

impl fmt::Display for Found {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Value(value) => value,
            Self::List => "a list",
            Self::Object => "an object",
        })
    }
}

impl serde::de::Error for JsonError {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Problem::Condition(message.to_string()).at("")
    }

    fn unknown_field(name: &str, known: &'static [&'static str]) -> Self {
        let name = shortened(name);
        Problem::UnknownField { name: name.clone(), known }.at(&name)
    }

    fn missing_field(name: &'static str) -> Self {
        Problem::MissingField { name }.at("")
    }
}

fn prefix(field: &str) -> String {
    if field.is_empty() { String::new() } else { format!("`{field}`: ") }
}

fn meant(name: &str, known: &[&str]) -> String {
    match nearest(name, known.iter().copied()) {
        Some(known) => format!(" (did you mean `{known}`?)"),
        None => String::new(),
    }
}

fn listed(known: &[&str]) -> String {
    known.iter().map(|name| format!("{name:?}")).collect::<Vec<String>>().join(", ")
}

/// A text of at most [`MOST_QUOTED`] characters.
pub(super) fn shortened(text: &str) -> String {
    match text.char_indices().nth(MOST_QUOTED) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
