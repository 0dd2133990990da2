//! Rotations about the z axis.

use nalgebra::{Matrix3, Rotation3};

/// Rotation about the z axis (rad).
pub(super) fn rotation_about_z(angle: f64) -> Rotation3<f64> {
    let (sin, cos) = angle.sin_cos();
    Rotation3::from_matrix_unchecked(Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0))
}
