//! Errors of expressions.

use std::collections::BTreeSet;
use std::ops::Range;

use super::functions::function_names;
use crate::number::number;
use crate::place::{listed, nearest, suggestion};

/// Deepest nesting of parentheses, powers and signs, so that no text overflows the stack.
pub(super) const MAX_DEPTH: usize = 100;

/// An error of an expression with the bytes that it is about.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{problem}")]
pub struct ExpressionError {
    /// Bytes of the expression that the error is about.
    pub span: Range<usize>,
    /// The error.
    pub problem: ExpressionProblem,
}

/// Errors of an expression.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExpressionProblem {
    /// An unknown name.
    #[error("unknown name `{name}`{}; known here: {}", suggestion(nearest), listed(known))]
    UnknownName {
        /// The name found.
        name: String,
        /// The known name most like it.
        nearest: Option<String>,
        /// All known names.
        known: Vec<String>,
    },
    /// Something else where a part of an expression should be.
    #[error("column {column} of the expression: expected {expected}, found {found}")]
    Syntax {
        /// Column in characters within the expression, counted from 1.
        column: usize,
        /// The parts of an expression allowed there.
        expected: &'static str,
        /// The text found.
        found: String,
    },
    /// A function without its arguments.
    #[error("`{function}` is a function: write its arguments in parentheses")]
    NoArguments {
        /// The function.
        function: String,
    },
    /// A function with too few or too many arguments.
    #[error("`{function}` takes {expected}, but has {found}")]
    ArgumentCount {
        /// The function.
        function: &'static str,
        /// How many it takes.
        expected: &'static str,
        /// How many are given.
        found: usize,
    },
    /// A result that is NaN or infinite.
    #[error("the expression gives a value that is {}, but has to be a finite number", number(*.value))]
    NotFinite {
        /// Value of the expression.
        value: f64,
    },
    /// Nested too deeply.
    #[error("the expression is nested more than {MAX_DEPTH} deep")]
    TooDeep,
}

impl ExpressionError {
    /// Whether the error is an unknown name that is one of these.
    pub(crate) fn is_about(&self, names: &BTreeSet<String>) -> bool {
        matches!(&self.problem, ExpressionProblem::UnknownName { name, .. } if names.contains(name))
    }

    /// The error with the known names, if it is about an unknown one.
    pub(crate) fn among<'a>(mut self, names: impl Iterator<Item = &'a str> + Clone) -> Self {
        if let ExpressionProblem::UnknownName { name, nearest: likest, known } = &mut self.problem {
            if function_names().any(|function| function == name) {
                self.problem = ExpressionProblem::NoArguments { function: name.clone() };
                return self;
            }
            let names = names.chain(["pi"]);
            *likest = nearest(name, names.clone());
            *known = names.map(str::to_owned).collect();
        }
        self
    }
}
