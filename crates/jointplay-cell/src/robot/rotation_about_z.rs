//! Rotations about the z axis.

use jointplay_core::spatial::Pose;
use nalgebra::{Matrix3, Rotation3};

/// Rotation about the z axis (rad).
pub(super) fn rotation_about_z(angle: f64) -> Rotation3<f64> {
    let (sin, cos) = angle.sin_cos();
    rotation_by(sin, cos)
}

/// Rotation about the z axis by an angle with this sine and cosine.
pub(super) fn rotation_by(sin: f64, cos: f64) -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0))
}

/// A pose followed by a rotation about its z axis, by an angle with this sine and cosine: faster than the product with [`rotation_about_z`].
pub(super) fn rotated_about_z(pose: &Pose, sin: f64, cos: f64) -> Pose {
    let axes = pose.rotation.matrix();
    let (x, y, z) = (axes.column(0), axes.column(1), axes.column(2).into_owned());
    let axes = Matrix3::from_columns(&[x * cos + y * sin, y * cos - x * sin, z]);
    Pose::from_parts(pose.translation, Rotation3::from_matrix_unchecked(axes))
}
