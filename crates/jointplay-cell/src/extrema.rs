//! Maxima and minima in one instruction each: [`f64::max`] takes several to pass over NaN on either side.

/// The larger of two values; NaN of the first is passed over.
#[inline(always)]
pub(crate) fn larger(value: f64, other: f64) -> f64 {
    if value > other { value } else { other }
}

/// The smaller of two values; NaN of the first is passed over.
#[inline(always)]
pub(crate) fn smaller(value: f64, other: f64) -> f64 {
    if value < other { value } else { other }
}

/// Raises a maximum to a value; NaN is passed over.
#[inline(always)]
pub(crate) fn raise(most: &mut f64, value: f64) {
    *most = larger(value, *most);
}
