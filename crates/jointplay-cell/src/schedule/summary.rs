//! The schedule of a trajectory.

use super::critical_path::{CriticalPath, critical_path};
use super::periodic::{PeriodicPart, periodic_parts};
use super::stays::{TimedStay, timed_stays};
use super::utilization::{RobotUtilization, StationUtilization, station_utilizations};
use crate::EntityId;
use crate::program::WaferLocations;
use crate::trajectory::Trajectory;
use crate::workcell::Cell;

/// When which wafer is where, what the robot waits for, and what determines the duration.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// Identities of all wafers.
    pub wafers: Vec<EntityId>,
    /// Stays of all wafers, by wafer and in the order of time.
    pub stays: Vec<TimedStay>,
    /// Use of the robot.
    pub robot: RobotUtilization,
    /// Use of each station, by index.
    pub stations: Vec<StationUtilization>,
    /// What determines the duration of the whole program.
    pub critical_path: CriticalPath,
    /// Parts in which hand-offs repeat, in the order of time.
    pub periodic_parts: Vec<PeriodicPart>,
    /// Duration of the program (s).
    pub duration: f64,
}

impl Schedule {
    /// The longest periodic part: the steady state of the program.
    #[must_use]
    pub fn steady_state(&self) -> Option<&PeriodicPart> {
        let length = |part: &&PeriodicPart| part.end - part.start;
        // Of equal parts the first.
        self.periodic_parts.iter().rev().max_by(|one, other| length(one).total_cmp(&length(other)))
    }
}

/// The schedule of a trajectory in its cell.
#[must_use]
pub fn schedule(cell: &Cell, trajectory: &Trajectory) -> Schedule {
    let locations = WaferLocations::of_steps(cell, &trajectory.steps);
    let stays = timed_stays(trajectory, &locations);
    let robot = RobotUtilization::new(cell, trajectory);
    let changes = locations.location_changes();
    let wafer_of = |step: usize| {
        let found = changes.binary_search_by_key(&step, |change| change.step).ok()?;
        Some(changes[found].wafer)
    };
    Schedule {
        wafers: locations.wafers().map(|wafer| locations.wafer_id(wafer)).collect(),
        stations: station_utilizations(cell, &stays, &robot),
        stays,
        robot,
        critical_path: critical_path(trajectory, 0..trajectory.steps.len()),
        periodic_parts: periodic_parts(trajectory, wafer_of),
        duration: trajectory.duration(),
    }
}
