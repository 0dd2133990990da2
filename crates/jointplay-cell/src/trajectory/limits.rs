//! Limits of the axes in a step.

use crate::program::Step;
use crate::robot::{EffectorId, HybridRobot, KinematicLimits, RODS};

/// Whether an axis moves an effector: a rod moves all effectors, a motor those of the arms whose joints it drives.
#[must_use]
pub fn axis_moves_effector(robot: &HybridRobot, axis: usize, effector: EffectorId) -> bool {
    axis < RODS
        || robot.arms[effector.arm]
            .joints
            .iter()
            .flat_map(|joint| &joint.drives)
            .any(|&(driver, ratio)| driver == axis && ratio != 0.0)
}

/// Limits of an axis in a step, scaled by the step's share of speed.
#[must_use]
pub fn scaled_axis_limits(robot: &HybridRobot, axis: usize, step: &Step) -> KinematicLimits {
    let limits = axis_limits(robot, axis, step);
    KinematicLimits {
        velocity: limits.velocity * step.speed_scaling,
        acceleration: limits.acceleration * step.speed_scaling,
        jerk: limits.jerk * step.speed_scaling,
    }
}

/// Limits of an axis in a step at full speed.
///
/// The loaded limits apply as soon as one effector that the axis moves carries a wafer, and the empty limits otherwise.
#[must_use]
pub fn axis_limits(robot: &HybridRobot, axis: usize, step: &Step) -> KinematicLimits {
    let loaded = step.loaded.iter().any(|&effector| axis_moves_effector(robot, axis, effector));
    let axis = &robot.axes[axis];
    if loaded { axis.loaded } else { axis.empty }
}
