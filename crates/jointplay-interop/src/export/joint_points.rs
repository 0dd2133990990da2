//! Points at which the joints of links are, from which simple bodies are drawn.

use jointplay_core::mechanism::{JointKind, Mechanism};
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

/// Points between which bodies of links are drawn: those of their joints, and for a slide whose joints coincide a second one on its axis.
///
/// The second point is at half the length of the other link, where that is a bar along the axis, as for the cylinder around a rod; otherwise at a distance of `size` (m).
pub(crate) fn drawn_points(
    mechanism: &Mechanism,
    mut points: Vec<Vec<Vector3<f64>>>,
    size: f64,
) -> Vec<Vec<Vector3<f64>>> {
    let of_joints = points.clone();
    for joint in mechanism.joints() {
        if !matches!(joint.kind, JointKind::Prismatic | JointKind::Cylindrical) {
            continue;
        }
        for (side, (link, frame)) in joint.links.into_iter().zip(&joint.frames).enumerate() {
            let [only] = points[link][..] else { continue };
            let axis = frame.rotation * Vector3::z();
            let other = joint.frames[1 - side];
            let to_end = match of_joints[joint.links[1 - side]][..] {
                [a, b] => {
                    (a + b - other.translation.vector * 2.0).dot(&(other.rotation * Vector3::z()))
                }
                _ => 0.0,
            };
            let along = if to_end.abs() > SHORTEST * size { 0.5 * to_end } else { -size };
            points[link].push(only + axis * along);
        }
    }
    points
}

/// Bars shorter than this share of the size of the mechanism are not drawn.
const SHORTEST: f64 = 0.05;

/// Bars that draw a link: between two points, or from the middle of more points to each of those that are at a distance from it.
pub(crate) fn bars(points: &[Vector3<f64>], shortest: f64) -> Vec<[Vector3<f64>; 2]> {
    match points {
        [] | [_] => Vec::new(),
        &[first, second] => vec![[first, second]],
        all => {
            #[expect(clippy::cast_precision_loss, reason = "few joints")]
            let middle = all.iter().sum::<Vector3<f64>>() / all.len() as f64;
            let far = all.iter().filter(|at| (*at - middle).norm() > shortest);
            far.map(|&at| [middle, at]).collect()
        }
    }
}

/// Radius of a bar, as a share of the size of the mechanism.
pub(crate) const BAR: f64 = 0.015;
/// Radius of a joint, as a share of the size of the mechanism.
pub(crate) const JOINT: f64 = 0.025;

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

#[cfg(test)]
mod tests {

    use jointplay_format::{catalogue, mechanism};

    use super::*;

    #[test]
    fn cylinders_are_drawn_around_their_rods() {
        let file = mechanism::parse(catalogue::find("hexapod").unwrap().text).unwrap();
        let mechanism = &file.mechanism;
        let points = joint_points(mechanism);
        let drawn = drawn_points(mechanism, points.clone(), 0.2);
        let [cylinder, rod] = ["cylinder 1", "rod 1"].map(|name| mechanism.link(name).unwrap());
        let joint = &mechanism.joints()[mechanism.joint("P1").unwrap()];
        // With the slide at zero, the frames of both links meet: from the rod's frame to that of the cylinder.
        let cylinder_from_rod = joint.frames[0] * joint.frames[1].inverse();
        let ends: Vec<_> = points[rod]
            .iter()
            .map(|&at| (cylinder_from_rod * nalgebra::Point3::from(at)).coords)
            .collect();
        let [bottom, top] = drawn[cylinder][..] else { panic!("{:?}", drawn[cylinder]) };
        let [a, b] = ends[..] else { panic!("{ends:?}") };
        let far = if (a - bottom).norm() > (b - bottom).norm() { a } else { b };
        assert!((top - (bottom + far) * 0.5).norm() < 1e-12, "{top} {bottom} {far}");
    }

    #[test]
    fn rods_whose_joints_coincide_are_drawn_along_their_slides() {
        let file = mechanism::parse(catalogue::find("gpr-mechanism").unwrap().text).unwrap();
        let points = drawn_points(&file.mechanism, joint_points(&file.mechanism), 0.2);
        let links = file.mechanism.links().iter().zip(&points);
        let rods: Vec<_> = links.filter(|(name, _)| name.starts_with("rod")).collect();
        assert_eq!(rods.len(), 3);
        for (name, points) in rods {
            let [top, bottom] = points[..] else { panic!("{name}: {points:?}") };
            assert!((top - bottom - Vector3::z() * 0.2).norm() < 1e-15, "{name}: {points:?}");
        }
    }
}
