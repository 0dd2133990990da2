//! Errors that any TOML file can have.

use crate::expression::ExpressionProblem;
use crate::number::{counted, entries, number};
use crate::place::{Form, listed, nearest, suggestion};

/// Errors that any TOML file can have; numbers are in the units of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FileProblem {
    /// Invalid TOML, or an unknown key.
    #[error(transparent)]
    Form(#[from] Form),
    /// A text that is too long (bytes).
    #[error("the text has {found} bytes, but at most {allowed} are allowed")]
    TooLong {
        /// Length found.
        found: usize,
        /// Length allowed.
        allowed: usize,
    },
    /// A required key that is missing.
    #[error("{whose} needs `{key}`")]
    MissingKey {
        /// The table that needs it.
        whose: String,
        /// The key.
        key: String,
    },
    /// A value of another type than needed.
    #[error("`{key}` has to be {needed}, but is {found}")]
    TypeMismatch {
        /// The key.
        key: String,
        /// The type needed.
        needed: String,
        /// The value found.
        found: String,
    },
    /// A whole number beyond 64 bits.
    #[error("`{key}` is too large for a whole number: write it with a decimal point")]
    IntegerTooLarge {
        /// The key.
        key: String,
    },
    /// A number that is out of range, infinite or NaN.
    #[error("`{key}` is {}, but has to be {needed}", number(*.value))]
    OutOfRange {
        /// The key.
        key: String,
        /// The value found.
        value: f64,
        /// The values allowed.
        needed: String,
    },
    /// A list with too few or too many entries.
    #[error("`{key}` has {}, but needs {needed}", entries(*.found))]
    Count {
        /// The key.
        key: String,
        /// Number of entries found.
        found: usize,
        /// Number of entries needed.
        needed: String,
    },
    /// An unknown word or name.
    #[error("{what} {found:?} is not known{}; known: {}", suggestion(nearest), listed(known))]
    Unknown {
        /// The kind of thing that it names.
        what: String,
        /// The value found.
        found: String,
        /// The most similar known name.
        nearest: Option<String>,
        /// All known names.
        known: Vec<String>,
    },
    /// A name that the program language cannot express.
    #[error(
        "`{key}` is {found:?}, but a name is letters from a to z or A to Z, digits, `_` and `-`, starts with a letter, and has at most {longest} of them"
    )]
    Name {
        /// The key.
        key: String,
        /// The value found.
        found: String,
        /// Greatest length.
        longest: usize,
    },
    /// An expression without a value.
    #[error(transparent)]
    Expression(#[from] ExpressionProblem),
    /// A parameter name that expressions cannot contain.
    #[error(
        "no parameter can be called {found:?}: a name is letters, digits and `_`, does not start with a digit, and is not `pi`"
    )]
    ParameterName {
        /// The value found.
        found: String,
    },
    /// Parameters that depend on each other.
    #[error("parameters refer to each other in a circle: {}", circle(names))]
    Cycle {
        /// The circle; the first name is also the last.
        names: Vec<String>,
    },
    /// Number of further errors, which are not listed.
    #[error("{} from here on", counted(*.0, "more error"))]
    More(usize),
}

impl FileProblem {
    /// The problem of an unknown word or name.
    pub(crate) fn unknown<'n>(
        what: &str,
        found: &str,
        known: impl IntoIterator<Item = &'n str>,
    ) -> Self {
        let known: Vec<String> = known.into_iter().map(str::to_owned).collect();
        let nearest = nearest(found, known.iter().map(String::as_str));
        Self::Unknown { what: what.to_owned(), found: found.to_owned(), nearest, known }
    }
}

/// Most names of a circle that a message lists, the last not counted.
const LONGEST_CIRCLE: usize = 20;

/// A circle of names; of a long one, the first names and the last.
fn circle(names: &[String]) -> String {
    let left = names.len().saturating_sub(LONGEST_CIRCLE + 1);
    match (names.last(), left) {
        (Some(last), 1..) => {
            let first = names[..LONGEST_CIRCLE].join(" → ");
            format!("{first} → … ({left} more) → {last}")
        }
        _ => names.join(" → "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Before, the message of a circle of all parameters was half as long as the file.
    #[test]
    fn of_a_long_circle_the_first_names_and_the_last_are_listed() {
        let message = |count: usize| {
            let mut names: Vec<String> = (0..count).map(|k| format!("p{k}")).collect();
            names.push("p0".to_owned());
            FileProblem::Cycle { names }.to_string()
        };
        assert!(message(20).ends_with("p18 → p19 → p0"), "{}", message(20));
        assert!(message(21).ends_with("p19 → … (1 more) → p0"), "{}", message(21));
        assert!(message(50_000).len() < 300);
    }
}
