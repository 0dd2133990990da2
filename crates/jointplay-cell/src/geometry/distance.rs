//! Distances between placed colliders.

use nalgebra::Vector3;
use parry3d_f64::math::{Pose3, Vector};
use parry3d_f64::query::details::closest_points_support_map_support_map_with_params;
use parry3d_f64::query::gjk::{GJKResult, VoronoiSimplex};
use parry3d_f64::query::{self, ClosestPoints};
use parry3d_f64::shape::{Shape as Queried, SupportMap};

use super::collider::PlacedCollider;

/// Lower bound of the distance by the bounding spheres (m); negative where these overlap.
pub(crate) fn bounding_sphere_gap(a: PlacedCollider<'_>, b: PlacedCollider<'_>) -> f64 {
    let center = |p: &PlacedCollider<'_>| {
        p.base_from_parent.rotation * p.collider.center + p.base_from_parent.translation.vector
    };
    (center(&a) - center(&b)).norm() - a.collider.radius - b.collider.radius
}

/// Lower bound of the distance: the gap between two colliders along a direction (m); negative where they overlap along it.
pub(crate) fn separation_along(
    a: PlacedCollider<'_>,
    b: PlacedCollider<'_>,
    direction: &Vector3<f64>,
) -> f64 {
    a.extent_along(direction).gap(b.extent_along(direction))
}

/// Distance and separating direction of two colliders.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Separation {
    /// Distance, 0 where the colliders overlap (m).
    pub(crate) distance: f64,
    /// Unit vector from the nearest point of the first to that of the second in the base frame, where it is known.
    pub(crate) direction: Option<Vector3<f64>>,
}

/// Distance and separating direction of two colliders; a guess of the direction makes it faster.
pub(crate) fn separation(
    a: PlacedCollider<'_>,
    b: PlacedCollider<'_>,
    guess: Option<&Vector3<f64>>,
) -> Separation {
    let (pose_a, pose_b) = (a.pose(), b.pose());
    let margin = a.collider.margin + b.collider.margin;
    let (one, other): (&dyn Queried, &dyn Queried) = (&*a.collider.shape.0, &*b.collider.shape.0);
    let between = pose_a.inv_mul(&pose_b);
    let guess = guess.map_or(between.translation, |guess| {
        pose_a.rotation.inverse() * Vector::new(guess.x, guess.y, guess.z)
    });
    let (distance, along) = match convex_closest_points(&between, one, other, guess) {
        Some(None) => (0.0, None),
        Some(Some([first, second])) => {
            let distance = (second - first).length();
            (distance, (distance > 0.0).then(|| (second - first) / distance))
        }
        None => {
            let found = query::distance(&pose_a, one, &pose_b, other);
            (found.map_or(0.0, |found| found.distance), None)
        }
    };
    if distance == 0.0 {
        // An iteration that does not converge returns 0, too: the bound by the spheres is then valid.
        let touching = query::intersection_test(&pose_a, one, &pose_b, other);
        if touching.is_ok_and(|found| !found.intersecting) {
            let distance = bounding_sphere_gap(a, b).max(f64::MIN_POSITIVE);
            return Separation { distance, direction: None };
        }
    }
    let along = along.map(|along| pose_a.rotation * along);
    let along = along.map(|along| Vector3::new(along.x, along.y, along.z));
    Separation { distance: (distance - margin).max(0.0), direction: along }
}

/// Nearest points of two colliders in the base frame, on the surface of each (m); `None` where they overlap, or where their distance is unknown.
pub(crate) fn nearest_points(
    a: PlacedCollider<'_>,
    b: PlacedCollider<'_>,
) -> Option<[Vector3<f64>; 2]> {
    let (pose_a, pose_b) = (a.pose(), b.pose());
    let (one, other): (&dyn Queried, &dyn Queried) = (&*a.collider.shape.0, &*b.collider.shape.0);
    let between = pose_a.inv_mul(&pose_b);
    let [first, second] = match convex_closest_points(&between, one, other, between.translation) {
        Some(points) => points?.map(|point| pose_a * point),
        None => match query::closest_points(&pose_a, one, &pose_b, other, f64::MAX).ok()? {
            ClosestPoints::WithinMargin(first, second) => [first, second],
            ClosestPoints::Intersecting | ClosestPoints::Disjoint => return None,
        },
    };
    let [first, second] = [first, second].map(|point| Vector3::new(point.x, point.y, point.z));
    let distance = (second - first).norm();
    if distance <= a.collider.margin + b.collider.margin {
        return None;
    }
    let along = (second - first) / distance;
    Some([first + along * a.collider.margin, second - along * b.collider.margin])
}

