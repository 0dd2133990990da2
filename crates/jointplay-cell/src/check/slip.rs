//! Whether friction holds a wafer.

use nalgebra::Vector3;

use crate::cell::Cell;
use crate::motion::Sample;
use crate::robot::EffectorId;
use crate::wafer::Unreachable;

/// What a wafer's effector has to push it sideways with, and what friction can, by mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Push {
    /// Needed along the wafer's plane [m/s²].
    pub(super) needed: f64,
    /// Held by friction [m/s²].
    pub(super) held: f64,
}

/// Half the step of the second difference [s]: short against what jerk does, long against round-off.
const STEP: f64 = 1e-4;

/// What holds the wafer of an effector on its way.
///
/// ```text
///    f = c̈ + g e_b3        |f − (f·n) n|  ≤  µ f·n
/// ```
/// with the acceleration c̈ of the wafer's centre in the base frame, all turning included, and the normal n of its plane: in-plane acceleration and gravity along the tilted plane against normal acceleration and g cos α.
///
/// # Errors
/// As [`Cell::wafer_pose`].
///
/// # Numerics
/// c̈ is the second difference of the centre over the parabola of velocities and accelerations through the sample: off by the square of the step.
///
/// # Assumptions
/// Coulomb friction at the centre of mass: what the pads bear of the wafer's turning about its own centre is left out.
pub(super) fn push(
    cell: &Cell,
    sample: &Sample,
    effector: EffectorId,
) -> Result<Push, Unreachable> {
    let on_parabola = |t: f64| -> Vec<f64> {
        let axes = 0..sample.positions.len();
        axes.map(|k| {
            sample.positions[k] + t * (sample.velocities[k] + 0.5 * t * sample.accelerations[k])
        })
        .collect()
    };
    let now = cell.wafer_pose(effector, &sample.positions, true)?;
    let before = cell.wafer_pose(effector, &on_parabola(-STEP), true)?;
    let after = cell.wafer_pose(effector, &on_parabola(STEP), true)?;
    let center = now.translation.vector;
    let acceleration = ((after.translation.vector - center) - (center - before.translation.vector))
        / (STEP * STEP);
    let force = acceleration + Vector3::new(0.0, 0.0, cell.gravity);
    let normal: Vector3<f64> = now.rotation.matrix().column(2).into_owned();
    let pressed = force.dot(&normal);
    let friction = cell.robot.arms[effector.arm].effectors[effector.effector].friction;
    Ok(Push { needed: (force - normal * pressed).norm(), held: friction * pressed.max(0.0) })
}
