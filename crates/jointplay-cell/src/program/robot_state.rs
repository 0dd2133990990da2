//! State of a robot at rest between two programs.

use crate::robot::HybridRobot;

/// State of a robot at rest, in which a program starts or ends.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotState {
    /// Positions of all axes (m or rad).
    pub positions: Vec<f64>,
    /// Whether all arms are retracted; otherwise, the next instruction that turns the robot retracts them first.
    pub arms_retracted: bool,
    /// Factor of the limits of following moves, see [`Step::speed_scaling`](super::Step::speed_scaling).
    pub speed_scaling: f64,
    /// Blend radius of following moves, see [`Step::blend_radius`](super::Step::blend_radius) (m).
    pub blend_radius: f64,
}

impl RobotState {
    /// All axes at home, full speed, no blends: the state in which a program starts.
    #[must_use]
    pub fn home(robot: &HybridRobot) -> Self {
        let positions = robot.axes.iter().map(|axis| axis.home).collect();
        Self { positions, arms_retracted: true, speed_scaling: 1.0, blend_radius: 0.0 }
    }
}
