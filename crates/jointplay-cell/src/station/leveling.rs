//! Correction of stations that tilt too far for the platform.

use jointplay_core::spatial::{Tilt, heading};
use nalgebra::Vector3;

use super::description::Station;
use super::teach;
use crate::robot::{HybridRobot, WaferTarget};
use crate::wafer::Unreachable;
use crate::workcell::Cell;

/// Number of bisections for the largest feasible tilt: to less than a nanoradian.
const HALVINGS: usize = 30;

impl Station {
    /// Angle by which the station tilts farther than the platform can, the deflection of arms not included; 0 within the limit (rad).
    #[must_use]
    pub fn excess_tilt(&self, robot: &HybridRobot) -> f64 {
        let tilt = Tilt::from_normal(&(self.base_from_station.rotation * Vector3::z()));
        (tilt.angle - robot.gpr.limits().tilt_max).max(0.0)
    }
}

impl Cell {
    /// Least angle by which the tilt of a station has to be reduced about its origin, so that the platform can follow it at every slot with every effector that may use it, the deflection of the loaded arms compensated (rad).
    ///
    /// `None` where the platform can follow the tilt, and where leveling does not help.
    /// Targets that are out of reach for other reasons are ignored.
    ///
    /// # Numerics
    /// Bisection for the lowest and the highest slot: the deflection grows with the reach, which changes linearly from slot to slot.
    #[must_use]
    pub fn leveling(&self, station: &Station) -> Option<f64> {
        let tilt = Tilt::from_normal(&(station.base_from_station.rotation * Vector3::z()));
        if self.can_follow(station) {
            return None;
        }
        let leveled = |angle: f64| {
            let origin = station.base_from_station.translation.vector;
            let normal = Tilt { angle, ..tilt }.normal();
            let heading = heading(&station.base_from_station);
            Station { base_from_station: teach::frame(origin, &normal, heading), ..station.clone() }
        };
        if !self.can_follow(&leveled(0.0)) {
            return None;
        }
        let (mut low, mut high) = (0.0, tilt.angle);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.can_follow(&leveled(middle)) { low = middle } else { high = middle }
        }
        Some(tilt.angle - low)
    }

    /// Whether the platform can tilt as far as the targets of a station need.
    fn can_follow(&self, station: &Station) -> bool {
        let home: Vec<f64> = self.robot.axes.iter().map(|axis| axis.home).collect();
        station.effectors.iter().all(|&effector| {
            [1, station.slots].into_iter().all(|slot| {
                let places = station.waypoints(slot, [[0.0; 2]; 3]);
                let follows = |target: &WaferTarget| {
                    let found = self.compensated_inverse(effector, target, true, &home);
                    !matches!(found, Err(Unreachable::Tilt { .. }))
                };
                [&places.resting, &places.above, &places.retracted_above].into_iter().all(follows)
            })
        })
    }
}
