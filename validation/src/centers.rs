//! Centres of a triangle in space, each by a method that the library does not use.

use nalgebra::Vector3;

/// Three points in space (m).
pub type Triangle = [Vector3<f64>; 3];

/// Mean of the corners (m).
#[must_use]
pub fn centroid(corners: &Triangle) -> Vector3<f64> {
    (corners[0] + corners[1] + corners[2]) / 3.0
}

/// The point of the plane at equal distance from all corners (m).
///
/// Barycentric weights a² (b² + c² − a²), a being the side opposite the corner.
#[must_use]
pub fn circumcenter(corners: &Triangle) -> Vector3<f64> {
    let opposite = [0, 1, 2].map(|k| (corners[(k + 2) % 3] - corners[(k + 1) % 3]).norm_squared());
    let whole: f64 = opposite.iter().sum();
    let weights = opposite.map(|a| a * (whole - 2.0 * a));
    let sum: f64 = weights.iter().sum();
    (0..3).fold(Vector3::zeros(), |point, k| point + corners[k] * (weights[k] / sum))
}

/// The point of least summed distance from the corners (m).
///
/// Barycentric weights a / sin(A + 60°), a being the side opposite the corner and A the angle at it; no angle may reach 120°.
#[must_use]
pub fn fermat_point(corners: &Triangle) -> Vector3<f64> {
    let weights = [0, 1, 2].map(|k| {
        let (to_next, to_last) =
            (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
        let opposite = (to_next - to_last).norm();
        let angle = to_next.cross(&to_last).norm().atan2(to_next.dot(&to_last));
        opposite / (angle + std::f64::consts::FRAC_PI_3).sin()
    });
    let sum: f64 = weights.iter().sum();
    (0..3).fold(Vector3::zeros(), |point, k| point + corners[k] * (weights[k] / sum))
}
