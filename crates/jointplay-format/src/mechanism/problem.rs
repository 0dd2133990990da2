//! Errors of mechanism files.

use jointplay_core::mechanism::MechanismError;
use jointplay_core::range_fault;

use crate::file_problem::FileProblem;
use crate::number::{counted, number};

/// An error of a mechanism file with its place.
pub type Error = crate::place::Error<Problem>;

/// All errors of a mechanism file.
pub type Errors = crate::place::Errors<Problem>;

/// Errors of a mechanism file; numbers are in the units of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// An error that every file can have.
    #[error(transparent)]
    Common(#[from] FileProblem),
    /// Links and joints that make no mechanism.
    #[error(transparent)]
    Mechanism(#[from] MechanismError),
    /// A name that is empty or has control characters.
    #[error("`{key}` is empty or has control characters in it: {found:?}")]
    Name {
        /// The key.
        key: String,
        /// The value found.
        found: String,
    },
    /// A joint name that is ambiguous in commands.
    #[error(
        "a joint cannot be called {found:?}: `,` and `=` separate commands, and `[0]` is a freedom of a joint"
    )]
    JointName {
        /// The value found.
        found: String,
    },
    /// A direction of length zero.
    #[error("`{key}` is a direction, but all its numbers are 0")]
    NoDirection {
        /// The key.
        key: String,
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
    /// A key without effect here.
    #[error("`{key}` does not belong here: {why}")]
    Misplaced {
        /// The key.
        key: &'static str,
        /// Why, and what to write instead.
        why: String,
    },
    /// A loop closure file for a mechanism that is no open chain.
    #[error(
        "the mechanism has {} already: a loop closure file requires an open chain",
        counted(*.found, "loop")
    )]
    HasLoops {
        /// Number of loops found.
        found: usize,
    },
    /// A lower limit that is not below its upper limit.
    #[error(
        "`limits` are {}: least {}, most {}",
        range_fault(*.min, *.max), number(*.min), number(*.max)
    )]
    LimitsReversed {
        /// Lower limit.
        min: f64,
        /// Upper limit.
        max: f64,
    },
}
