//! What can be wrong in a mechanism file.

use jointplay_core::mechanism::MechanismError;

use super::expression::ExpressionProblem;
use crate::number::{counted, entries, number};
use crate::place::{Form, listed, suggestion};

/// Why a text is no mechanism, and where.
pub type Error = crate::place::Error<Problem>;

/// What can be wrong in a mechanism file; numbers are in the units of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// Not TOML, an unknown or missing key, or a value of the wrong type.
    #[error(transparent)]
    Form(#[from] Form),
    /// An expression without a value.
    #[error(transparent)]
    Expression(#[from] ExpressionProblem),
    /// Links and joints that make no mechanism.
    #[error(transparent)]
    Mechanism(#[from] MechanismError),
    /// More text than a mechanism needs.
    #[error("the text has {found} bytes, but at most {allowed} are allowed")]
    TooLong {
        /// How many there are.
        found: usize,
        /// How many may be.
        allowed: usize,
    },
    /// A word or name that is none of the known ones.
    #[error("{what} {found:?} is not known{}; known: {}", suggestion(nearest), listed(known))]
    Unknown {
        /// What it should name.
        what: &'static str,
        /// What was found.
        found: String,
        /// The known one most like it.
        nearest: Option<String>,
        /// All that could stand there.
        known: Vec<String>,
    },
    /// An empty name, or one with characters that would upset a terminal.
    #[error("`{key}` is empty or has control characters in it: {found:?}")]
    Name {
        /// Which key.
        key: &'static str,
        /// What was found.
        found: String,
    },
    /// A name of a joint that commands could not tell from others.
    #[error(
        "a joint cannot be called {found:?}: `,` and `=` separate commands, and `[0]` is a freedom of a joint"
    )]
    JointName {
        /// What was found.
        found: String,
    },
    /// A parameter that expressions could not name.
    #[error(
        "no parameter can be called {found:?}: a name is letters, digits and `_`, does not start with a digit, and is neither `pi` nor a function"
    )]
    ParameterName {
        /// What was found.
        found: String,
    },
    /// Parameters that need each other.
    #[error("parameters refer to each other in a circle: {}", names.join(" → "))]
    Cycle {
        /// The circle; the first name is also the last.
        names: Vec<String>,
    },
    /// A number that is NaN or infinite.
    #[error("`{key}` is {}, but has to be a finite number", number(*.value))]
    NotFinite {
        /// Which key.
        key: String,
        /// What was found.
        value: f64,
    },
    /// A length or an angle that no mechanism has.
    #[error("`{key}` is {}, but has to lie within ±{} {unit}", number(*.value), number(*.most))]
    Beyond {
        /// Which key.
        key: &'static str,
        /// What was found.
        value: f64,
        /// Its largest size allowed.
        most: f64,
        /// The unit of both.
        unit: &'static str,
    },
    /// A number too large to be computed with.
    #[error("`{key}` is {}, but has to lie within ±{}", number(*.value), number(*.most))]
    TooLarge {
        /// Which key.
        key: &'static str,
        /// What was found, in the unit of the file.
        value: f64,
        /// Greatest allowed magnitude.
        most: f64,
    },
    /// A number that has to be positive and is not.
    #[error("`{key}` is {}, but has to be positive", number(*.value))]
    NotPositive {
        /// Which key.
        key: &'static str,
        /// What was found.
        value: f64,
    },
    /// A list with too few or too many entries.
    #[error("`{key}` has {}, but needs {needed}", entries(*.found))]
    Count {
        /// Which key.
        key: &'static str,
        /// How many were found.
        found: usize,
        /// How many are needed, and why.
        needed: String,
    },
    /// A direction of length zero.
    #[error("`{key}` is a direction, but all its numbers are 0")]
    NoDirection {
        /// Which key.
        key: &'static str,
    },
    /// A direction of the joint frame's x along its z.
    #[error("`zero` is parallel to the axis, but has to point away from it")]
    ZeroAlongAxis,
    /// Axes of a universal joint that are not at a right angle.
    #[error(
        "`second_axis` is {degrees:.6}° from the axis, but has to be perpendicular to it (90°, within 1e-6 rad)"
    )]
    NotPerpendicular {
        /// The angle between them (deg).
        degrees: f64,
    },
    /// A key that this kind needs.
    #[error("{whose} needs `{key}`")]
    Missing {
        /// Whose key it is.
        whose: String,
        /// The key.
        key: &'static str,
    },
    /// A key that says nothing here.
    #[error("`{key}` does not belong here: {why}")]
    Misplaced {
        /// The key.
        key: &'static str,
        /// Why, and what to write instead.
        why: String,
    },
    /// Loops for a mechanism that is no open chain.
    #[error(
        "the mechanism has {} already: a file of loops closes an open chain, in which all links have one place at zero",
        counted(*.found, "loop")
    )]
    HasLoops {
        /// How many there are.
        found: usize,
    },
    /// A lower limit that is not below its upper limit.
    #[error("`limits` are reversed: least {}, most {}", number(*.min), number(*.max))]
    LimitsReversed {
        /// Lower limit.
        min: f64,
        /// Upper limit.
        max: f64,
    },
}
