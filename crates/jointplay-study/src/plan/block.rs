//! Samples that are computed together.

use jointplay_core::bulk::Status;

use super::moments::Moments;

/// How many samples of a study are computed, handed on and looked at together, by the time that a sample takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Portions {
    /// Samples that a core computes at a time: enough to hide handing them out, few enough to stay in its cache.
    pub block: usize,
    /// Samples that are handed on together: a row group of a table; a study stops between them.
    pub chunk: u64,
    /// Samples that quantiles are taken from at most; they are computed again.
    pub quantiles: u64,
}

impl Portions {
    /// Of samples in less than a microsecond: the three-rod robot.
    pub const QUICK: Self = Self { block: 4096, chunk: 65_536, quantiles: 65_536 };
    /// Of samples in milliseconds: mechanisms.
    pub const SLOW: Self = Self { block: 64, chunk: 2048, quantiles: 4096 };
}

/// Outcome of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// There is a robot or mechanism, and its pose has this status.
    Pose(Status),
    /// The dimensions of the sample make no robot or mechanism.
    NoMechanism,
}

impl Outcome {
    /// The outcome in words, as shown to users.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pose(status) => status.name(),
            Self::NoMechanism => "dimensions that make no mechanism",
        }
    }
}

/// Some samples of a study: a column for all that is wanted, NaN where a sample has no answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Numbers of the samples.
    pub samples: Vec<u64>,
    /// Draw of each.
    pub draws: Vec<u64>,
    /// Output quantities, in the order of the study, in SI units.
    pub columns: Vec<Vec<f64>>,
    /// What became of each sample, for each of [`Study::solved_for`](super::Study::solved_for).
    pub outcomes: Vec<Vec<Outcome>>,
    /// The columns summed up.
    pub moments: Vec<Moments>,
    /// Samples with a rod beyond its limits.
    pub beyond_rods: u64,
    /// Samples that are commanded beyond the limit of the tilt.
    pub beyond_tilt: u64,
    /// Samples with a joint of a mechanism beyond its limits or clearance.
    pub beyond_joints: u64,
}
