//! Ticks at 1, 2 or 5 times a power of ten, written with as many digits as distinguish them.

use crate::decimal::{order, plain, power_of_ten, short, value};
use crate::tick::{Tick, Ticks};

/// Longest label in digits before common factors and offsets are taken out.
const MOST_DIGITS: i32 = 7;

/// Ticks from `lo` to `hi` (unit of the axis), at least `spacing` (a fraction of hi − lo) apart.
pub(crate) fn linear_ticks(lo: f64, hi: f64, spacing: f64) -> Ticks {
    let (digit, exponent) = step_at_least((hi - lo) * spacing);
    let step = value(digit, exponent);
    // Ends that miss a tick by round-off, which is large where the offset is, count as ticks.
    let first = (lo / step - 1e-4).ceil() as i64;
    let last = (hi / step + 1e-4).floor() as i64;
    let counts: Vec<i64> = (first..=last).map(|k| k * digit).collect();
    let (labels, note) = labels(&counts, exponent);
    let major = counts.iter().zip(labels);
    Ticks {
        major: major.map(|(&n, label)| Tick { value: value(n, exponent), label }).collect(),
        minor: Vec::new(),
        note,
    }
}

/// The least step digit · 10^exponent with digit 1, 2 or 5 that is not below `least` (unit of the axis).
fn step_at_least(least: f64) -> (i64, i32) {
    let exponent = order(least);
    let found = [1, 2, 5].into_iter().find(|&digit| value(digit, exponent) >= least * (1.0 - 1e-9));
    found.map_or((1, exponent + 1), |digit| (digit, exponent))
}

/// Labels at n · 10^exponent for each n, and their common factor or offset.
fn labels(counts: &[i64], exponent: i32) -> (Vec<String>, String) {
    let Some(greatest) = counts.iter().map(|n| n.unsigned_abs()).max() else {
        return (Vec::new(), String::new());
    };
    let write = |shift: i32| counts.iter().map(|&n| plain(n, exponent - shift)).collect::<Vec<_>>();
    if greatest == 0 {
        return (write(exponent), String::new());
    }
    let top = order(greatest as f64) + exponent;

    // 1. Plain digits, where they are few.
    let digits = top.max(0) + 1 + (-exponent).max(0);
    if (-3..6).contains(&top) && digits <= MOST_DIGITS {
        return (write(0), String::new());
    }
    // 2. A power of a thousand taken out.
    let power = 3 * top.div_euclid(3);
    if top - power + 1 + (power - exponent).max(0) < MOST_DIGITS {
        return (write(power), format!("×{}", power_of_ten(power)));
    }
    // 3. What all ticks have in common taken out, then as before.
    let (least, most) = (counts[0], counts[counts.len() - 1]);
    let unit = 10i64.pow(order((most - least).max(1) as f64) as u32 + 1);
    let middle = least + (most - least) / 2;
    let common = (middle as f64 / unit as f64).round() as i64 * unit;
    if common == 0 {
        return (write(power), format!("×{}", power_of_ten(power)));
    }
    let rest: Vec<i64> = counts.iter().map(|n| n - common).collect();
    let (texts, factor) = labels(&rest, exponent);
    let sign = if common < 0 { '−' } else { '+' };
    let offset = format!("{sign} {}", short(common.abs(), exponent));
    let note = if factor.is_empty() { offset } else { format!("{factor} {offset}") };
    (texts, note)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(lo: f64, hi: f64, first: &str, last: &str, note: &str) {
        let ticks = linear_ticks(lo, hi, 0.2);
        let texts: Vec<&str> = ticks.major.iter().map(|tick| tick.label.as_str()).collect();
        assert_eq!((texts[0], texts[texts.len() - 1]), (first, last), "{texts:?}");
        assert_eq!(ticks.note, note);
        for pair in ticks.major.windows(2) {
            assert!(pair[0].value < pair[1].value && pair[0].label != pair[1].label, "{texts:?}");
        }
    }

    #[test]
    fn everyday() {
        check(0.0, 776.0, "0", "600", "");
        check(-1.0, 1.0, "−1.0", "1.0", "");
        check(0.0, 1.0, "0.0", "1.0", "");
    }

    #[test]
    fn micrometres_about_a_length_in_millimetres() {
        check(93.2179, 93.2201, "93.2180", "93.2200", "");
    }

    #[test]
    fn small_and_large() {
        check(-5e-4, 5e-4, "−400", "400", "×10⁻⁶");
        check(0.0, 0.0021, "0.0000", "0.0020", "");
        check(0.0, 4.2e9, "0", "4", "×10⁹");
        check(3e-15, 9e-15, "4", "8", "×10⁻¹⁵");
    }

    #[test]
    fn nanometres_about_a_length_in_millimetres() {
        check(93.218, 93.218 + 1e-8, "0", "10", "×10⁻⁹ + 93.218");
        check(-93.218 - 1e-8, -93.218, "−10", "0", "×10⁻⁹ − 93.218");
    }
}
