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
    /// Of samples in tenths of seconds: programs of work cells.
    pub const SLOWEST: Self = Self { block: 4, chunk: 64, quantiles: 512 };
}

/// Outcome of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// There is a robot or mechanism, and its pose has this status.
    Pose(Status),
    /// The dimensions of the sample make no robot or mechanism.
    NoMechanism,
    /// There is a work cell with a program, and this became of it.
    Program(ProgramOutcome),
}

/// Outcome of a program in a work cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProgramOutcome {
    /// The check of its trajectory found no violation.
    Passed,
    /// The check of its trajectory found violations.
    Violations,
    /// A target is out of reach or beyond limits.
    OutOfReach,
    /// Some of its steps have no trajectory within the limits.
    NoTrajectory,
    /// It contains no motion.
    NoMotion,
    /// Its parameters or names do not fit the cell.
    InvalidProgram,
    /// The values make no valid cell.
    InvalidCell,
}

impl Outcome {
    /// All outcomes, in the order in which they are counted.
    pub const ALL: [Self; Status::ALL.len() + 8] = {
        let mut all = [Self::NoMechanism; Status::ALL.len() + 8];
        let mut k = 0;
        while k < Status::ALL.len() {
            all[k] = Self::Pose(Status::ALL[k]);
            k += 1;
        }
        let programs = [
            ProgramOutcome::Passed,
            ProgramOutcome::Violations,
            ProgramOutcome::OutOfReach,
            ProgramOutcome::NoTrajectory,
            ProgramOutcome::NoMotion,
            ProgramOutcome::InvalidProgram,
            ProgramOutcome::InvalidCell,
        ];
        let mut k = 0;
        while k < programs.len() {
            all[Status::ALL.len() + 1 + k] = Self::Program(programs[k]);
            k += 1;
        }
        all
    };

    /// Its index in [`Outcome::ALL`].
    #[must_use]
    pub fn index(self) -> usize {
        match self {
            Self::Pose(status) => status as usize,
            Self::NoMechanism => Status::ALL.len(),
            Self::Program(program) => Status::ALL.len() + 1 + program as usize,
        }
    }

    /// Whether the sample has an answer: a pose, or a program that passed its check.
    #[must_use]
    pub fn is_solved(self) -> bool {
        matches!(self, Self::Pose(Status::Solved) | Self::Program(ProgramOutcome::Passed))
    }

    /// The outcome in words, as shown to users.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pose(status) => status.name(),
            Self::NoMechanism => "dimensions that make no mechanism",
            Self::Program(ProgramOutcome::Passed) => "passed",
            Self::Program(ProgramOutcome::Violations) => "violations",
            Self::Program(ProgramOutcome::OutOfReach) => "out of reach",
            Self::Program(ProgramOutcome::NoTrajectory) => "no trajectory",
            Self::Program(ProgramOutcome::NoMotion) => "no motion",
            Self::Program(ProgramOutcome::InvalidProgram) => "invalid program",
            Self::Program(ProgramOutcome::InvalidCell) => "invalid cell",
        }
    }
}

/// A limit that samples can exceed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleLimit {
    /// The lengths of the rods of a three-rod robot.
    Rods,
    /// The tilt of a three-rod robot.
    Tilt,
    /// The limits and clearances of the joints of a mechanism.
    Joints,
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
    /// Outcome of each sample, for each of [`Study::solved_for`](super::Study::solved_for).
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outcomes_are_counted_by_their_index_and_differ_in_name() {
        for (index, outcome) in Outcome::ALL.into_iter().enumerate() {
            assert_eq!(outcome.index(), index, "{outcome:?}");
            assert!(Outcome::ALL[..index].iter().all(|other| other.name() != outcome.name()));
        }
    }
}
