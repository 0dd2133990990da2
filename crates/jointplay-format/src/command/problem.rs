//! Errors of commands.

use crate::coordinates;
use crate::expression::ExpressionError;

/// Error in the text of a command.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An expression that is invalid, or that has no finite value.
    #[error("{text:?}: {error}")]
    Expression {
        /// The text of the expression.
        text: String,
        /// The error in it.
        error: ExpressionError,
    },
    /// A unit of lengths for an angle, or the reverse.
    #[error("{text:?}: the value is {needed}, but {unit} is a unit of {other}")]
    OtherQuantity {
        /// The text of the value.
        text: String,
        /// The unit found.
        unit: &'static str,
        /// Quantity of the value.
        needed: &'static str,
        /// Quantity of the unit.
        other: &'static str,
    },
    /// A variable that is a parameter of the file.
    #[error(
        "`{name}` is a parameter of the file; choose another name for the variable, such as `{other}`"
    )]
    VariableIsParameter {
        /// The name.
        name: String,
        /// A name that is free.
        other: &'static str,
    },
    /// A text that cannot name a variable.
    #[error(
        "{name:?} cannot name a variable: it must be a letter or `_`, then letters, digits and `_`, and not `pi`"
    )]
    VariableName {
        /// The text found.
        name: String,
    },
    /// A text that is no command to a pose.
    #[error("invalid pose {text:?}: expected FRAME: COMMAND, with {expected}")]
    Pose {
        /// The text found.
        text: String,
        /// The commands.
        expected: &'static str,
    },
    /// A name that is neither a link nor a frame.
    #[error(transparent)]
    Frame(#[from] coordinates::Error),
    /// Two commands to one frame.
    #[error("{text:?}: this frame is commanded twice; join the commands by `;`")]
    CommandedTwice {
        /// The second command.
        text: String,
    },
    /// A command to a frame of the base.
    #[error("`{name}` belongs to the base, and the base does not move")]
    BaseCommanded {
        /// Its name.
        name: String,
    },
    /// A tilt about an axis that is not perpendicular to the z axis of the frame.
    #[error("{text:?}: the axis is not perpendicular to the z axis of the frame, which is ({:.6}, {:.6}, {:.6}) in the base frame; use `turn`, or attach a frame with another z axis", z[0], z[1], z[2])]
    AxisNotPerpendicular {
        /// The text of the command.
        text: String,
        /// The z axis of the frame in the base frame.
        z: [f64; 3],
    },
    /// An axis of length zero.
    #[error("{text:?}: the axis is zero, and has no direction")]
    NoAxis {
        /// The text of the command.
        text: String,
    },
}
