//! Positions of arms that are retracted for a station.

use nalgebra::Vector3;

use crate::robot::{EffectorId, RODS, WaferTarget};
use crate::workcell::Cell;

/// Positions of an arm's motors with its wafer at the retract distance of a station, over a level platform.
pub(super) fn retracted_positions(
    cell: &Cell,
    effector: EffectorId,
    station: usize,
) -> Option<Vec<(usize, f64)>> {
    let robot = &cell.robot;
    let home: Vec<f64> = robot.axes.iter().map(|axis| axis.home).collect();
    let [x, y, _] = robot.arms[effector.arm].mount;
    let height = robot.effector_pose(&home, effector).ok()?.translation.z;
    let center = Vector3::new(x + cell.stations[station].retract_reach, y, height);
    let target = WaferTarget { center, normal: Vector3::z(), heading: None };
    let found = robot.inverse(effector, &target, &home).ok()?;
    let branch = found.branches.get(found.chosen?)?;
    let motors = robot.axes_of(effector).ok()?.into_iter().filter(|&axis| axis >= RODS);
    Some(motors.map(|axis| (axis, branch.positions[axis])).collect())
}
