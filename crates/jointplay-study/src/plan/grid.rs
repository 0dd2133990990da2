//! The samples of a study: every value of what is listed with every other, for each draw of what is random.

use super::block::{Block, Outcome};
use super::moments::Moments;
use super::random::Stream;
use super::variation::Variation;
use crate::Error;

/// Number of samples: the product of all values, times the draws.
///
/// # Errors
/// [`Error::NoValues`] for an empty list, [`Error::TooManySamples`].
pub(super) fn samples<'a>(
    varied: impl Iterator<Item = &'a Variation> + Clone,
    draws: u64,
) -> Result<u64, Error> {
    let grid = places(varied.clone())?;
    // As many as a signed number of 64 bits counts, which is what tables have.
    let samples = grid.and_then(|grid| grid.checked_mul(draws));
    let samples = samples.filter(|&samples| i64::try_from(samples).is_ok());
    samples.ok_or_else(|| Error::TooManySamples {
        values: varied.map(Variation::values).collect(),
        draws,
    })
}

/// Places of the grid; `None` for more than can be counted.
fn places<'a>(mut varied: impl Iterator<Item = &'a Variation>) -> Result<Option<u64>, Error> {
    varied.try_fold(Some(1_u64), |product, one| match one.values() {
        0 => Err(Error::NoValues),
        values => Ok(product.and_then(|product| product.checked_mul(values))),
    })
}

/// Gives the values of samples; the last quantity runs fastest.
pub(super) struct Grid<'a> {
    varied: Vec<(&'a Variation, Stream)>,
    places: u64,
}

impl<'a> Grid<'a> {
    /// Of quantities with the numbers of their random streams.
    ///
    /// # Errors
    /// As [`samples`].
    pub(super) fn new(
        varied: impl Iterator<Item = (&'a Variation, u64)> + Clone,
        draws: u64,
        seed: u64,
    ) -> Result<Self, Error> {
        samples(varied.clone().map(|(one, _)| one), draws)?;
        let places = varied.clone().map(|(one, _)| one.values()).product();
        let varied = varied.map(|(one, stream)| (one, Stream::new(seed, stream))).collect();
        Ok(Self { varied, places })
    }

    /// The draw of a sample.
    pub(super) fn draw(&self, sample: u64) -> u64 {
        sample / self.places
    }

    /// Computes the values of a sample, one for each quantity.
    pub(super) fn values(&mut self, sample: u64, values: &mut [f64]) {
        let (draw, mut place) = (sample / self.places, sample % self.places);
        for ((one, stream), value) in self.varied.iter_mut().zip(values).rev() {
            let count = one.values();
            *value = one.value(stream, place % count, draw);
            place /= count;
        }
    }

    /// Computes samples one after the other.
    ///
    /// # Arguments
    /// * `row` – computes a sample from its values into the row of its columns, which are NaN before: its outcome, and whether a joint of a mechanism is beyond its limits
    ///
    /// # Errors
    /// Those of `row`.
    pub(super) fn compute(
        mut self,
        samples: &[u64],
        columns: usize,
        mut row: impl FnMut(&[f64], &mut [f64]) -> Result<(Outcome, bool), Error>,
    ) -> Result<Block, Error> {
        let mut block = Block {
            samples: samples.to_vec(),
            draws: Vec::with_capacity(samples.len()),
            columns: vec![Vec::with_capacity(samples.len()); columns],
            outcomes: vec![Vec::with_capacity(samples.len())],
            moments: Vec::new(),
            beyond_rods: 0,
            beyond_tilt: 0,
            beyond_joints: 0,
        };
        let mut values = vec![0.0; self.varied.len()];
        let mut entries = vec![f64::NAN; columns];
        for &sample in samples {
            self.values(sample, &mut values);
            block.draws.push(self.draw(sample));
            entries.fill(f64::NAN);
            let (outcome, is_beyond) = row(&values, &mut entries)?;
            block.outcomes[0].push(outcome);
            block.beyond_joints += u64::from(is_beyond);
            for (column, value) in block.columns.iter_mut().zip(&entries) {
                column.push(*value);
            }
        }
        block.moments = block.columns.iter().map(|column| Moments::of(column)).collect();
        Ok(block)
    }
}
