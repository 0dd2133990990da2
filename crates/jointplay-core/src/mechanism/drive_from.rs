//! Driving a mechanism of any size, with or without virtual joints.

use std::ops::ControlFlow;

use nalgebra::DVector;

use super::coupling_conflicts::determined;
use super::home::close_at_rest;
use super::{
    DrivePath, DrivenMotion, Mechanism, MechanismSystem, SparseSystem, drive_along, drive_relieved,
};
use crate::Error;

/// Number of steps of a motion whose steps do not matter, such as the one to the start of a path.
pub const DEFAULT_STEPS: usize = 60;

/// Drives joint coordinates along a path: by dense algebra, with the least displacements of virtual joints if there are any, or by sparse algebra if there are many loops.
///
/// # Arguments
/// * `start` – (f + M) a closed configuration, the driven coordinates at the first point of the path (m, rad)
/// * `held` – indices of other joint coordinates that keep their values, see [`held_actuators`]
/// * `count` – number of steps to report
/// * `tolerance` – largest mismatch of the configuration at rest that counts as closed; `None` for loops that close exactly
/// * `progress` – called again and again, with the number of reported steps that are done; ends the motion by [`ControlFlow::Break`]
///
/// # Errors
/// [`Error::Interrupted`]; those of [`drive_along`], [`drive_relieved`] and [`SparseSystem::drive_along`]; of a mechanism with virtual joints those of [`close_at_rest`].
pub fn drive_from(
    mechanism: &Mechanism,
    start: &DVector<f64>,
    path: &DrivePath,
    held: &[usize],
    count: usize,
    tolerance: Option<f64>,
    progress: &mut dyn FnMut(usize) -> ControlFlow<()>,
) -> Result<DrivenMotion, Error> {
    if !MechanismSystem::fits(mechanism) {
        let system = SparseSystem::new(mechanism, start.clone())?;
        return system.drive_along(path, held, count, progress);
    }
    let driven = path.coordinates();
    let free: Vec<usize> = (0..mechanism.joint_freedoms())
        .filter(|k| !driven.contains(k) && !held.contains(k))
        .collect();
    let system = MechanismSystem::new(mechanism, start.clone())?;
    if mechanism.virtual_joints().is_empty() {
        return drive_along(&system, path, &free, count, progress);
    }
    let at_rest = close_at_rest(mechanism, tolerance)?.coordinates;
    let home = MechanismSystem::new(mechanism, at_rest)?;
    drive_relieved(&home, &system, path, &free, count, progress)
}

/// Coordinates of the actuators that are held while others are driven: those that are not driven and that no coupling determines from the driven and held ones, or none if a joint without an actuator is driven.
#[must_use]
pub fn held_actuators(mechanism: &Mechanism, driven: &[usize]) -> Vec<usize> {
    let actuated = mechanism.actuated_coordinates();
    if !driven.iter().all(|k| actuated.contains(k)) {
        return Vec::new();
    }
    let mut held: Vec<usize> = actuated.into_iter().filter(|k| !driven.contains(k)).collect();
    held.sort_unstable();
    let determined = determined(mechanism, driven, &held);
    held.retain(|k| !determined.contains(k));
    held
}
