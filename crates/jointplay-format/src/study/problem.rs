//! What can be wrong in a study file.

use crate::number::number;
use crate::place::{Form, listed, suggestion};
use crate::{robot, steps};

/// Why a text is no study, and where.
pub type Error = crate::place::Error<Problem>;

/// What can be wrong in a study file; numbers are in the units of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// Not TOML, an unknown or missing key, or a value of the wrong type.
    #[error(transparent)]
    Form(#[from] Form),
    /// More text than a study needs.
    #[error("the text has {found} bytes, but at most {allowed} are allowed")]
    TooLong {
        /// How many there are.
        found: usize,
        /// How many may be.
        allowed: usize,
    },
    /// A word that is none of the known ones.
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
    /// A quantity without its unit, or with one that it cannot have.
    #[error("`{quantity}` needs a unit: {}", units.join(", "))]
    Unit {
        /// The quantity.
        quantity: String,
        /// Its name with each unit that it can have.
        units: Vec<String>,
    },
    /// A name with characters that would upset a terminal.
    #[error("the name has control characters in it: {found:?}")]
    Name {
        /// What was found.
        found: String,
    },
    /// A number that is NaN or infinite.
    #[error("`{key}` has a value that is {}, but needs finite numbers", number(*.value))]
    NotFinite {
        /// Which key.
        key: &'static str,
        /// What was found.
        value: f64,
    },
    /// A number that is too large or too small.
    #[error("`{key}` has {}, but needs numbers from {} to {}", number(*.value), number(*.min), number(*.max))]
    Beyond {
        /// Which key.
        key: &'static str,
        /// What was found.
        value: f64,
        /// Least allowed.
        min: f64,
        /// Greatest allowed.
        max: f64,
    },
    /// A range that is none.
    #[error("`{key}`: {source}")]
    Range {
        /// Which key.
        key: &'static str,
        /// What is wrong with it.
        source: steps::Error,
    },
    /// Something that says no values.
    #[error(
        "`{key}` has to be a number, a range \"FROM:TO:STEP\", a list of numbers, {{ uniform = [FROM, TO] }} or {{ normal = [MEAN, DEVIATION] }}"
    )]
    Spread {
        /// Which key.
        key: &'static str,
    },
    /// A tolerance that is not drawn.
    #[error(
        "`{key}` has to be drawn: {{ uniform = [FROM, TO] }} or {{ normal = [MEAN, DEVIATION] }}, as differences from the robot file"
    )]
    NotDrawn {
        /// Which key.
        key: &'static str,
    },
    /// A range to draw from whose ends do not ascend.
    #[error("`{key}`: uniform from {} to {} is no range; the first has to be the smaller", number(*.from), number(*.to))]
    Reversed {
        /// Which key.
        key: &'static str,
        /// From.
        from: f64,
        /// To.
        to: f64,
    },
    /// A standard deviation of zero or less.
    #[error("`{key}`: a standard deviation of {} is not positive", number(*.value))]
    Deviation {
        /// Which key.
        key: &'static str,
        /// What was found.
        value: f64,
    },
    /// An empty list.
    #[error("`{key}` is empty, but needs at least one entry")]
    Empty {
        /// Which key.
        key: &'static str,
    },
    /// The same entry a second time.
    #[error("`{key}` has {found:?} twice")]
    Twice {
        /// Which key.
        key: &'static str,
        /// What was found.
        found: String,
    },
    /// Not exactly two angles that say a tilt.
    #[error(
        "a pose has either `yaw_deg` and `pitch_deg`, or `tilt_x_deg` and `tilt_y_deg`; found: {}",
        listed(found)
    )]
    Tilt {
        /// The angles found.
        found: Vec<String>,
    },
    /// Random poses or dimensions without a number of draws.
    #[error("what is drawn at random needs `samples`, how often")]
    NoSamples,
    /// A number of draws where nothing is drawn.
    #[error(
        "`samples` says how often random numbers are drawn, but nothing is random; a grid has as many samples as places"
    )]
    NothingRandom,
    /// A count that is not positive, or a negative seed.
    #[error("`{key}` is {found}, but has to be at least {least}")]
    Count {
        /// Which key.
        key: &'static str,
        /// What was found.
        found: i64,
        /// Least allowed.
        least: i64,
    },
    /// Tolerances that give none.
    #[error("there are no tolerances here; known: {}", listed(known))]
    NoTolerances {
        /// What there could be.
        known: Vec<String>,
    },
    /// A metric that is none.
    #[error("the metric has to be \"paper\", \"radius\", or a length in mm from 1e-9 to 1e9")]
    Metric,
    /// A robot that cannot be had.
    #[error("{message}")]
    Robot {
        /// Why.
        message: String,
    },
    /// A robot file that is none.
    #[error("line {line} of the robot {name:?} is wrong: {source}")]
    RobotFile {
        /// How the study calls it.
        name: String,
        /// Which line of it, counted from 1.
        line: usize,
        /// What is wrong.
        source: Box<robot::Problem>,
    },
    /// More samples than can be counted.
    #[error("{0}")]
    Plan(jointplay_study::Error),
}