/// Closest points of two shapes in the frame of the first, `Some(None)` where they overlap; `None` for shapes that are not convex and for two segments.
fn convex_closest_points(
    between: &Pose3,
    one: &dyn Queried,
    other: &dyn Queried,
    guess: Vector,
) -> Option<Option<[Vector; 2]>> {
    // For two boxes the library alternates between their faces once, which is inexact where these are parallel and crosswise.
    let points = if let (Some(one), Some(other)) = (one.as_cuboid(), other.as_cuboid()) {
        closest_points(between, one, other, guess)
    } else if one.as_segment().is_some() && other.as_segment().is_some() {
        return None;
    } else {
        closest_points(between, one.as_support_map()?, other.as_support_map()?, guess)
    };
    let is_round = [one, other].iter().any(|shape| shape.as_cylinder().is_some());
    Some(points.map(|points| {
        if is_round { refine_by_projection(between, one, other, points) } else { points }
    }))
}

/// Closest points of two convex shapes in the frame of the first; `None` where they overlap.
fn closest_points<A: SupportMap + ?Sized, B: SupportMap + ?Sized>(
    between: &Pose3,
    one: &A,
    other: &B,
    guess: Vector,
) -> Option<[Vector; 2]> {
    let mut simplex = VoronoiSimplex::new();
    let (far, guess) = (f64::MAX, Some(guess));
    let found = closest_points_support_map_support_map_with_params(
        between,
        one,
        other,
        far,
        &mut simplex,
        guess,
    );
    match found {
        GJKResult::ClosestPoints(first, second, _) => Some([first, second]),
        _ => None,
    }
}

/// Largest number of alternating projections between two shapes.
const MAX_PROJECTIONS: usize = 100;

/// Decrease of the distance below which projections end (m).
const PROJECTION_TOLERANCE: f64 = 1e-11;

/// Closest points of two convex shapes, refined by alternating projections: with cylinders, the library's iteration sometimes ends micrometres too early.
fn refine_by_projection(
    between: &Pose3,
    one: &dyn Queried,
    other: &dyn Queried,
    [mut first, mut second]: [Vector; 2],
) -> [Vector; 2] {
    let mut apart = (second - first).length();
    for _ in 0..MAX_PROJECTIONS {
        let nearer = one.project_local_point(second, true).point;
        let next = other.project_point(between, nearer, true).point;
        let now = (next - nearer).length();
        if now > apart {
            break;
        }
        (first, second) = (nearer, next);
        if apart - now <= PROJECTION_TOLERANCE {
            break;
        }
        apart = now;
    }
    [first, second]
}

/// Distance of two colliders (m); 0 where they overlap.
pub(crate) fn distance(a: PlacedCollider<'_>, b: PlacedCollider<'_>) -> f64 {
    separation(a, b, None).distance
}

/// Penetration depth of two colliders (m); 0 where it is unknown.
pub(crate) fn penetration_depth(a: PlacedCollider<'_>, b: PlacedCollider<'_>) -> f64 {
    let margin = a.collider.margin + b.collider.margin;
    query::contact(&a.pose(), &*a.collider.shape.0, &b.pose(), &*b.collider.shape.0, margin)
        .ok()
        .flatten()
        .map_or(0.0, |contact| (margin - contact.dist).max(0.0))
}

/// Signed distance of a point in the base frame from a collider (m); negative inside, where its magnitude is a lower bound of the depth.
pub(crate) fn signed_distance(placed: PlacedCollider<'_>, point: &Vector3<f64>) -> f64 {
    let point = Vector::new(point.x, point.y, point.z);
    let found = placed.collider.shape.0.project_point(&placed.pose(), point, false);
    let apart = (found.point - point).length();
    (if found.is_inside { -apart } else { apart }) - placed.collider.margin
}

#[cfg(test)]
mod tests {
    use jointplay_core::spatial::Pose;
    use nalgebra::{Rotation3, Translation3};
    use proptest::prelude::RngExt;
    use proptest::test_runner::{RngAlgorithm, TestRng};

    use super::super::collider::{Collider, posed, vector};
    use super::super::shape::Shape;
    use super::*;

    fn at(x: f64, y: f64, z: f64) -> Pose {
        Pose::from_parts(Translation3::new(x, y, z), Rotation3::identity())
    }

    #[track_caller]
    fn check(a: &Shape, b: &Shape, base_from_b: Pose, expected: f64) {
        let (a, b) = (
            Collider::new(a, &Pose::identity()).unwrap(),
            Collider::new(b, &Pose::identity()).unwrap(),
        );
        let first = PlacedCollider { collider: &a, base_from_parent: &Pose::identity() };
        let second = PlacedCollider { collider: &b, base_from_parent: &base_from_b };
        let found = distance(first, second);
        assert!((found - expected).abs() < 1e-7, "{found} for {expected}");
        assert!(bounding_sphere_gap(first, second) <= found + 1e-12);
        for direction in [Vector3::x(), Vector3::y(), Vector3::z(), Vector3::new(0.6, 0.0, 0.8)] {
            assert!(separation_along(first, second, &direction) <= found + 1e-9);
        }
    }

