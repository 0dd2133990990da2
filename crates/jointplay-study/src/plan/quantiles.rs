//! Quantiles of columns that are too long to keep.

use rayon::prelude::*;

use super::random::Stream;
use super::study::Study;
use crate::Error;

/// The stream of random numbers that chooses the samples; far from those of the quantities.
const STREAM: u64 = u64::MAX;

/// Quantiles of every column of a study, by linear interpolation between the numbers in order; `None` for a column without numbers.
///
/// Exact for up to n = [`Portions::quantiles`](super::Portions) samples.
/// Of more, n are computed again, one drawn from each of as many equal stretches of the study: then the share of samples below a quantile q is q with a standard error of at most √(q (1 − q) / n).
///
/// # Arguments
/// * `shares` – shares q of the samples, from 0 to 1
///
/// # Errors
/// As [`Study::compute`].
///
/// # Source
/// \[HyndmanFan\], definition 7
pub fn quantiles(study: &dyn Study, shares: &[f64]) -> Result<Vec<Vec<Option<f64>>>, Error> {
    let samples = chosen(study)?;
    let blocks: Vec<_> = samples
        .par_chunks(study.portions().block)
        .map(|samples| Ok(study.compute(samples)?.columns))
        .collect::<Result<_, Error>>()?;
    let column = |c: usize| {
        let mut numbers: Vec<f64> =
            blocks.iter().flat_map(|block| &block[c]).copied().filter(|v| !v.is_nan()).collect();
        numbers.sort_by(f64::total_cmp);
        shares.iter().map(|&share| interpolated(&numbers, share)).collect()
    };
    Ok((0..study.columns()).into_par_iter().map(column).collect())
}

/// All samples of a study, or one of each of equal stretches; in ascending order.
pub(super) fn chosen(study: &dyn Study) -> Result<Vec<u64>, Error> {
    let (count, most) = (study.samples()?, study.portions().quantiles);
    if count <= most {
        return Ok((0..count).collect());
    }
    let mut stream = Stream::new(study.seed(), STREAM);
    let edge = |stretch: u64| {
        let edge = u128::from(stretch) * u128::from(count) / u128::from(most);
        u64::try_from(edge).expect("at most the number of samples")
    };
    Ok((0..most)
        .map(|stretch| {
            let (from, to) = (edge(stretch), edge(stretch + 1));
            // The product rounds up to the whole width only for widths beyond 2⁵³.
            let within = (stream.uniform(stretch) * (to - from) as f64) as u64;
            from + within.min(to - from - 1)
        })
        .collect())
}

fn interpolated(sorted: &[f64], share: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let place = share * last as f64;
    let below = place.floor() as usize;
    let (low, high) = (sorted[below], sorted[(below + 1).min(last)]);
    Some(if low == high { low } else { low + (high - low) * place.fract() })
}
