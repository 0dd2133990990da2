//! Errors of study files.

use crate::file_problem::FileProblem;
use crate::number::number;
use crate::place::{self, listed};
use crate::{cell, coordinates, mechanism, robot, steps};

/// An error of a study file with its place.
pub type Error = place::Error<Problem>;

/// All errors of a study file.
pub type Errors = place::Errors<Problem>;

/// Errors of a study file; numbers are in the units of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// An error that every file can have.
    #[error(transparent)]
    Common(#[from] FileProblem),
    /// A quantity without its unit, or with one that it cannot have.
    #[error("`{quantity}` needs a unit: {}", units.join(", "))]
    Unit {
        /// The quantity.
        quantity: String,
        /// Its name with each unit that it can have.
        units: Vec<String>,
    },
    /// A name with control characters.
    #[error("the name has control characters in it: {found:?}")]
    Name {
        /// The value found.
        found: String,
    },
    /// A range that is none.
    #[error("`{key}`: {source}")]
    Range {
        /// The key.
        key: String,
        /// The error of the range.
        source: steps::Error,
    },
    /// A value that is neither numbers nor a distribution.
    #[error(
        "`{key}` has to be a number, a range \"FROM:TO:STEP\", a list of numbers, {{ uniform = [FROM, TO] }} or {{ normal = [MEAN, DEVIATION] }}"
    )]
    Spread {
        /// The key.
        key: String,
    },
    /// A tolerance that is not drawn.
    #[error(
        "`{key}` has to be drawn: {{ uniform = [FROM, TO] }} or {{ normal = [MEAN, DEVIATION] }}, as differences from the robot file"
    )]
    NotDrawn {
        /// The key.
        key: String,
    },
    /// A range to draw from whose ends do not ascend.
    #[error("`{key}`: invalid range, uniform from {} to {}: the first number must be less than the second", number(*.from), number(*.to))]
    Reversed {
        /// The key.
        key: String,
        /// From.
        from: f64,
        /// To.
        to: f64,
    },
    /// A standard deviation of zero or less.
    #[error("`{key}`: a standard deviation of {} is not positive", number(*.value))]
    Deviation {
        /// The key.
        key: String,
        /// The value found.
        value: f64,
    },
    /// An empty list.
    #[error("`{key}` is empty, but needs at least one entry")]
    Empty {
        /// The key.
        key: String,
    },
    /// The same entry a second time.
    #[error("`{key}` has {found:?} twice")]
    Twice {
        /// The key.
        key: String,
        /// The value found.
        found: String,
    },
    /// Angles other than two that describe a tilt.
    #[error(
        "a pose has either `azimuth_deg` and `tilt_deg`, or `tilt_x_deg` and `tilt_y_deg`; found: {}",
        listed(found)
    )]
    Tilt {
        /// The angles found.
        found: Vec<String>,
    },
    /// Random poses or dimensions without a number of draws.
    #[error("random values need `samples`, the number of draws")]
    NoSamples,
    /// A number of draws where nothing is drawn.
    #[error(
        "`samples` is the number of random draws, but nothing is random; a grid has one sample for each pose"
    )]
    NothingRandom,
    /// Tolerances that give none.
    #[error("there are no tolerances here; known: {}", listed(known))]
    NoTolerances {
        /// Known tolerances.
        known: Vec<String>,
    },
    /// A metric that is none.
    #[error("the metric has to be \"paper\", \"radius\", or a length in mm from 1e-9 to 1e9")]
    Metric,
    /// A mechanism that cannot be had, or that no study takes.
    #[error("{message}")]
    Mechanism {
        /// Why.
        message: String,
    },
    /// An invalid mechanism file.
    #[error("the mechanism {name:?} is invalid: {errors}")]
    MechanismFile {
        /// How the study calls it.
        name: String,
        /// The errors of the mechanism file.
        errors: mechanism::Errors,
    },
    /// An invalid cell file.
    #[error("the cell {name:?} is invalid: {errors}")]
    CellFile {
        /// How the study calls it.
        name: String,
        /// The errors of the cell file.
        errors: cell::Errors,
    },
    /// An invalid program.
    #[error("the program {name:?} is invalid: {errors}")]
    ProgramFile {
        /// How the study calls it.
        name: String,
        /// The errors of the program, with their lines.
        errors: String,
    },
    /// A station that cannot be displaced in its file.
    #[error("the station {station:?} cannot be displaced along {axis}: {why}")]
    Station {
        /// Name of the station.
        station: String,
        /// Axis of the base frame.
        axis: &'static str,
        /// Why.
        why: String,
    },
    /// A name that is no joint coordinate.
    #[error(transparent)]
    Coordinate(#[from] coordinates::Error),
    /// A robot that cannot be had.
    #[error("{message}")]
    Robot {
        /// Why.
        message: String,
    },
    /// An invalid robot file.
    #[error("{}", invalid_robot(name, errors))]
    RobotFile {
        /// How the study calls it.
        name: String,
        /// The errors of the robot file.
        errors: place::Errors<robot::Problem>,
    },
    /// Two columns of the table with one name.
    #[error(
        "the table would have two columns {name:?}: rename the parameter, joint or frame of this name in the mechanism"
    )]
    SameColumn {
        /// The name.
        name: String,
    },
    /// More samples than can be counted.
    #[error("{0}")]
    Plan(jointplay_study::Error),
}

fn invalid_robot(name: &str, errors: &[place::Error<robot::Problem>]) -> String {
    let message = |error: &place::Error<_>| format!("line {}: {error}", error.place.line);
    let messages: Vec<String> = errors.iter().map(message).collect();
    format!("the robot {name:?} is invalid: {}", messages.join("; "))
}
