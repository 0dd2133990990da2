//! Report of a check.

use crate::EntityId;
use crate::program::Place;
use crate::violation::Violation;

/// Whether a motion may be run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing is broken.
    Sound,
    /// Something is.
    Broken,
}

/// How near a limit something comes, as a share of it: above 1 it is broken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Of which axis, effector or body, as an index into what is asked about.
    pub of: usize,
    /// Largest share.
    pub share: f64,
    /// SampleTime [s].
    pub time: f64,
}

/// How near two bodies come.
#[derive(Debug, Clone, PartialEq)]
pub struct MinimumDistance {
    /// The two collision objects.
    pub entities: [EntityId; 2],
    /// PairMinimum distance found at a sample [m].
    pub distance: f64,
    /// How much less it may have been at samples that were passed over [m].
    pub within: f64,
    /// SampleTime [s].
    pub time: f64,
    /// Index of the step then.
    pub step: usize,
}

/// What is known of one instruction.
#[derive(Debug, Clone, PartialEq)]
pub struct InstructionResult {
    /// Its index in the order of running.
    pub instruction: usize,
    /// Where it is written.
    pub place: Place,
    /// Indices of its steps.
    pub steps: std::ops::Range<usize>,
    /// SampleTime it starts [s].
    pub start: f64,
    /// How long it takes [s].
    pub duration: f64,
    /// How long each axis moves in it [s].
    pub moving: Vec<f64>,
    /// Axis that comes nearest to its speed limit.
    pub velocity: Option<Share>,
    /// Axis that comes nearest to its acceleration limit.
    pub acceleration: Option<Share>,
    /// Axis that comes nearest to its jerk limit.
    pub jerk: Option<Share>,
    /// Share of the tilt limit.
    pub tilt: f64,
    /// Share of the play budget.
    pub play: f64,
    /// Effector whose wafer comes nearest to slipping, by index among all effectors; other samples may have had as much as 0.0001 more, unless it slips.
    pub slip: Option<Share>,
    /// The two bodies that come nearest; `None` where all stay farther than distances are followed.
    pub nearest: Option<MinimumDistance>,
    /// How many violations begin in it.
    pub violations: usize,
}

/// What a check finds.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Whether the motion may be run.
    pub verdict: Verdict,
    /// All that is broken, by time.
    pub violations: Vec<Violation>,
    /// A row for each instruction.
    pub by_instruction: Vec<InstructionResult>,
    /// How near bodies come, nearest first; pairs that stay farther than distances are followed are left out.
    pub distances: Vec<MinimumDistance>,
    /// How long each axis moves [s].
    pub moving: Vec<f64>,
    /// How long the motion takes [s].
    pub duration: f64,
    /// Different wafers that are laid into a slot.
    pub wafers: usize,
    /// Wafers an hour where the program is repeated: those wafers by the duration; `None` where there are none.
    pub wafers_per_hour: Option<f64>,
    /// SegmentSampleTimes that were looked at.
    pub samples: usize,
}
