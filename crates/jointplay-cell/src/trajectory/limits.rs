//! What each axis may do during a step.

use crate::program::Step;
use crate::robot::{EffectorId, HybridRobot, KinematicLimits, RODS};

/// Whether an axis moves an effector: a rod moves all, a motor those of the arms whose joints it drives.
#[must_use]
pub fn axis_moves_effector(robot: &HybridRobot, axis: usize, effector: EffectorId) -> bool {
    axis < RODS
        || robot.arms[effector.arm]
            .joints
            .iter()
            .flat_map(|joint| &joint.drives)
            .any(|&(driver, ratio)| driver == axis && ratio != 0.0)
}

/// Limits of an axis during a step: empty or loaded, times the step's share of speed.
///
/// The loaded limits hold as soon as one effector that the axis moves carries a wafer.
#[must_use]
pub fn scaled_axis_limits(robot: &HybridRobot, axis: usize, step: &Step) -> KinematicLimits {
    let limits = axis_limits(robot, axis, step);
    KinematicLimits {
        velocity: limits.velocity * step.speed,
        acceleration: limits.acceleration * step.speed,
        jerk: limits.jerk * step.speed,
    }
}

/// Limits of an axis during a step, whatever share of them the program asks for.
pub fn axis_limits(robot: &HybridRobot, axis: usize, step: &Step) -> KinematicLimits {
    let loaded = step.loaded.iter().any(|&effector| axis_moves_effector(robot, axis, effector));
    let axis = &robot.axes[axis];
    if loaded { axis.loaded } else { axis.empty }
}
