//! Distance of a pair of collision objects at one time and in an interval, or lower bounds of it.

use nalgebra::Vector3;

use super::interval_motion_bound::IntervalMotionBound;
use crate::geometry::{PlacedCollider, bounding_sphere_gap, separation_along};

/// Distance of a pair at one time, or lower bounds of it.
#[derive(Clone, Copy)]
pub(super) struct DistanceBound {
    /// Distance, or a lower bound of it (m).
    pub(super) value: f64,
    pub(super) is_exact: bool,
    /// Lower bound of the gap along the platform's normal, along which arms do not move (m).
    pub(super) along_normal: f64,
    /// Along the last separating direction, once it was needed.
    pub(super) along_direction: Option<DirectionGap>,
}

/// Gap of a pair along a separating direction at one time.
#[derive(Clone, Copy)]
pub(super) struct DirectionGap {
    /// Number of changes of the direction before it was computed.
    pub(super) direction_changes: usize,
    /// Gap from the first object to the second (m), negative where they overlap along the direction, or where the second is on the other side.
    ///
    /// An object that passes through another is apart from it before and after, but on opposite sides.
    pub(super) signed: f64,
    /// Gap on either side (m), negative where they overlap along the direction.
    pub(super) either: f64,
    /// Upper bound of the magnitude of the direction's vertical part.
    pub(super) vertical: f64,
}

impl DistanceBound {
    /// Bound by bounding spheres, and by the extents along the platform's normal.
    pub(super) fn by_spheres([a, b]: [PlacedCollider<'_>; 2], normal: &Vector3<f64>) -> Self {
        let (value, along_normal) = (bounding_sphere_gap(a, b), separation_along(a, b, normal));
        Self { value, is_exact: false, along_normal, along_direction: None }
    }

    /// Lower bound of the distance in an interval, from bounds at its ends and the travel between them (m).
    pub(super) fn between(left: &Self, right: &Self, motion: IntervalMotionBound) -> f64 {
        let any_direction = left.value + right.value - motion.total;
        let along_normal = left.along_normal + right.along_normal - motion.along_normal;
        0.5 * any_direction.max(along_normal)
    }
}

impl DirectionGap {
    pub(super) fn new(
        colliders: [PlacedCollider<'_>; 2],
        direction: &Vector3<f64>,
        direction_changes: usize,
        normal: &Vector3<f64>,
    ) -> Self {
        let [a, b] = colliders.map(|placed| placed.extent_along(direction));
        let tilt = (normal - Vector3::z()).norm();
        Self {
            direction_changes,
            signed: b.min - a.max,
            either: a.gap(b),
            vertical: direction.dot(normal).abs() + tilt,
        }
    }
}
