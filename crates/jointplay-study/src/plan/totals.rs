//! Columns summed up while they go by.

use jointplay_core::bulk::Status;

use super::{Block, Outcome};

/// Count, extrema, mean and standard deviation of the numbers of a column; NaN is left out.
///
/// ```text
///    m = m_a + (m_b − m_a) n_b / n        S = S_a + S_b + (m_b − m_a)² n_a n_b / n
/// ```
/// # Source
/// [Chan]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// How many numbers.
    pub count: u64,
    /// Least, ∞ without numbers.
    pub min: f64,
    /// Greatest, −∞ without numbers.
    pub max: f64,
    /// Mean m.
    pub mean: f64,
    /// Sum S of the squared distances from the mean.
    pub squares: f64,
}

impl Default for Moments {
    fn default() -> Self {
        let (min, max) = (f64::INFINITY, f64::NEG_INFINITY);
        Self { count: 0, min, max, mean: 0.0, squares: 0.0 }
    }
}

impl Moments {
    /// Of a column.
    #[must_use]
    pub fn of(column: &[f64]) -> Self {
        let numbers = || column.iter().copied().filter(|value| !value.is_nan());
        let count = numbers().count() as u64;
        if count == 0 {
            return Self::default();
        }
        let min = numbers().fold(f64::INFINITY, f64::min);
        let max = numbers().fold(f64::NEG_INFINITY, f64::max);
        // From a number among them, so that a mean of equal numbers is that number.
        let start = numbers().next().unwrap_or_default();
        let mean = start + numbers().map(|value| value - start).sum::<f64>() / count as f64;
        let squares = numbers().map(|value| (value - mean).powi(2)).sum();
        Self { count, min, max, mean, squares }
    }

    /// Of two columns, this one first.
    pub fn add(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *other;
            return;
        }
        let (before, more) = (self.count as f64, other.count as f64);
        let (sum, apart) = (before + more, other.mean - self.mean);
        self.count += other.count;
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.mean += apart * (more / sum);
        self.squares += other.squares + apart * apart * (before * more / sum);
    }

    /// Standard deviation of the numbers as a sample, √(S / (n − 1)); `None` for fewer than two.
    #[must_use]
    pub fn deviation(&self) -> Option<f64> {
        (self.count > 1).then(|| (self.squares / (self.count - 1) as f64).sqrt())
    }
}

/// How many samples ended in which way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Outcomes {
    /// By [`Status`], in the order of its numbers.
    pub poses: [u64; Status::ALL.len()],
    /// Of robots that cannot be.
    pub no_robot: u64,
}

impl Outcomes {
    fn count(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Pose(status) => self.poses[status as usize] += 1,
            Outcome::NoRobot => self.no_robot += 1,
        }
    }

    /// How many have an answer.
    #[must_use]
    pub fn solved(&self) -> u64 {
        self.poses[Status::Solved as usize]
    }

    /// How many have none.
    #[must_use]
    pub fn failed(&self) -> u64 {
        self.poses.iter().sum::<u64>() - self.solved() + self.no_robot
    }

    /// Why those failed that did, and how many of each.
    pub fn reasons(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let poses = Status::ALL.map(|status| (Outcome::Pose(status), self.poses[status as usize]));
        let all = poses.into_iter().skip(1).chain([(Outcome::NoRobot, self.no_robot)]);
        all.filter(|(_, count)| *count > 0).map(|(outcome, count)| (outcome.name(), count))
    }
}

/// Samples summed up.
#[derive(Debug, Clone, PartialEq)]
pub struct Totals {
    /// How many samples.
    pub samples: u64,
    /// Of each column.
    pub columns: Vec<Moments>,
    /// Of each virtualization.
    pub outcomes: Vec<Outcomes>,
    /// Samples with a rod beyond its limits.
    pub beyond_rods: u64,
    /// Samples that are commanded beyond the limit of the tilt.
    pub beyond_tilt: u64,
}

impl Totals {
    /// Of no samples yet.
    #[must_use]
    pub fn new(columns: usize, models: usize) -> Self {
        Self {
            samples: 0,
            columns: vec![Moments::default(); columns],
            outcomes: vec![Outcomes::default(); models],
            beyond_rods: 0,
            beyond_tilt: 0,
        }
    }

    /// Adds the samples that follow.
    pub fn add(&mut self, block: &Block) {
        self.samples += block.samples.len() as u64;
        for (sum, more) in self.columns.iter_mut().zip(&block.moments) {
            sum.add(more);
        }
        for (tally, outcomes) in self.outcomes.iter_mut().zip(&block.outcomes) {
            outcomes.iter().for_each(|&outcome| tally.count(outcome));
        }
        self.beyond_rods += block.beyond_rods;
        self.beyond_tilt += block.beyond_tilt;
    }
}
