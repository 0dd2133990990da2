//! The samples of a study: every value of what is listed with every other, for each draw of what is random.

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
            *value = one.at(stream, place % count, draw);
            place /= count;
        }
    }
}
