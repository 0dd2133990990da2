//! Sampling of durations at a constant rate.

/// Share of an interval that is not sampled by itself: round-off of durations and rates adds no sample.
const NEGLIGIBLE: f64 = 1e-3;

/// Number of intervals of a duration that is sampled at a constant rate.
///
/// ```text
///    n  =  ⌈t f − 0.001⌉        t: duration, f: rate
/// ```
///
/// The last interval may be shorter than the others; there is one sample more than intervals.
///
/// # Arguments
/// * `duration` – time from the first sample to the last (s)
/// * `rate` – number of samples a second (Hz)
///
/// # Numerics
/// A time within a thousandth of an interval of the end is the end.
/// The number saturates for durations that no computer can sample.
///
/// # Example
/// ```
/// use jointplay_core::sampling::intervals;
///
/// assert_eq!(intervals(0.1 + 0.2, 100.0), 30);
/// ```
#[must_use]
pub fn intervals(duration: f64, rate: f64) -> u64 {
    (duration * rate - NEGLIGIBLE).ceil().max(0.0) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(duration: f64, rate: f64, expected: u64) {
        assert_eq!(intervals(duration, rate), expected, "{duration} s at {rate} Hz");
    }

    #[test]
    fn round_off_adds_no_sample() {
        check(0.1 + 0.2, 100.0, 30);
        check(0.3, 100.0, 30);
        check(0.305, 100.0, 31);
        check(1.0, 0.3, 1);
        check(0.0, 100.0, 0);
        check(f64::INFINITY, 1.0, u64::MAX);
    }
}
