//! Point sets that span a volume.

use nalgebra::Vector3;

/// Whether points span a volume.
pub(super) fn is_solid(points: &[Vector3<f64>]) -> bool {
    let Some(first) = points.first() else { return false };
    let far = points.iter().map(|point| point - first);
    let Some(one) = far.clone().max_by(|a, b| a.norm().total_cmp(&b.norm())) else { return false };
    let Some(two) = far.clone().map(|p| one.cross(&p)).max_by(|a, b| a.norm().total_cmp(&b.norm()))
    else {
        return false;
    };
    let deepest = far.map(|p| two.dot(&p).abs()).fold(0.0, f64::max);
    deepest > 1e-6 * one.norm() * two.norm() && two.norm() > 0.0
}
