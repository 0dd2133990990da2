//! Steps for which no trajectory exists.

use super::cartesian_path::PathError;
use super::synchronized::NoProfile;
use crate::program::{Phase, SourceLocation};

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
    /// Phase of its instruction.
    pub phase: Phase,
    /// The error.
    pub kind: StepErrorKind,
}

/// Error of a step.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepErrorKind {
    /// The step does not have one position for each axis.
    #[error("step has {from} start and {to} end positions; the robot has {axes} axes")]
    PositionCount {
        /// Number of start positions.
        from: usize,
        /// Number of end positions.
        to: usize,
        /// Number of axes of the robot.
        axes: usize,
    },
    /// A position is not a finite number.
    #[error("axis position must be finite, got {value}")]
    PositionNotFinite {
        /// The value found.
        value: f64,
    },
    /// The speed scaling is not above 0 and at most 1.
    #[error("speed scaling must be above 0 and at most 1, got {value}")]
    SpeedScaling {
        /// The value found.
        value: f64,
    },
    /// The step does not start where the step before ends.
    #[error(
        "axis {axis} starts at {start}, but the previous step ends at {previous_end}: a step must start where the previous one ends"
    )]
    NotContinuous {
        /// Index of the axis.
        axis: usize,
        /// Position at the start of this step (m or rad).
        start: f64,
        /// Position at the end of the step before (m or rad).
        previous_end: f64,
    },
    /// The duration of a dwell is negative or not finite.
    #[error("dwell duration must be finite and not negative, got {duration} s")]
    DwellDuration {
        /// The duration found (s).
        duration: f64,
    },
    /// Start and end positions of a dwell differ.
    #[error("start and end positions of a dwell must be equal")]
    DwellMoves,
    /// The step waits for a process whose wafer is placed only by a later step.
    #[error("dwell waits for the process of a wafer that a later step places")]
    ProcessNotStarted,
    /// No profile was found for a point-to-point move, or for the path parameter of a line.
    #[error(transparent)]
    NoProfile(#[from] NoProfile),
    /// The axes cannot follow a Cartesian line.
    #[error(transparent)]
    Path(#[from] PathError),
    /// The trajectory does not end within [`MAX_DURATION`](super::MAX_DURATION).
    #[error(
        "trajectory duration is {end} s at the end of this step, which takes {step} s; the maximum is {allowed} s"
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
