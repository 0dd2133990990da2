//! Whether friction holds a wafer.

use jointplay_core::gpr::Forward;
use jointplay_core::spatial::Pose;
use nalgebra::Vector3;

use super::scene::Scene;
use crate::motion::Sample;
use crate::robot::{EffectorId, Positions, RODS};

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
/// Those of the platform and of the droop.
///
/// # Numerics
/// `platform` and `now` are its pose and that of the wafer at the sample; c̈ is the second difference of the centre over the parabola of velocities and accelerations through the sample: off by the square of the step.
///
/// # Assumptions
/// Coulomb friction at the centre of mass: what the pads bear of the wafer's turning about its own centre is left out.
pub(super) fn push(
    scene: &Scene<'_>,
    sample: &Sample,
    effector: EffectorId,
    platform: &Forward,
    now: &Pose,
) -> Result<Push, String> {
    let cell = scene.cell;
    let center = now.translation.vector;
    let still = |values: &[f64]| values.iter().all(|value| *value == 0.0);
    let acceleration = if still(&sample.velocities) && still(&sample.accelerations) {
        Vector3::zeros()
    } else {
        let on_parabola = |t: f64| {
            let mut moved = Positions::new(&sample.positions);
            for (k, position) in moved.iter_mut().enumerate() {
                *position += t * (sample.velocities[k] + 0.5 * t * sample.accelerations[k]);
            }
            // While the rods stand, so does the platform.
            let pose = if moved[..RODS] == platform.rods {
                scene.wafer(platform, effector, &moved)
            } else {
                let moving = cell.robot.platform(&moved).map_err(|error| error.to_string())?;
                scene.wafer(&moving, effector, &moved)
            };
            pose.map(|pose| pose.translation.vector)
        };
        ((on_parabola(STEP)? - center) - (center - on_parabola(-STEP)?)) / (STEP * STEP)
    };
    let force = acceleration + Vector3::new(0.0, 0.0, cell.gravity);
    let normal: Vector3<f64> = now.rotation.matrix().column(2).into_owned();
    let pressed = force.dot(&normal);
    let friction = cell.robot.arms[effector.arm].effectors[effector.effector].friction;
    Ok(Push { needed: (force - normal * pressed).norm(), held: friction * pressed.max(0.0) })
}
