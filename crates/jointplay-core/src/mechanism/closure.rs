//! The result of closing loops.

use nalgebra::DVector;

use crate::constraint::CLOSURE_TOLERANCE;

/// A configuration with its loops closed, or as nearly closed as possible.
#[derive(Debug, Clone, PartialEq)]
pub struct Closure {
    /// (f + M) coordinates of joints, then virtual joints (m, rad).
    pub coordinates: DVector<f64>,
    /// Largest mismatch, in radians and characteristic lengths.
    pub residual: f64,
    /// Corrections done.
    pub iterations: usize,
}

impl Closure {
    /// Whether the residual is that of closed loops.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.residual <= CLOSURE_TOLERANCE
    }
}
