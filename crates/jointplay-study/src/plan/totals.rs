//! Totals of columns that are accumulated chunk by chunk.

use super::block::{Block, Outcome};
use super::moments::Moments;
use super::study::Study;

/// Number of samples by outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Outcomes {
    /// In the order of [`Outcome::ALL`].
    pub counts: [u64; Outcome::ALL.len()],
}

impl Outcomes {
    fn add(&mut self, more: &Self) {
        for (sum, more) in self.counts.iter_mut().zip(more.counts) {
            *sum += more;
        }
    }

    fn count(&mut self, outcome: Outcome) {
        self.counts[outcome.index()] += 1;
    }

    fn all(&self) -> impl Iterator<Item = (Outcome, u64)> {
        Outcome::ALL.into_iter().zip(self.counts)
    }

    /// How many have an answer.
    #[must_use]
    pub fn solved(&self) -> u64 {
        self.all().filter(|(outcome, _)| outcome.is_solved()).map(|(_, count)| count).sum()
    }

    /// How many have none.
    #[must_use]
    pub fn failed(&self) -> u64 {
        self.counts.iter().sum::<u64>() - self.solved()
    }

    /// Why those failed that did, and how many of each.
    pub fn reasons(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let failed = |(outcome, count): &(Outcome, u64)| !outcome.is_solved() && *count > 0;
        self.all().filter(failed).map(|(outcome, count)| (outcome.name(), count))
    }
}

/// Samples summed up.
///
/// Totals of a study are those of its chunks, added in order: rounding then does not depend on where the chunks were computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Totals {
    /// How many samples.
    pub samples: u64,
    /// Of each column.
    pub columns: Vec<Moments>,
    /// Of each of [`Study::solved_for`].
    pub outcomes: Vec<Outcomes>,
    /// Samples with a rod beyond its limits.
    pub beyond_rods: u64,
    /// Samples that are commanded beyond the limit of the tilt.
    pub beyond_tilt: u64,
    /// Samples with a joint of a mechanism beyond its limits or clearance.
    pub beyond_joints: u64,
}

impl Totals {
    /// Totals of a study before its first sample.
    #[must_use]
    pub fn for_study(study: &dyn Study) -> Self {
        Self::new(study.columns(), study.solved_for().len())
    }

    /// Of no samples yet, with so many columns and outcomes.
    #[must_use]
    pub fn new(columns: usize, models: usize) -> Self {
        Self {
            samples: 0,
            columns: vec![Moments::default(); columns],
            outcomes: vec![Outcomes::default(); models],
            beyond_rods: 0,
            beyond_tilt: 0,
            beyond_joints: 0,
        }
    }

    /// Of a chunk.
    #[must_use]
    pub fn of_chunk(blocks: &[Block]) -> Self {
        let (columns, models) =
            blocks.first().map_or((0, 0), |block| (block.columns.len(), block.outcomes.len()));
        let mut totals = Self::new(columns, models);
        blocks.iter().for_each(|block| totals.add_block(block));
        totals
    }

    /// Adds the totals of the chunk that follows.
    pub fn add(&mut self, chunk: &Self) {
        self.samples += chunk.samples;
        for (sum, more) in self.columns.iter_mut().zip(&chunk.columns) {
            sum.add(more);
        }
        for (sum, more) in self.outcomes.iter_mut().zip(&chunk.outcomes) {
            sum.add(more);
        }
        self.beyond_rods += chunk.beyond_rods;
        self.beyond_tilt += chunk.beyond_tilt;
        self.beyond_joints += chunk.beyond_joints;
    }

    fn add_block(&mut self, block: &Block) {
        self.samples += block.samples.len() as u64;
        for (sum, more) in self.columns.iter_mut().zip(&block.moments) {
            sum.add(more);
        }
        for (tally, outcomes) in self.outcomes.iter_mut().zip(&block.outcomes) {
            outcomes.iter().for_each(|&outcome| tally.count(outcome));
        }
        self.beyond_rods += block.beyond_rods;
        self.beyond_tilt += block.beyond_tilt;
        self.beyond_joints += block.beyond_joints;
    }
}
