//! A drawn element with its depth.

use nalgebra::Vector3;

/// A drawn element of the picture.
pub(super) struct Item {
    /// Depth: larger is nearer to the eye.
    pub(super) depth: f64,
    /// Points that decide whether it is in front of or behind a plate.
    pub(super) points: Vec<Vector3<f64>>,
    /// Its SVG elements.
    pub(super) drawn: String,
}
