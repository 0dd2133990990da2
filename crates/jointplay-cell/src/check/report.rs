//! Report of a check.

use crate::EntityId;
use crate::program::SourceLocation;
use crate::violation::Violation;

/// Result of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CheckResult {
    /// No violation was found.
    Passed,
    /// Violations were found.
    Failed,
    /// No violation was found, but no axis moves, as in a program that only waits: there is no motion that could pass.
    NoMotion,
}

/// Peak of a quantity relative to its limit; above 1 the limit is violated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Utilization {
    /// Index of the axis or effector.
    pub index: usize,
    /// Value divided by its limit.
    pub ratio: f64,
    /// Time of the peak (s).
    pub time: f64,
}

/// Minimum distance of two collision objects over a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct MinimumDistance {
    /// The two collision objects.
    pub entities: [EntityId; 2],
    /// Minimum distance at the samples (m).
    pub distance: f64,
    /// Tolerance: samples that were not evaluated may have a distance smaller by this much (m).
    pub tolerance: f64,
    /// Time of the minimum (s).
    pub time: f64,
    /// Index of the step at that time.
    pub step: usize,
}

/// Results of one instruction.
#[derive(Debug, Clone, PartialEq)]
pub struct InstructionResult {
    /// Index of the instruction in the order of execution.
    pub instruction: usize,
    /// Location of the instruction in the program text.
    pub place: SourceLocation,
    /// Indices of the steps.
    pub steps: std::ops::Range<usize>,
    /// Start time (s).
    pub start: f64,
    /// Duration (s).
    pub duration: f64,
    /// Time during which each axis moves (s).
    pub moving_time: Vec<f64>,
    /// Largest velocity relative to its limit.
    pub velocity: Option<Utilization>,
    /// Largest acceleration relative to its limit.
    pub acceleration: Option<Utilization>,
    /// Largest jerk relative to its limit.
    pub jerk: Option<Utilization>,
    /// Largest tilt relative to its limit.
    pub tilt: f64,
    /// Largest displacement of the virtual joints relative to the play budget.
    pub play: f64,
    /// Largest utilization of friction, by index among all effectors.
    /// Not all samples are evaluated: by an estimate with a margin, which is not proven, the others have at most 0.0001 more, and none of them slips.
    pub slip: Option<Utilization>,
    /// Minimum distance of all pairs; `None` where all distances exceed the reporting range.
    pub nearest: Option<MinimumDistance>,
    /// Number of violations that begin in the instruction.
    pub violations: usize,
}

/// Report of a check.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Whether violations were found, or nothing moves.
    pub result: CheckResult,
    /// All violations in the order of time.
    pub violations: Vec<Violation>,
    /// Results of each instruction.
    pub by_instruction: Vec<InstructionResult>,
    /// Minimum distances of pairs within the reporting range, smallest first.
    pub distances: Vec<MinimumDistance>,
    /// Time during which each axis moves (s).
    pub moving_time: Vec<f64>,
    /// Duration of the trajectory (s).
    pub duration: f64,
    /// Number of wafers that are placed into a slot, each counted once.
    pub wafers: usize,
    /// Wafers per hour of the repeated program: wafers by duration; `None` without wafers (1/h).
    pub wafers_per_hour: Option<f64>,
    /// Number of samples.
    pub samples: usize,
}
