//! Ticks of a logarithmic axis: powers of ten, or finer where fewer than two are visible.

use crate::decimal::{order, plain, power_of_ten, value};
use crate::linear_ticks::linear_ticks;
use crate::tick::{Tick, Ticks};

/// Decades from one label to the next.
const STRIDES: [i32; 9] = [1, 2, 3, 5, 10, 20, 50, 100, 200];

/// Ticks from `lo` to `hi` (unit of the axis), at least `spacing` (a fraction of the axis) apart.
pub(crate) fn log_ticks(lo: f64, hi: f64, spacing: f64) -> Ticks {
    let (first, last) = decades(lo, hi);
    let length = hi.log10() - lo.log10();
    // Where powers of ten are few, 2 and 5 are written too if there is room, as 1 and 2 are the closest.
    if last <= first || (last == first + 1 && 2f64.log10() >= spacing * length) {
        return within_decades(lo, hi, spacing);
    }
    let least = spacing * length * (1.0 - 1e-9);
    let wide_enough = STRIDES.iter().position(|stride| f64::from(*stride) >= least);
    let fitting = &STRIDES[..=wide_enough.unwrap_or(STRIDES.len() - 1)];
    // Never so wide that fewer than two labels are left.
    let count = |stride: i32| last.div_euclid(stride) - (first - 1).div_euclid(stride);
    let stride = fitting.iter().rev().copied().find(|stride| count(*stride) >= 2).unwrap_or(1);
    let labelled = |decade: &i32| decade.rem_euclid(stride) == 0;
    let major = (first..=last).filter(labelled);
    let minor: Vec<f64> = match stride {
        1 => {
            let finer = (first - 1..=last).flat_map(|k| (2..10).map(move |n| value(n, k)));
            finer.filter(|tick| (lo..=hi).contains(tick)).collect()
        }
        2..=5 => (first..=last).filter(|decade| !labelled(decade)).map(|k| value(1, k)).collect(),
        _ => Vec::new(),
    };
    let tick = |decade| Tick { value: value(1, decade), label: power_of_ten(decade) };
    Ticks { major: major.map(tick).collect(), minor, note: String::new() }
}

/// The first and last power of ten from `lo` to `hi`, ends included up to round-off; last < first if there is none.
fn decades(lo: f64, hi: f64) -> (i32, i32) {
    let below = order(lo * (1.0 - 1e-9));
    (below + 1, order((hi * (1.0 + 1e-9)).min(f64::MAX)))
}

/// Ticks at 1, 2 and 5 times a power of ten, or at equal steps of value if fewer than two of those are visible.
fn within_decades(lo: f64, hi: f64, spacing: f64) -> Ticks {
    let (first, last) = (order(lo), order(hi));
    let write = |n: i64, decade: i32| match decade {
        -3..=4 => plain(n, decade),
        _ if n == 1 => power_of_ten(decade),
        _ => format!("{n}×{}", power_of_ten(decade)),
    };
    let candidates = (first..=last).flat_map(|decade| [1, 2, 5].map(|n| (n, decade)));
    let ticks =
        candidates.map(|(n, decade)| Tick { value: value(n, decade), label: write(n, decade) });
    let major: Vec<Tick> = ticks.filter(|tick| (lo..=hi).contains(&tick.value)).collect();
    if major.len() < 2 {
        return linear_ticks(lo, hi, spacing);
    }
    let finer = (first..=last).flat_map(|k| [3, 4, 6, 7, 8, 9].map(|n| value(n, k)));
    let minor = finer.filter(|tick| (lo..=hi).contains(tick)).collect();
    Ticks { major, minor, note: String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(lo: f64, hi: f64, expected: &[&str]) {
        let ticks = log_ticks(lo, hi, 0.2);
        let texts: Vec<&str> = ticks.major.iter().map(|tick| tick.label.as_str()).collect();
        assert_eq!(texts, expected);
        assert!(ticks.major.iter().all(|tick| (lo * 0.999..=hi * 1.001).contains(&tick.value)));
    }

    #[test]
    fn powers() {
        check(1e-15, 1e-3, &["10⁻¹⁵", "10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³"]);
        check(0.5, 200.0, &["10⁰", "10¹", "10²"]);
        check(1e-150, 1e150, &["10⁻¹⁰⁰", "10⁰", "10¹⁰⁰"]);
        check(3e-17, 2e-3, &["10⁻¹⁵", "10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³"]);
        check(1e-300, 1e300, &["10⁻²⁰⁰", "10⁰", "10²⁰⁰"]);
        check(0.05, 50.0, &["10⁻¹", "10⁰", "10¹"]);
    }

    #[test]
    fn narrow() {
        check(1.5, 8.0, &["2", "5"]);
        check(0.9, 11.0, &["1", "2", "5", "10"]);
        check(1.5e-7, 8e-7, &["2×10⁻⁷", "5×10⁻⁷"]);
        check(3.1, 3.9, &["3.2", "3.4", "3.6", "3.8"]);
    }
}
