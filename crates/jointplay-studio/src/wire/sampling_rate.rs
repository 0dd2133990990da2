//! Sampling rates of requests.

use crate::problem::Problem;

/// A sampling rate (Hz), checked against the greatest allowed one.
///
/// # Errors
/// If it is below 0.1 Hz or above `most`.
pub(super) fn sampling_rate(rate_hz: f64, most: f64) -> Result<f64, Problem> {
    if (0.1..=most).contains(&rate_hz) {
        return Ok(rate_hz);
    }
    let detail = format!("sampling rate must be within 0.1 to {most} Hz, got {rate_hz} Hz");
    Err(Problem::field("rate_hz", detail))
}
