//! Two meanings of the height of a tilted platform.

/// Height at which the platform plane crosses the base axis through O_b (m).
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct AxisHeight(pub f64);

/// Height of the platform's own origin O_p, its e_b3 coordinate (m).
///
/// Differs from the axis height by the centre shift times the slope, and so depends on the virtualization.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct CenterHeight(pub f64);
