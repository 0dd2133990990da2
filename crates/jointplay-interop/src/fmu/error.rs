//! Why a unit cannot be made, or has no answer.

use jointplay_core::Error as CoreError;
use jointplay_core::mechanism::joint::Coordinate;
use jointplay_format::coordinates;
use jointplay_format::display_units::DisplayUnits;
use jointplay_format::explain::explain;
use jointplay_format::number::number;
use jointplay_report::FreeMotionsReport;

/// What to do where drives leave motions free that are no spins.
const FREE_MOTION_REMEDY: &str = "set `actuated = true` at one of their joints for each, or choose an initial configuration that is not singular";

/// Why a unit cannot be made, or has no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An error of the computation.
    #[error("{}", explain(.0, DisplayUnits::Metric))]
    Core(#[from] CoreError),
    /// A mechanism without inputs.
    #[error(
        "{mechanism} has no actuated joint, and so no input: set `actuated = true` at the joints that motors drive"
    )]
    NoDrives {
        /// Name of the mechanism.
        mechanism: String,
    },
    /// An actuated joint whose three coordinates are no independent inputs.
    #[error(
        "joint `{joint}` is an actuated ball, whose rates are no derivatives of its coordinates: use three hinges in its place"
    )]
    ActuatedBall {
        /// Name of the joint.
        joint: String,
    },
    /// Motions that remain where the drives are held, so that the drives do not determine the outputs.
    #[error("{}", motions.explained("drives", FREE_MOTION_REMEDY))]
    FreeMotions {
        /// The motions.
        motions: FreeMotionsReport,
    },
    /// A name or value of a coordinate.
    #[error(transparent)]
    Coordinate(#[from] coordinates::Error),
    /// A configuration beyond joint limits or clearances, or a pose beyond the limits of the robot.
    #[error("limits exceeded: {}", messages.join("; "))]
    BeyondLimits {
        /// A message for each limit, in the units of the file.
        messages: Vec<String>,
    },
    /// An unreadable resource file.
    #[error("the resource {file} is invalid: {message}")]
    Resource {
        /// Name of the file.
        file: String,
        /// The errors in it.
        message: String,
    },
    /// A virtualization that is not known, or is given for a mechanism.
    #[error("virtualization {found:?}: {}", expected(known))]
    Virtualization {
        /// The virtualization found.
        found: String,
        /// The known ones; none for a mechanism.
        known: Vec<String>,
    },
    /// A value reference without a variable.
    #[error("there is no variable with the value reference {reference}")]
    NoVariable {
        /// The value reference.
        reference: u32,
    },
    /// A variable that cannot be set, or by which there are no derivatives.
    #[error("{variable} is not an input")]
    NotInput {
        /// Name of the variable.
        variable: String,
    },
    /// A variable without derivatives.
    #[error("{variable} is not an output")]
    NotOutput {
        /// Name of the variable.
        variable: String,
    },
    /// A value that is NaN or infinite.
    #[error("{variable} is {value}, but has to be a finite number")]
    NotFinite {
        /// Name of the variable.
        variable: String,
        /// The value.
        value: f64,
    },
    /// Drives that are too far from those of the configuration before.
    #[error(
        "{}; {variable} is {} {} from its value at the step before: use shorter steps", explain(source, DisplayUnits::Metric), number(*distance), unit(*quantity)
    )]
    TooFar {
        /// Why there is no solution.
        source: Box<CoreError>,
        /// The input with the largest step.
        variable: String,
        /// Its step (m, rad).
        distance: f64,
        /// Whether it is a length or an angle.
        quantity: Coordinate,
    },
    /// A state of another unit, or damaged bytes.
    #[error("the state is not one of this unit: {message}")]
    State {
        /// What was found.
        message: String,
    },
}

fn expected(known: &[String]) -> String {
    if known.is_empty() {
        "only three-rod robots have one; a mechanism has its own virtual joints".to_owned()
    } else {
        format!("known are {}", known.join(", "))
    }
}

fn unit(quantity: Coordinate) -> &'static str {
    match quantity {
        Coordinate::Slide => "m",
        Coordinate::Turn => "rad",
    }
}

impl Error {
    /// Whether the input is valid and has no solution, as opposed to invalid input.
    #[must_use]
    pub fn is_infeasible(&self) -> bool {
        match self {
            Self::Core(error) => error.is_infeasible(),
            Self::TooFar { source, .. } => source.is_infeasible(),
            Self::BeyondLimits { .. } | Self::FreeMotions { .. } => true,
            _ => false,
        }
    }
}