    #[test]
    fn distances_in_closed_form() {
        let wafer = Shape::Cylinder { radius: 0.15, half_height: 0.0004 };
        let wall = Shape::Box { half: [0.01, 0.5, 0.5] };
        let link = Shape::Capsule { ends: [[0.0; 3], [0.3, 0.0, 0.0]], radius: 0.02 };
        let hull = Shape::Convex {
            points: vec![[0.0; 3], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]],
        };
        check(&wafer, &wafer, at(0.02, 0.01, 0.01), 0.0092);
        check(&wafer, &wafer, at(0.5, 0.0, 0.0), 0.2);
        check(&wafer, &wall, at(0.2, 0.0, 0.0), 0.04);
        check(&link, &link, at(0.1, 0.0, 0.05), 0.01);
        check(&link, &link, at(0.1, 0.0, 0.03), 0.0);
        check(&link, &wall, at(0.4, 0.0, 0.0), 0.07);
        check(&hull, &wall, at(0.2, 0.0, 0.0), 0.09);
    }

    /// Of two boxes: from each corner to the other box, and from each edge to each.
    fn by_corners_and_edges(halves: [[f64; 3]; 2], poses: [Pose3; 2]) -> f64 {
        use parry3d_f64::query::PointQuery;
        use parry3d_f64::query::details::distance_segment_segment;
        use parry3d_f64::shape::{Cuboid, Segment};
        let signed = |half: &[f64; 3], bits: usize| {
            let sign = |k: usize| if bits >> k & 1 == 0 { -half[k] } else { half[k] };
            Vector::new(sign(0), sign(1), sign(2))
        };
        let edges = |which: usize| {
            let (half, pose) = (halves[which], poses[which]);
            (0..8_usize).flat_map(move |bits| {
                (0..3).filter(move |axis| bits >> axis & 1 == 0).map(move |axis| {
                    let ends = [bits, bits | 1 << axis].map(|bits| pose * signed(&half, bits));
                    Segment::new(ends[0], ends[1])
                })
            })
        };
        let mut least = f64::INFINITY;
        for (one, other) in [(0, 1), (1, 0)] {
            let cuboid = Cuboid::new(vector(&halves[other]));
            for bits in 0..8 {
                let corner = poses[one] * signed(&halves[one], bits);
                least = least.min(cuboid.distance_to_point(&poses[other], corner, true));
            }
        }
        for one in edges(0) {
            for other in edges(1) {
                least = least.min(distance_segment_segment(&Pose3::IDENTITY, &one, &other));
            }
        }
        least
    }

    #[test]
    fn boxes_that_lie_parallel_crosswise_or_anyhow() {
        let mut generator = TestRng::from_seed(RngAlgorithm::ChaCha, &[3; 32]);
        let mut random = || generator.random_range(-1.0..1.0_f64);
        let mut crosswise = 0;
        for round in 0..20_000 {
            let halves = [0, 1].map(|_| [0, 1, 2].map(|_| 0.005 + 0.15 * random().powi(2)));
            let turn = 3.0 * random();
            // Parallel planes, by bits or to round-off, slightly tilted, or in any orientation.
            let tilt = [0.0, 1e-16, 1e-12, 1e-6, 1e-3, 1.0][round % 6];
            let tilt = Vector3::new(tilt * random(), tilt * random(), 0.0);
            let common = Rotation3::new(Vector3::new(random(), random(), random()) * 0.01);
            let rotation = Rotation3::new(tilt) * Rotation3::new(Vector3::z() * turn);
            let above = halves[0][2] + halves[1][2] + 0.02 * random().abs();
            let shift = Vector3::new(0.2 * random(), 0.2 * random(), above);
            let poses = [
                Pose::from_parts(Vector3::new(random(), random(), random()).into(), common),
                Pose::identity(),
            ];
            let poses = [poses[0], poses[0] * Pose::from_parts(shift.into(), rotation)];
            let [a, b] =
                halves.map(|half| Collider::new(&Shape::Box { half }, &Pose::identity()).unwrap());
            let [a, b] = [(&a, &poses[0]), (&b, &poses[1])]
                .map(|(collider, base_from_parent)| PlacedCollider { collider, base_from_parent });
            let Separation { distance: found, direction: along } = separation(a, b, None);
            let expected = by_corners_and_edges(halves, poses.map(|pose| posed(&pose)));
            crosswise +=
                usize::from((expected - (above - halves[0][2] - halves[1][2])).abs() < 1e-9);
            if found > 0.0 || round % 6 < 4 {
                assert!((found - expected).abs() < 1e-8, "{round}: {found} for {expected}");
                // From a good guess as from a bad one, and there is a gap as wide along it.
                let along = along.unwrap();
                assert!((separation_along(a, b, &along) - expected).abs() < 1e-7, "{round}");
                let off = Vector3::new(random(), random(), random()) * [0.0, 0.01, 1.0][round % 3];
                for guess in [along + off, -along + off] {
                    let guessed = separation(a, b, Some(&guess)).distance;
                    assert!((guessed - expected).abs() < 1e-8, "{round}: {guessed} {expected}");
                }
            }
        }
        assert!(crosswise > 1000, "{crosswise}");
    }

    /// Of a box and an upright cylinder, in the frame of the box: projections to and fro until nothing changes.
    fn by_projections(half: [f64; 3], [radius, half_height]: [f64; 2], at: &Pose) -> f64 {
        let mut point = at.translation.vector;
        let mut apart = f64::INFINITY;
        for _ in 0..200_000 {
            let on_box = Vector3::from_fn(|k, _| point[k].clamp(-half[k], half[k]));
            let local = at.inverse() * nalgebra::Point3::from(on_box);
            let shrink = (radius / local.coords.xy().norm()).min(1.0);
            let z = local.z.clamp(-half_height, half_height);
            let on_it = at * nalgebra::Point3::new(local.x * shrink, local.y * shrink, z);
            point = on_it.coords;
            let now = (point - on_box).norm();
            if apart - now < 1e-15 {
                return now;
            }
            apart = now;
        }
        apart
    }

    #[test]
    fn boxes_and_cylinders_lying_anyhow() {
        let mut generator = TestRng::from_seed(RngAlgorithm::ChaCha, &[5; 32]);
        let mut random = || generator.random_range(-1.0..1.0_f64);
        let mut seen = 0;
        for round in 0..20_000 {
            let half = [0, 1, 2].map(|_| 0.005 + 0.06 * random().abs());
            let [radius, half_height] = [0, 1].map(|_| 0.003 + 0.06 * random().abs());
            let turn = Rotation3::new(Vector3::new(random(), random(), random()) * 2.0);
            let shift = Vector3::new(random(), random(), random()) * 0.15;
            let base_from_it = Pose::from_parts(shift.into(), turn);
            let one = Collider::new(&Shape::Box { half }, &Pose::identity()).unwrap();
            let other =
                Collider::new(&Shape::Cylinder { radius, half_height }, &Pose::identity()).unwrap();
            let expected = by_projections(half, [radius, half_height], &base_from_it);
            if expected < 1e-3 {
                continue;
            }
            seen += 1;
            let identity = Pose::identity();
            let [a, b] = [(&one, &identity), (&other, &base_from_it)]
                .map(|(collider, base_from_parent)| PlacedCollider { collider, base_from_parent });
            let found = distance(a, b);
            assert!((found - expected).abs() < 1e-8, "{round}: {found} for {expected}");
        }
        assert!(seen > 10_000, "{seen}");
    }

    #[test]
    fn depth_of_an_overlap() {
        let a = Collider::new(&Shape::Box { half: [0.1; 3] }, &Pose::identity()).unwrap();
        let first = PlacedCollider { collider: &a, base_from_parent: &Pose::identity() };
        let shifted = at(0.17, 0.0, 0.0);
        let second = PlacedCollider { collider: &a, base_from_parent: &shifted };
        assert_eq!(distance(first, second), 0.0);
        assert!((penetration_depth(first, second) - 0.03).abs() < 1e-6);
    }

    #[test]
    fn a_point_within_and_outside() {
        let zone =
            Collider::new(&Shape::Cylinder { radius: 0.4, half_height: 0.5 }, &Pose::identity())
                .unwrap();
        let placed = PlacedCollider { collider: &zone, base_from_parent: &Pose::identity() };
        let within = signed_distance(placed, &Vector3::new(0.1, 0.2, 0.3));
        assert!((within + 0.4 - 0.1_f64.hypot(0.2)).abs() < 1e-9, "{within}");
        assert!((signed_distance(placed, &Vector3::new(0.0, 0.5, 0.3)) - 0.1).abs() < 1e-9);
    }

    #[test]
    fn flat_points_are_taken_as_the_box_around_them() {
        let flat = Shape::Convex { points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] };
        let solid = Collider::new(&flat, &Pose::identity()).unwrap();
        let placed = PlacedCollider { collider: &solid, base_from_parent: &Pose::identity() };
        assert!(signed_distance(placed, &Vector3::new(0.5, 0.5, 0.2)) - 0.2 < 1e-9);
        assert!(Collider::new(&Shape::Convex { points: vec![] }, &Pose::identity()).is_none());
    }
}
