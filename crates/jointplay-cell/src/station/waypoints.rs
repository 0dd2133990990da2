//! Waypoints of a wafer into a slot and out of it.

use jointplay_core::spatial::{Pose, tilt_rotation};
use nalgebra::{Point3, Vector3};

use super::description::{Approach, SlotId, Station};
use crate::CellError;
use crate::robot::{EffectorId, WaferTarget};
use crate::wafer::Unreachable;
use crate::workcell::Cell;

/// Waypoints of the wafer's centre for one slot, all in planes parallel to the slot's.
///
/// An effector that picks enters below and leaves above; one that places enters above and leaves below.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoints {
    /// Retracted, at the height of entering below.
    pub retracted_below: WaferTarget,
    /// Via points from there into the slot, below.
    pub via_below: Vec<WaferTarget>,
    /// In the slot, below the resting plane.
    pub below: WaferTarget,
    /// In the slot, where the wafer rests.
    pub resting: WaferTarget,
    /// In the slot, above the resting plane.
    pub above: WaferTarget,
    /// Via points from the retracted pose into the slot, above.
    pub via_above: Vec<WaferTarget>,
    /// Retracted, at the height of entering above.
    pub retracted_above: WaferTarget,
}

impl Station {
    /// Whether the station has a slot, counted from 1.
    #[must_use]
    pub fn has_slot(&self, slot: usize) -> bool {
        (1..=self.slots).contains(&slot)
    }

    /// Frame of a slot, counted from 1, the lowest: its origin is the resting position of the centre of the wafer's lower face.
    ///
    /// Slots beyond the last continue the pitch; see [`Self::has_slot`].
    #[must_use]
    pub fn slot_frame(&self, slot: usize) -> Pose {
        let in_station = Point3::from(self.slot_position(slot));
        Pose::from_parts(
            (self.base_from_station * in_station).coords.into(),
            self.base_from_station.rotation,
        )
    }

    /// Resting position of the wafer in a slot, counted from 1, in the station frame (m).
    #[must_use]
    pub fn slot_position(&self, slot: usize) -> Vector3<f64> {
        let [x, y] = self.slot_step;
        Vector3::from(self.offset) + Vector3::new(x, y, self.pitch) * (slot as f64 - 1.0)
    }

    /// Waypoints for a slot, counted from 1.
    ///
    /// # Arguments
    /// * `axis`, `below`, `above` – intersections of the axis of the arm's first joint with the slot's plane, for the resting pose and the poses retracted below and above: x, y in the base frame (m); [`Cell::waypoints`] computes them
    #[must_use]
    pub fn waypoints(&self, slot: usize, [axis, below, above]: [[f64; 2]; 3]) -> Waypoints {
        let frame = self.slot_frame(slot);
        let normal = frame.rotation * Vector3::z();
        let heading = match self.approach {
            Approach::Radial => None,
            Approach::Line => {
                let inward = tilt_rotation(&normal).inverse() * (frame.rotation * Vector3::y());
                Some(inward.y.atan2(inward.x))
            }
        };
        let target = |center: Vector3<f64>| WaferTarget { center, normal, heading };
        let resting = frame.translation.vector;
        let out = self.outward(&frame, axis);
        let far = |axis| resting + out * self.distance_out(-within(&frame, axis), &out);
        let via = |lift: f64| {
            let place =
                |via: &[f64; 3]| target((frame * Point3::from(*via)).coords + normal * lift);
            self.via.iter().map(place).collect()
        };
        let (down, up) = (-self.stroke.below, self.stroke.above);
        Waypoints {
            retracted_below: target(far(below) + normal * down),
            via_below: via(down),
            below: target(resting + normal * down),
            resting: target(resting),
            above: target(resting + normal * up),
            via_above: via(up),
            retracted_above: target(far(above) + normal * up),
        }
    }

    /// Direction out of the slot, within its plane.
    fn outward(&self, frame: &Pose, axis: [f64; 2]) -> Vector3<f64> {
        let straight = -(frame.rotation * Vector3::y());
        match self.approach {
            Approach::Line => straight,
            // Projected into the plane, so that the line stays in it.
            Approach::Radial => {
                within(frame, axis).try_normalize(f64::MIN_POSITIVE).unwrap_or(straight)
            }
        }
    }

