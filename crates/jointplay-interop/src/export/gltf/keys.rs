//! Keys of animations: the samples that a viewer needs to interpolate the others within a tolerance.

use nalgebra::{Quaternion, UnitQuaternion};

use super::numbers::single;

/// A value at a time, and its rate of change there.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Key<const N: usize> {
    pub(super) time: f32,
    pub(super) value: [f32; N],
    pub(super) rate: [f32; N],
}

/// Samples of a quantity, with its rates.
pub(super) struct Samples<'a, const N: usize> {
    pub(super) times: &'a [f64],
    pub(super) values: &'a [[f64; N]],
    pub(super) rates: &'a [[f64; N]],
}

/// The samples of a quantity that a viewer interpolates by cubics, so that every other sample is within a tolerance.
///
/// The tolerance limits the norm of the difference, with the rounding of the keys to single precision included where a sample is omitted.
/// A quantity at rest has one key.
pub(super) fn cubic<const N: usize>(samples: &Samples<'_, N>, tolerance: f64) -> Vec<Key<N>> {
    let mut all = distinct(samples.times);
    let rests = samples.values.windows(2).all(|pair| pair[0] == pair[1])
        && samples.rates.iter().flatten().all(|&rate| rate == 0.0);
    if rests {
        all.truncate(1);
    }
    let key = |k: usize| {
        let at = all[k];
        let (value, rate) = (&samples.values[at], &samples.rates[at]);
        let time = single(samples.times[at]);
        // The time is rounded; the value is the one at the rounded time.
        let late = f64::from(time) - samples.times[at];
        let value = std::array::from_fn(|i| single(value[i] + late * rate[i]));
        Key { time, value, rate: rate.map(single) }
    };
    let keys: Vec<Key<N>> = (0..all.len()).map(key).collect();
    let fits = |from: usize, to: usize| {
        (from + 1..to).all(|k| {
            let at = all[k];
            let found = hermite(&keys[from], &keys[to], samples.times[at]);
            distance(&found, &samples.values[at]) <= tolerance
        })
    };
    thinned(keys.len(), fits).into_iter().map(|k| keys[k]).collect()
}

/// The places that a viewer interpolates by straight lines, so that every other one is within a tolerance (m).
pub(super) fn lines(times: &[f64], places: &[[f64; 3]], tolerance: f64) -> Vec<Key<3>> {
    let keys = plain(times, places);
    let fits = |from: usize, to: usize| {
        let (a, b) = (keys[from].value.map(f64::from), keys[to].value.map(f64::from));
        (from + 1..to).all(|k| {
            let s = share(&keys[from], &keys[to], times[k]);
            let found = std::array::from_fn(|i| a[i] + s * (b[i] - a[i]));
            distance(&found, &places[k]) <= tolerance
        })
    };
    thinned(keys.len(), fits).into_iter().map(|k| keys[k]).collect()
}

/// The unit quaternions that a viewer interpolates along great circles, so that every other one is within a tolerance (rad).
pub(super) fn arcs(times: &[f64], turns: &[[f64; 4]], tolerance: f64) -> Vec<Key<4>> {
    let keys = plain(times, turns);
    let unit = |[x, y, z, w]: [f64; 4]| UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    let fits = |from: usize, to: usize| {
        let [a, b] = [from, to].map(|k| unit(keys[k].value.map(f64::from)));
        (from + 1..to).all(|k| {
            let s = share(&keys[from], &keys[to], times[k]);
            // Half a turn between two keys has no shortest arc.
            let Some(found) = a.try_slerp(&b, s, 1e-9) else { return false };
            found.angle_to(&unit(turns[k])) <= tolerance
        })
    };
    thinned(keys.len(), fits).into_iter().map(|k| keys[k]).collect()
}

fn plain<const N: usize>(times: &[f64], values: &[[f64; N]]) -> Vec<Key<N>> {
    let keys = times.iter().zip(values);
    keys.map(|(&time, value)| Key { time: single(time), value: value.map(single), rate: [0.0; N] })
        .collect()
}

/// Indices of times that differ in single precision, in which late times of a long motion may be equal.
fn distinct(times: &[f64]) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::with_capacity(times.len());
    for (k, &time) in times.iter().enumerate() {
        if kept.last().is_none_or(|&last| single(times[last]) < single(time)) {
            kept.push(k);
        }
    }
    kept
}

