//! Points at which the joints of links are, from which simple bodies are drawn.

use jointplay_core::mechanism::Mechanism;
use jointplay_core::spatial::Pose;
use nalgebra::Vector3;

/// Points of each link at which its joints are, in its frame (m).
pub(crate) fn joint_points(mechanism: &Mechanism) -> Vec<Vec<Vector3<f64>>> {
    let mut points: Vec<Vec<Vector3<f64>>> = vec![Vec::new(); mechanism.links().len()];
    for joint in mechanism.joints() {
        for (link, frame) in joint.links.into_iter().zip(&joint.frames) {
            let at = frame.translation.vector;
            let of_link = &mut points[link];
            if of_link.iter().all(|known| (known - at).norm() > 0.0) {
                of_link.push(at);
            }
        }
    }
    points
}

/// Half of the largest extent of the joints of the links at their poses; 1 if there is none (m).
pub(crate) fn size(points: &[Vec<Vector3<f64>>], poses: &[Pose]) -> f64 {
    let all = points.iter().zip(poses).flat_map(|(points, pose)| {
        points.iter().map(move |point| (pose * nalgebra::Point3::from(*point)).coords)
    });
    let (mut least, mut most) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
    for point in all {
        (least, most) = (least.inf(&point), most.sup(&point));
    }
    let extent = (most - least).max();
    if extent > 0.0 { 0.5 * extent } else { 1.0 }
}