    /// Distance along the line out of the slot at which the wafer counts as retracted: where the line is at the retract distance from the axis of the arm's first joint, or else nearest to it (m).
    ///
    /// # Arguments
    /// * `resting` – from that axis to the resting position, within the slot's plane (m)
    fn distance_out(&self, resting: Vector3<f64>, out: &Vector3<f64>) -> f64 {
        // |resting + t out|² = reach², the smaller root.
        let along = resting.dot(out);
        let rest = resting.norm_squared() - self.retract_reach * self.retract_reach;
        let root = (along * along - rest).max(0.0).sqrt();
        (-along - root).max(0.0)
    }
}

/// From the origin of a slot's frame to the intersection of a vertical line with its plane: x, y of the line in the base frame (m).
fn within(frame: &Pose, [x, y]: [f64; 2]) -> Vector3<f64> {
    let (center, normal) = (frame.translation.vector, frame.rotation * Vector3::z());
    let (x, y) = (x - center.x, y - center.y);
    Vector3::new(x, y, -(normal.x * x + normal.y * y) / normal.z)
}

impl Cell {
    /// Waypoints for a slot, on the line along which the arm extends at the platform's tilt.
    ///
    /// The axis of the arm's first joint tilts with the platform, and shifts where it intersects the slot's plane: by 3 mm at 1° and a height of 150 mm over the platform, which is much for a wafer that is retracted to a few millimetres.
    /// The retract distance is measured from that intersection, within the plane: so the arm's motors have the same positions at any tilt.
    ///
    /// # Arguments
    /// * `effector` – effector that carries the wafer
    /// * `slot` – station, and slot counted from 1
    /// * `seed` – present positions of all axes, rods first (m or rad)
    ///
    /// # Errors
    /// Those of [`Cell::compensated_inverse`] for the resting position.
    ///
    /// # Panics
    /// The cell has no such station.
    pub fn waypoints(
        &self,
        effector: EffectorId,
        slot: SlotId,
        seed: &[f64],
    ) -> Result<Waypoints, Unreachable> {
        let station = &self.stations[slot.station];
        let axis = self.shoulder_point(effector, slot, seed)?;
        let waypoints = |axes: [Vector3<f64>; 3]| {
            station.waypoints(slot.slot, axes.map(|axis| [axis.x, axis.y]))
        };
        let Waypoints { retracted_below, retracted_above, .. } = waypoints([axis; 3]);
        // A retracted pose that is out of reach is reported where it is used.
        let retracted = |place: &WaferTarget| {
            self.axis_crossing_at(effector, slot, place, seed).unwrap_or(axis)
        };
        Ok(waypoints([axis, retracted(&retracted_below), retracted(&retracted_above)]))
    }

    /// Intersection of the axis of the arm's first joint with the plane of a slot, the wafer resting there, in the base frame (m).
    ///
    /// # Errors
    /// As [`Cell::waypoints`].
    ///
    /// # Panics
    /// The cell has no such station.
    pub fn shoulder_point(
        &self,
        effector: EffectorId,
        slot: SlotId,
        seed: &[f64],
    ) -> Result<Vector3<f64>, Unreachable> {
        let resting = self.stations[slot.station].waypoints(slot.slot, [[0.0; 2]; 3]).resting;
        self.axis_crossing_at(effector, slot, &resting, seed)
    }

