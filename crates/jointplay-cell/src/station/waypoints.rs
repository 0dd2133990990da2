//! The places that a wafer passes on its way into a slot and out.

use jointplay_core::spatial::{Pose, leaning};
use nalgebra::{Point3, Vector3};

use super::{Approach, Station};
use crate::robot::WaferTarget;

/// Places of the wafer's centre for one slot, all in planes parallel to the slot's.
///
/// An effector that fetches goes in below and out above; one that lays down goes in above and out below.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoints {
    /// Retracted, at the height of passing below.
    pub retracted_below: WaferTarget,
    /// From there into the slot, below.
    pub via_below: Vec<WaferTarget>,
    /// In the slot, below the resting plane.
    pub below: WaferTarget,
    /// In the slot, where the wafer rests.
    pub resting: WaferTarget,
    /// In the slot, above the resting plane.
    pub above: WaferTarget,
    /// From the retracted place into the slot, above.
    pub via_above: Vec<WaferTarget>,
    /// Retracted, at the height of passing above.
    pub retracted_above: WaferTarget,
}

impl Station {
    /// Whether it has this slot, counted from 1.
    #[must_use]
    pub fn has_slot(&self, slot: usize) -> bool {
        (1..=self.slots).contains(&slot)
    }

    /// The frame of a slot, counted from 1, the lowest: its origin is where the centre of the wafer's lower face rests.
    ///
    /// Whether the station has this slot is said by [`Self::has_slot`]; beyond the last one the pitch goes on.
    #[must_use]
    pub fn slot_frame(&self, slot: usize) -> Pose {
        let above = self.pitch * (slot as f64 - 1.0);
        let in_station = Vector3::from(self.offset) + Vector3::new(0.0, 0.0, above);
        Pose::from_parts(
            (self.base_from_station * Point3::from(in_station)).coords.into(),
            self.base_from_station.rotation,
        )
    }

    /// The places that a wafer passes for a slot, counted from 1.
    ///
    /// # Arguments
    /// * `axis` – where the axis that the arm turns about crosses the base plane: x, y in the base frame [m]
    #[must_use]
    pub fn waypoints(&self, slot: usize, axis: [f64; 2]) -> Waypoints {
        let frame = self.slot_frame(slot);
        let normal = frame.rotation * Vector3::z();
        let heading = match self.approach {
            Approach::Radial => None,
            Approach::Line => {
                let inward = leaning(&normal).inverse() * (frame.rotation * Vector3::y());
                Some(inward.y.atan2(inward.x))
            }
        };
        let target = |center: Vector3<f64>| WaferTarget { center, normal, heading };
        let resting = frame.translation.vector;
        let out = self.outward(&frame, axis);
        let far = resting + out * self.way_out(&resting, &out, axis);
        let via = |lift: f64| {
            let place =
                |via: &[f64; 3]| target((frame * Point3::from(*via)).coords + normal * lift);
            self.via.iter().map(place).collect()
        };
        let (down, up) = (-self.stroke.below, self.stroke.above);
        Waypoints {
            retracted_below: target(far + normal * down),
            via_below: via(down),
            below: target(resting + normal * down),
            resting: target(resting),
            above: target(resting + normal * up),
            via_above: via(up),
            retracted_above: target(far + normal * up),
        }
    }

    /// The direction out of the slot, within its plane.
    fn outward(&self, frame: &Pose, axis: [f64; 2]) -> Vector3<f64> {
        let normal = frame.rotation * Vector3::z();
        let straight = -(frame.rotation * Vector3::y());
        match self.approach {
            Approach::Line => straight,
            Approach::Radial => {
                let center = frame.translation.vector;
                let (x, y) = (axis[0] - center.x, axis[1] - center.y);
                // The height within the plane, so that the line stays in it and above the one on the floor.
                let z = -(normal.x * x + normal.y * y) / normal.z;
                Vector3::new(x, y, z).try_normalize(f64::MIN_POSITIVE).unwrap_or(straight)
            }
        }
    }

    /// How far out the place is that counts as retracted: where the way comes as near to the axis as the retracted reach, or else as near as it comes [m].
    fn way_out(&self, resting: &Vector3<f64>, out: &Vector3<f64>, axis: [f64; 2]) -> f64 {
        let (x, y) = (resting.x - axis[0], resting.y - axis[1]);
        // |(x, y) + t out|² = reach², the smaller root.
        let (a, b) = (out.x * out.x + out.y * out.y, x * out.x + y * out.y);
        let c = x * x + y * y - self.retract_reach * self.retract_reach;
        let nearest = -b / a;
        let root = (b * b - a * c).max(0.0).sqrt() / a;
        (nearest - root).max(0.0)
    }
}
