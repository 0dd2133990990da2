//! Times since the start of a window.

use crate::export::scene::rounded;

/// Fraction of a second to which times of violations are rounded.
const TIMES: f64 = 1e6;

/// A time relative to another, rounded so that equal violations anywhere in a program have equal times (s).
pub(super) fn since(time: f64, start: f64) -> f64 {
    rounded(time - start, TIMES)
}
