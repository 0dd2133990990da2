//! Times since the start of a window.

use crate::export::scene::rounded;

/// Times of violations are told to this fraction of a second.
const TIMES: f64 = 1e6;

/// A time since another; the same for the same violation wherever it is in a program (s).
pub(super) fn since(time: f64, start: f64) -> f64 {
    rounded(time - start, TIMES)
}
