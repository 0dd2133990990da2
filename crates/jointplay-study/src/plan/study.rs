//! The interface of all studies.

use super::block::{Block, Portions, SampleLimit};
use crate::Error;

/// A study: numbered samples that are computed in any order, each from the study and its number alone.
pub trait Study: Send + Sync {
    /// Number of samples.
    ///
    /// # Errors
    /// [`Error::NoValues`] where something varies over no values, [`Error::TooManySamples`].
    fn samples(&self) -> Result<u64, Error>;

    /// Seed of the random draws.
    fn seed(&self) -> u64;

    /// Number of columns of a block.
    fn columns(&self) -> usize;

    /// Names of what each sample is solved for, with one outcome each.
    fn solved_for(&self) -> Vec<String>;

    /// Limits that samples can exceed, counted in [`Totals`](super::Totals).
    fn limits(&self) -> &'static [SampleLimit];

    /// Whether samples have other bits on another kind of processor, see [`instruction_set`](jointplay_core::bulk::instruction_set).
    fn depends_on_processor(&self) -> bool;

    /// Computes some samples on one core; samples beyond limits are computed too, and counted.
    ///
    /// # Arguments
    /// * `samples` – their numbers, fastest where they ascend by one
    ///
    /// # Errors
    /// As [`Study::samples`]; [`Error::NoSuchSample`]; [`Error::Core`] for what concerns all samples alike.
    fn compute(&self, samples: &[u64]) -> Result<Block, Error>;

    /// How many samples are computed, handed on and looked at together.
    fn portions(&self) -> Portions;

    /// Number of chunks, the last of which may be shorter.
    ///
    /// # Errors
    /// As [`Study::samples`].
    fn chunks(&self) -> Result<u64, Error> {
        Ok(self.samples()?.div_ceil(self.portions().chunk))
    }

    /// Number of threads that the study keeps busy: one for each block of samples.
    ///
    /// # Errors
    /// As [`Study::samples`].
    fn most_threads(&self) -> Result<usize, Error> {
        let blocks = self.samples()?.div_ceil(self.portions().block as u64);
        let most = crate::parallel::MOST_THREADS;
        Ok(usize::try_from(blocks).map_or(most, |blocks| blocks.clamp(1, most)))
    }
}

/// Refuses samples that a study does not have.
///
/// # Errors
/// As [`Study::samples`]; [`Error::NoSuchSample`].
pub(super) fn check(study: &dyn Study, samples: &[u64]) -> Result<(), Error> {
    let count = study.samples()?;
    match samples.iter().find(|&&sample| sample >= count) {
        Some(&found) => Err(Error::NoSuchSample { found, count }),
        None => Ok(()),
    }
}
