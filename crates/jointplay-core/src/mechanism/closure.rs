//! The result of closing loops.

use nalgebra::DVector;

use crate::constraint::CLOSURE_TOLERANCE;

/// Assembled configurations nearer than this, in radians and characteristic lengths, are one branch.
pub(super) const SAME_BRANCH: f64 = 1e-4;
/// Largest displacement of a slide in the other starts [characteristic lengths].
pub(super) const START_RANGE: f64 = 2.0;

/// A configuration with its loops closed, or as nearly closed as possible.
#[derive(Debug, Clone, PartialEq)]
pub struct Closure {
    /// (f + M) coordinates of joints, then virtual joints (m, rad).
    pub coordinates: DVector<f64>,
    /// Largest mismatch, in radians and characteristic lengths.
    pub residual: f64,
    /// Corrections done.
    pub iterations: usize,
    /// Whether corrections from the guess did not close the loops within the limits, so that the configuration is the nearest one that a search found.
    pub is_searched: bool,
}

impl Closure {
    /// Whether the residual is that of closed loops.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.residual <= CLOSURE_TOLERANCE
    }
}