/// Indices of samples to keep: both ends, and those between which the others fit.
fn thinned(count: usize, fits: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let Some(last) = count.checked_sub(1) else { return Vec::new() };
    let (mut kept, mut from) = (vec![0], 0);
    while from < last {
        // The span is doubled while it fits, then bisected.
        let mut good = from + 1;
        let mut bad = last + 1;
        let mut span = 2;
        while good < last {
            let to = (from + span).min(last);
            if !fits(from, to) {
                bad = to;
                break;
            }
            (good, span) = (to, 2 * span);
        }
        while bad <= last && bad - good > 1 {
            let middle = good + (bad - good) / 2;
            if fits(from, middle) {
                good = middle;
            } else {
                bad = middle;
            }
        }
        kept.push(good);
        from = good;
    }
    kept
}

fn share<const N: usize>(from: &Key<N>, to: &Key<N>, time: f64) -> f64 {
    let [from, to] = [from, to].map(|key| f64::from(key.time));
    ((time - from) / (to - from)).clamp(0.0, 1.0)
}

/// The cubic between two keys.
fn hermite<const N: usize>(from: &Key<N>, to: &Key<N>, time: f64) -> [f64; N] {
    let (s, span) = (share(from, to, time), f64::from(to.time) - f64::from(from.time));
    let (s2, s3) = (s * s, s * s * s);
    std::array::from_fn(|i| {
        (2.0 * s3 - 3.0 * s2 + 1.0) * f64::from(from.value[i])
            + span * (s3 - 2.0 * s2 + s) * f64::from(from.rate[i])
            + (3.0 * s2 - 2.0 * s3) * f64::from(to.value[i])
            + span * (s3 - s2) * f64::from(to.rate[i])
    })
}

fn distance<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_need_their_ends_only_and_jumps_all_neighbours() {
        let times: Vec<f64> = (0..=100).map(|k| 0.01 * f64::from(k)).collect();
        let values: Vec<[f64; 1]> = times.iter().map(|t| [t * t * t]).collect();
        let rates: Vec<[f64; 1]> = times.iter().map(|t| [3.0 * t * t]).collect();
        let samples = Samples { times: &times, values: &values, rates: &rates };
        assert_eq!(cubic(&samples, 1e-6).len(), 2);
        let (still, zero) = (vec![[2.5]; times.len()], vec![[0.0]; times.len()]);
        let at_rest = Samples { times: &times, values: &still, rates: &zero };
        assert_eq!(cubic(&at_rest, 1e-6).len(), 1);
        let jump: Vec<[f64; 1]> =
            times.iter().map(|&t| [if t < 0.505 { 0.0 } else { 1.0 }]).collect();
        let keys = cubic(&Samples { times: &times, values: &jump, rates: &zero }, 1e-6);
        let at: Vec<f32> = keys.iter().map(|key| key.time).collect();
        assert_eq!(at, [0.0, 0.5, 0.51, 1.0]);
    }

    #[test]
    fn lines_and_arcs_stay_within_the_tolerance() {
        let times: Vec<f64> = (0..=360).map(|k| f64::from(k) / 60.0).collect();
        let places: Vec<[f64; 3]> = times.iter().map(|t| [t.cos(), t.sin(), 0.0]).collect();
        let turns: Vec<[f64; 4]> =
            times.iter().map(|t| [0.0, 0.0, (0.5 * t).sin(), (0.5 * t).cos()]).collect();
        let lines = lines(&times, &places, 1e-3);
        // A chord of a circle of radius 1 with this sagitta: √(8 · 10⁻³) rad.
        assert!((60..=80).contains(&lines.len()), "{}", lines.len());
        // A turn about one axis at a constant speed is one arc, but for half a turn and more.
        assert!(arcs(&times, &turns, 1e-6).len() <= 4);
        assert_eq!(arcs(&times[..2], &turns[..2], 1e-6).len(), 2);
        assert!(thinned(0, |_, _| true).is_empty());
        assert_eq!(thinned(1, |_, _| true), [0]);
        assert_eq!(thinned(5, |_, _| false), [0, 1, 2, 3, 4]);
    }
}
