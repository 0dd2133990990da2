//! What was found of the last plan, so that a change costs what it changes.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::cell::Cell;
use crate::check::{CheckOptions, Checks, Report};
use crate::motion::{Motion, MotionError, MotionOptions, Ways};
use crate::program::Step;

/// Motions and checks of the last plan, move by move.
///
/// A move is timed and checked anew where anything that it depends on has other bits than in the last plan: its ends, limits, what is carried, and what stands within reach of its way.
/// What comes out is the same as without a memory, to the bit: [`timed`](crate::motion::timed) and [`check`](crate::check::check) are these functions of an empty one.
///
/// It holds what the last plan came to, and no more.
#[derive(Default)]
pub struct Memory {
    ways: Ways,
    checks: Checks,
}

/// How many moves of the last plan were made anew, and how many were known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Reuse {
    /// Known from the plan before.
    pub known: usize,
    /// The same as an earlier one of this plan.
    pub repeated: usize,
    /// Made anew.
    pub anew: usize,
}

impl Memory {
    /// As [`timed`](crate::motion::timed).
    ///
    /// # Errors
    /// As [`timed`](crate::motion::timed).
    pub fn timed(
        &mut self,
        cell: &Cell,
        steps: Vec<Step>,
        options: &MotionOptions,
    ) -> Result<Motion, MotionError> {
        self.ways.timed(cell, steps, options)
    }

    /// As [`check`](crate::check::check).
    #[must_use]
    pub fn check(&mut self, cell: &Cell, motion: &Motion, options: &CheckOptions) -> Report {
        self.checks.check(cell, motion, options)
    }

    /// Of the ways of the axes in the last motion.
    #[must_use]
    pub fn reuse_of_ways(&self) -> Reuse {
        self.ways.reuse()
    }

    /// Of the moves by themselves in the last check: axes, tilt, play and slip.
    #[must_use]
    pub fn reuse_of_moves(&self) -> Reuse {
        self.checks.reuse_of_moves()
    }

    /// Of the moves among all bodies in the last check.
    #[must_use]
    pub fn reuse_of_distances(&self) -> Reuse {
        self.checks.reuse_of_distances()
    }
}

/// Inputs, bit by bit.
pub(crate) type Key = Vec<u64>;

/// Adds numbers to a key.
pub(crate) fn extend(key: &mut Key, numbers: &[f64]) {
    key.extend(numbers.iter().map(|number| number.to_bits()));
}

/// Results by their inputs: those of the last round, and those of this one.
pub(crate) struct Kept<T> {
    /// Inputs that all results share.
    shared: String,
    last: BTreeMap<Key, Arc<T>>,
    now: BTreeMap<Key, Arc<T>>,
    reuse: Reuse,
}

impl<T> Default for Kept<T> {
    fn default() -> Self {
        let (last, now) = (BTreeMap::new(), BTreeMap::new());
        Self { shared: String::new(), last, now, reuse: Reuse::default() }
    }
}

impl<T> Kept<T> {
    /// A round begins; nothing is known where the shared inputs are others.
    pub(crate) fn begin(&mut self, shared: &str) {
        self.last = std::mem::take(&mut self.now);
        self.reuse = Reuse::default();
        if self.shared != shared {
            self.last.clear();
            shared.clone_into(&mut self.shared);
        }
    }

    /// The result for a key, made where it is not known.
    pub(crate) fn get<E>(
        &mut self,
        key: Key,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<Arc<T>, E> {
        if let Some(known) = self.now.get(&key) {
            self.reuse.repeated += 1;
            return Ok(Arc::clone(known));
        }
        let found = match self.last.remove(&key) {
            Some(known) => {
                self.reuse.known += 1;
                known
            }
            None => {
                self.reuse.anew += 1;
                Arc::new(make()?)
            }
        };
        self.now.insert(key, Arc::clone(&found));
        Ok(found)
    }

    /// A round ends: what it did not ask for is forgotten.
    pub(crate) fn end(&mut self) {
        self.last.clear();
    }

    pub(crate) fn reuse(&self) -> Reuse {
        self.reuse
    }
}
