//! Errors of descriptions and of arguments.

use jointplay_core::spatial::Tilt;

/// Invalid description of a robot, station or cell, or invalid argument. Lengths are in m, angles in rad.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CellError {
    /// A number is NaN or infinite.
    #[error("{what} is {value}, but has to be a finite number")]
    NotFinite {
        /// Which number.
        what: String,
        /// What was found.
        value: f64,
    },
    /// A number that has to be positive is not.
    #[error("{what} is {value} {unit}, but has to be positive")]
    NotPositive {
        /// Which number.
        what: String,
        /// What was found, in `unit`.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A number that has to lie within limits does not.
    #[error("{what} is {value} {unit}, but has to lie from {min} to {max} {unit}")]
    OutOfRange {
        /// Which number.
        what: String,
        /// What was found, in `unit`.
        value: f64,
        /// Least allowed, in `unit`.
        min: f64,
        /// Greatest allowed, in `unit`.
        max: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A lower limit is not below its upper limit.
    #[error("the limits of {what} are reversed: least {min} {unit}, most {max} {unit}")]
    LimitsReversed {
        /// Of what.
        what: String,
        /// Lower limit, in `unit`.
        min: f64,
        /// Upper limit, in `unit`.
        max: f64,
        /// Their unit.
        unit: &'static str,
    },
    /// Parts of a description contradict each other.
    #[error("contradictory: {what}")]
    Contradiction {
        /// The contradiction.
        what: String,
    },
    /// Two things of one kind have the same name.
    #[error("two {what} are called {name:?}; each needs a name of its own")]
    NameTwice {
        /// Which kind of thing.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A name without letters.
    #[error("the name of {what} is empty")]
    NoName {
        /// Of what.
        what: String,
    },
    /// Too few or too many of something.
    #[error("{what}: there are {found}, but {min} to {max} are possible")]
    Count {
        /// Of what.
        what: String,
        /// How many there are.
        found: usize,
        /// Least number.
        min: usize,
        /// Greatest number.
        max: usize,
    },
    /// Something is named by an index that it does not have.
    #[error("{what} refers to {kind} {index}, but they are {min} to {max}, counted from 0")]
    NoSuch {
        /// The part that refers.
        what: String,
        /// To which kind of thing.
        kind: &'static str,
        /// The index.
        index: usize,
        /// Least index.
        min: usize,
        /// Greatest index.
        max: usize,
    },
    /// A motor that moves nothing.
    #[error("axis {axis} moves no joint; drive a joint by it, or remove it")]
    IdleAxis {
        /// Its name.
        axis: String,
    },
    /// A motor whose zero, kind or limits contradict what it is there for.
    #[error("axis {axis}: {why}")]
    InvalidAxis {
        /// Its name.
        axis: String,
        /// The contradiction, and how to remove it.
        why: String,
    },
    /// An arm whose motors cannot move the wafer in two directions of its plane.
    #[error(
        "the motors of arm {arm} move the wafer of effector {effector} along {directions} of the 2 directions of their plane; a second motor has to drive a joint of its own"
    )]
    NotMovable {
        /// Name of the arm.
        arm: String,
        /// Name of the effector.
        effector: String,
        /// Independent directions found, 0 or 1.
        directions: usize,
    },
    /// A wafer that is no thin plate.
    #[error(
        "the wafer is {thickness} m thick and {diameter} m wide, but a thin plate of that diameter is at most {allowed} m thick"
    )]
    NotThin {
        /// Diameter (m).
        diameter: f64,
        /// Thickness found (m).
        thickness: f64,
        /// Largest thickness (m).
        allowed: f64,
    },
    /// Points of a convex hull that do not span a volume.
    #[error(
        "the {points} points of a convex hull are in one plane; a hull needs 4 points or more that span a volume"
    )]
    FlatHull {
        /// Number of points.
        points: usize,
    },
    /// An opening that removes nothing of its box.
    #[error("opening {index} of a box, counted from 0, has no common interior with the box")]
    OpeningOutside {
        /// Index of the opening.
        index: usize,
    },
    /// Openings that remove the whole box.
    #[error("the openings of a box remove all of it")]
    NothingLeft,
    /// A station at which an arm cannot be retracted.
    #[error(
        "the retract distance of station {station} is {found} m, but has to be less than the distance of its wafer from the first joint of the arm, {reach} m"
    )]
    RetractReach {
        /// Name of the station.
        station: String,
        /// Retract distance found (m).
        found: f64,
        /// Least distance of a wafer in a slot from the first joint of the arm, seen from above (m).
        reach: f64,
    },
    /// A station that tilts further than the platform.
    #[error("station {station} tilts by {} rad, but the robot tilts by at most {max} rad; level the station", tilt.angle)]
    StationTilt {
        /// Name of the station.
        station: String,
        /// Tilt of the station.
        tilt: Tilt,
        /// Largest tilt of the robot (rad).
        max: f64,
    },
    /// A slot that the cell does not have.
    #[error(
        "there is no slot {slot} of station {station}: stations are counted from 0, slots from 1"
    )]
    NoSuchSlot {
        /// Index of the station.
        station: usize,
        /// Number of the slot.
        slot: usize,
    },
    /// A slot or effector with several wafers at the start.
    #[error("{location} has several wafers at the start, but supports one")]
    SeveralWafers {
        /// The slot or effector.
        location: String,
    },
    /// An effector that the robot does not have.
    #[error("there is no effector {effector} on an arm {arm}, counted from 0")]
    NoSuchEffector {
        /// Index of the arm.
        arm: usize,
        /// Index of the effector on it.
        effector: usize,
    },
    /// Positions for another number of axes.
    #[error("{found} positions are given, but the robot has {expected} axes")]
    LengthMismatch {
        /// How many were given.
        found: usize,
        /// How many axes there are.
        expected: usize,
    },
    /// A target plane that no tilt of the platform reaches.
    #[error(
        "the normal ({}, {}, {}) does not point up: its z has to be positive, and its length not zero",
        normal[0], normal[1], normal[2]
    )]
    NormalNotUp {
        /// The given normal.
        normal: [f64; 3],
    },
    /// The robot under the platform cannot be computed.
    #[error(transparent)]
    Platform(#[from] jointplay_core::Error),
}
