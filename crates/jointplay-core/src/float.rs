//! Functions of numbers that the core library of Rust lacks.

/// Square root, rounded correctly with a standard library and without.
#[inline(always)]
pub(crate) fn sqrt(value: f64) -> f64 {
    #[cfg(feature = "std")]
    return value.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrt(value);
}
