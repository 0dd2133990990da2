//! Motion of a frame.

use nalgebra::Vector3;

/// Angular and linear part of the motion of a frame, in the base frame, the linear one of its origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameTwist {
    /// Angular velocity (rad/s), angular acceleration (rad/s²).
    pub angular: Vector3<f64>,
    /// Velocity (m/s) or acceleration (m/s²) of the origin.
    pub linear: Vector3<f64>,
}
