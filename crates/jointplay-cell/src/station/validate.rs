//! Conditions that the description of a station has to fulfil.

use std::collections::BTreeSet;

use jointplay_core::spatial::Tilt;
use nalgebra::Vector3;

use super::description::Station;
use crate::CellError;
use crate::conditions::{count, in_range, lengths, not_negative, pose, positive};
use crate::robot::HybridRobot;

/// Largest number of slots of a station.
pub const MAX_SLOTS: usize = 1000;

/// Relative tolerance on the robot's largest tilt.
const TILT_TOLERANCE: f64 = 1e-9;

/// Longest process time (s).
const MAX_PROCESS_TIME: f64 = 1e12;

impl Station {
    /// Checks the station by itself and for a robot: numbers, effectors, retract distance and tilt.
    ///
    /// # Errors
    /// [`CellError`] of the first condition that is violated.
    pub fn validate(&self, robot: &HybridRobot) -> Result<(), CellError> {
        let of = |what: &str| format!("the {what} of station {}", self.name);
        if self.name.trim().is_empty() {
            return Err(CellError::NoName { what: "a station".to_owned() });
        }
        pose(&format!("station {}", self.name), &self.base_from_station)?;
        count(&of("slots"), self.slots, 1, MAX_SLOTS)?;
        if self.slots > 1 {
            positive(of("pitch"), self.pitch, "m")?;
        }
        not_negative(of("pitch"), self.pitch, "m")?;
        lengths(&of("pitch"), &[self.pitch])?;
        lengths(&of("step between slots"), &self.slot_step)?;
        for (what, value, unit) in [
            ("stroke below the wafer", self.stroke.below, "m"),
            ("stroke above the wafer", self.stroke.above, "m"),
            ("stroke speed", self.stroke.speed, "m/s"),
        ] {
            positive(of(what), value, unit)?;
        }
        lengths(&of("stroke"), &[self.stroke.below, self.stroke.above])?;
        lengths(&of("offset"), &self.offset)?;
        lengths(&of("via points"), self.via.as_flattened())?;
        not_negative(of("retract distance"), self.retract_reach, "m")?;
        in_range(of("process time"), self.process_time, 0.0, MAX_PROCESS_TIME, "s")?;
        count(&of("effectors"), self.effectors.len(), 1, usize::MAX)?;
        let mut known = BTreeSet::new();
        for &id in &self.effectors {
            robot.check_effector(id)?;
            if !known.insert(id) {
                let effector = &robot.arms[id.arm].effectors[id.effector];
                let (what, name) = ("effectors of a station", effector.name.clone());
                return Err(CellError::NameTwice { what, name });
            }
        }
        self.check_retract_reach(robot)?;
        self.check_tilt(robot)
    }

    /// Checks that the retract distance is less than the distance of every slot from the first joint of each arm that serves the station, seen from above over the level platform.
    ///
    /// # Errors
    /// [`CellError::RetractReach`]; [`CellError::NoSuchEffector`] for an effector that the robot does not have.
    pub fn check_retract_reach(&self, robot: &HybridRobot) -> Result<(), CellError> {
        let mut reach = f64::INFINITY;
        for &id in &self.effectors {
            robot.check_effector(id)?;
            let [x, y, _] = robot.arms[id.arm].mount;
            // The slots of a tilted station, or of one whose slots are displaced, are at different distances.
            for slot in 1..=self.slots {
                let center = self.slot_frame(slot).translation.vector;
                reach = reach.min((center.x - x).hypot(center.y - y));
            }
        }
        let found = self.retract_reach;
        if found >= reach {
            return Err(CellError::RetractReach { station: self.name.clone(), found, reach });
        }
        Ok(())
    }

    /// Checks that the platform can tilt as far as the station; the deflection of arms is not included.
    ///
    /// # Errors
    /// [`CellError::StationTilt`]
    pub fn check_tilt(&self, robot: &HybridRobot) -> Result<(), CellError> {
        let tilt = Tilt::from_normal(&(self.base_from_station.rotation * Vector3::z()));
        let max = robot.gpr.limits().tilt_max;
        if tilt.angle <= max * (1.0 + TILT_TOLERANCE) {
            return Ok(());
        }
        Err(CellError::StationTilt { station: self.name.clone(), tilt, max })
    }
}
