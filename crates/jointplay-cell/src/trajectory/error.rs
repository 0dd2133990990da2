//! Steps for which no trajectory exists.

use super::cartesian_path::PathError;
use super::synchronized::NoProfile;
use crate::program::SourceLocation;

/// Steps for which no trajectory exists.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", steps.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct TrajectoryError {
    /// All of them, in the order of execution; one at least.
    pub steps: Vec<StepError>,
}

/// A step for which no trajectory exists.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {}: {kind}", place.line)]
pub struct StepError {
    /// Index of the step.
    pub step: usize,
    /// Index of its instruction in the order of execution.
    pub instruction: usize,
    /// Location of the instruction in the program's text.
    pub place: SourceLocation,
    /// The error.
    pub kind: StepErrorKind,
}

/// Error of a step.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepErrorKind {
    /// The step does not have one position for each axis.
    #[error("a step from {from} to {to} positions, but the robot has {axes} axes")]
    PositionCount {
        /// Number of start positions.
        from: usize,
        /// Number of end positions.
        to: usize,
        /// Number of axes of the robot.
        axes: usize,
    },
    /// A position is not a finite number.
    #[error("a position is {value}, but has to be a finite number")]
    PositionNotFinite {
        /// The value found.
        value: f64,
    },
    /// The share of the limits is not above 0 and at most 1.
    #[error("the share of speed is {share}, but has to be above 0 and at most 1")]
    SpeedShare {
        /// The share found.
        share: f64,
    },
    /// The step does not start where the step before ends.
    #[error(
        "axis {axis} starts at {start}, but the step before ends at {previous_end}: steps have to join"
    )]
    NotContinuous {
        /// Index of the axis.
        axis: usize,
        /// Position at the start of this step (m or rad).
        start: f64,
        /// Position at the end of the step before (m or rad).
        previous_end: f64,
    },
    /// A dwell does not have a finite duration from 0 on.
    #[error("waits {duration} s, but that has to be a finite time from 0 on")]
    DwellDuration {
        /// The duration found (s).
        duration: f64,
    },
    /// A dwell ends in other positions than it starts in.
    #[error("a dwell has to end in the positions in which it starts")]
    DwellMoves,
    /// The step waits for the process of a station that receives its wafer only later.
    #[error("waits for a station that receives its wafer only later")]
    ProcessNotStarted,
    /// No profile was found for a point-to-point move, or for the path parameter of a line.
    #[error(transparent)]
    NoProfile(#[from] NoProfile),
    /// The axes cannot follow a Cartesian line.
    #[error(transparent)]
    Path(#[from] PathError),
    /// The trajectory does not end within [`MAX_DURATION`](super::MAX_DURATION).
    #[error(
        "the trajectory takes {end} s up to the end of this step, which takes {step} s; at most {allowed} s are allowed"
    )]
    TooLong {
        /// Time from the start of the trajectory to the end of the step (s).
        end: f64,
        /// Duration of the step alone (s).
        step: f64,
        /// Longest duration of a trajectory (s).
        allowed: f64,
    },
}
