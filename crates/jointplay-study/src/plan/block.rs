//! Samples that are computed together.

use jointplay_core::bulk::Status;

use super::moments::Moments;

/// Samples that a core computes at a time: enough to hide handing them out, few enough to stay in its cache.
pub const BLOCK: usize = 4096;
/// Samples that are handed on together: a row group of a table.
pub const CHUNK: u64 = 65_536;

/// Outcome of a sample under a virtualization.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// There is a robot, and its pose has this status.
    Pose(Status),
    /// The dimensions drawn make no robot.
    NoRobot,
}

impl Outcome {
    /// The outcome in words, as shown to users.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pose(status) => status.name(),
            Self::NoRobot => "dimensions that make no robot",
        }
    }
}

/// Some samples of a plan: a column for all that is wanted, NaN where a sample has no answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Numbers of the samples.
    pub samples: Vec<u64>,
    /// Draw of each.
    pub draws: Vec<u64>,
    /// Output quantities, in the order of the plan, in SI units.
    pub columns: Vec<Vec<f64>>,
    /// For each virtualization what became of each sample.
    pub outcomes: Vec<Vec<Outcome>>,
    /// The columns summed up.
    pub moments: Vec<Moments>,
    /// Samples with a rod beyond its limits.
    pub beyond_rods: u64,
    /// Samples that are commanded beyond the limit of the tilt.
    pub beyond_tilt: u64,
}