    /// Intersection of that axis with the plane of a slot, the platform tilted for the loaded wafer at a target.
    fn axis_crossing_at(
        &self,
        effector: EffectorId,
        slot: SlotId,
        target: &WaferTarget,
        seed: &[f64],
    ) -> Result<Vector3<f64>, Unreachable> {
        let frame = self.stations[slot.station].slot_frame(slot.slot);
        // An arm whose posture is planned for the whole line need not be within limits in the one found here.
        let positions = if self.robot.has_posture_paths(effector) {
            self.compensated_inverse_beyond_limits(effector, target, true, seed)?.positions
        } else {
            self.compensated_inverse(effector, target, true, seed)?.positions
        };
        let rods = [positions[0], positions[1], positions[2]];
        let platform = self.robot.model.forward(&self.robot.gpr, rods).map_err(CellError::from)?;
        let mount = self.robot.arms[effector.arm].mount;
        let joint = (platform.base_from_platform * Point3::from(mount)).coords;
        let (along, normal) = (platform.normal(), frame.rotation * Vector3::z());
        let rise = normal.dot(&(frame.translation.vector - joint)) / normal.dot(&along);
        Ok(joint + along * rise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::station::teach::FrameUncertainty;
    use crate::station::{Origin, Stroke, teach};
    use jointplay_core::spatial::Tilt;

    fn station(approach: Approach, retract_reach: f64) -> Station {
        let normal = Tilt { azimuth: 1.0, angle: 0.0139 }.normal();
        Station {
            name: "LP".into(),
            base_from_station: teach::frame(Vector3::new(0.3, 0.6, 0.5), &normal, -0.2),
            origin: Origin::Nominal,
            uncertainty: FrameUncertainty::UNKNOWN,
            slots: 25,
            pitch: 0.01,
            slot_step: [0.0; 2],
            stroke: Stroke { below: 0.004, above: 0.003, speed: 0.02 },
            offset: [0.001, 0.0, 0.0],
            retract_reach,
            via: vec![[0.0, -0.25, 0.0]],
            approach,
            effectors: Vec::new(),
            process_time: 0.0,
        }
    }

    #[test]
    fn waypoints_lie_in_planes_parallel_to_the_slot() {
        for approach in [Approach::Radial, Approach::Line] {
            let station = station(approach, 0.4);
            let frame = station.slot_frame(7);
            assert!(
                (frame.translation.vector - station.slot_frame(6).translation.vector).norm() - 0.01
                    < 1e-15
            );
            let axis = [0.02, -0.01];
            let waypoints = station.waypoints(7, [axis; 3]);
            let height = |target: &WaferTarget| (frame.inverse() * Point3::from(target.center)).z;
            for (target, expected) in [
                (&waypoints.retracted_below, -0.004),
                (&waypoints.via_below[0], -0.004),
                (&waypoints.below, -0.004),
                (&waypoints.resting, 0.0),
                (&waypoints.above, 0.003),
                (&waypoints.via_above[0], 0.003),
            ] {
                assert!((height(target) - expected).abs() < 1e-15, "{approach:?} {target:?}");
            }
            assert!((height(&waypoints.retracted_above) - 0.003).abs() < 1e-15);
            // Vertically below the line in the slot's plane, and at the distance from the axis that was asked for.
            let out = waypoints.retracted_below.center - waypoints.below.center;
            let retracted = waypoints.resting.center + out - Vector3::new(axis[0], axis[1], 0.0);
            let normal = frame.rotation * Vector3::z();
            let center = waypoints.resting.center - Vector3::new(axis[0], axis[1], 0.0);
            let crossing = Vector3::z() * (normal.dot(&center) / normal.z);
            assert!(((retracted - crossing).norm() - 0.4).abs() < 1e-12);
            assert!(
                (waypoints.retracted_above.center - waypoints.above.center - out).norm() < 1e-15
            );
        }
    }

    #[test]
    fn approach_is_radial_or_along_the_station() {
        let radial = station(Approach::Radial, 0.2);
        let waypoints = radial.waypoints(1, [[0.0; 2]; 3]);
        let (near, far) = (waypoints.retracted_below.center.xy(), waypoints.below.center.xy());
        // Both on a line through the axis but for the small offset of the entering plane.
        assert!((near.x * far.y - near.y * far.x).abs() < 1e-4);
        assert_eq!(waypoints.resting.heading, None);
        let line = station(Approach::Line, 0.45);
        let waypoints = line.waypoints(1, [[0.0; 2]; 3]);
        let along = line
            .base_from_station
            .inverse_transform_vector(&(waypoints.below.center - waypoints.retracted_below.center));
        assert!(along.x.abs() < 1e-15 && along.z.abs() < 1e-15 && along.y > 0.0);
        assert!(
            (waypoints.resting.heading.unwrap_or(0.0) - (std::f64::consts::FRAC_PI_2 - 0.2)).abs()
                < 1e-12
        );
    }

    #[test]
    fn approach_past_the_axis_retracts_to_its_nearest_point() {
        let station = station(Approach::Line, 0.01);
        let waypoints = station.waypoints(1, [[0.0; 2]; 3]);
        let inward = station.base_from_station.rotation * Vector3::y();
        let retracted = waypoints.retracted_below.center;
        assert!(retracted.xy().norm() > 0.01);
        assert!(retracted.xy().dot(&inward.xy()).abs() < 1e-3);
    }
}
