//! Targets that no positions of the axes reach.

use super::droop::DroopError;
use crate::CellError;
use crate::robot::{Configuration, LimitViolation, OutOfReach};

/// Reason why no positions bring a wafer to a target.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unreachable {
    /// The kinematics of the robot cannot be computed there.
    #[error(transparent)]
    Robot(#[from] CellError),
    /// The droop of the arm is not known there.
    #[error(transparent)]
    Droop(#[from] DroopError),
    /// The platform cannot tilt far enough.
    #[error(
        "the platform would have to tilt by {needed} rad, but tilts by at most {allowed} rad: {residual} rad would be left, and {threshold} rad are allowed"
    )]
    Tilt {
        /// Tilt that the target needs, droop included (rad).
        needed: f64,
        /// Largest tilt of the platform (rad).
        allowed: f64,
        /// Angle to the target's plane that would be left (rad).
        residual: f64,
        /// Largest angle that may be left (rad).
        threshold: f64,
    },
    /// The links of the arm are too short, or cannot fold that far.
    #[error(
        "the links would have to span {} m, but span {} to {} m", .0.distance, .0.min, .0.max
    )]
    OutOfReach(OutOfReach),
    /// Every branch that reaches the target violates a limit.
    #[error("every branch violates a limit: {}", listed(.0))]
    Limits(Vec<RejectedBranch>),
    /// The solver found no branch.
    #[error("no positions were found that bring the wafer there")]
    NoBranch,
    /// The compensation of the droop does not converge: the droop changes too fast with the reach.
    #[error(
        "the droop compensation did not converge: a residual of {residual} m is left after {iterations} iterations"
    )]
    NotConverged {
        /// Distance from the target that is left (m).
        residual: f64,
        /// Number of iterations.
        iterations: usize,
    },
}

/// A branch that reaches a target, and the limits that it violates.
#[derive(Debug, Clone, PartialEq)]
pub struct RejectedBranch {
    /// Elbow and reach direction of the arm.
    pub configuration: Configuration,
    /// Limits that the branch violates.
    pub violations: Vec<LimitViolation>,
}

fn listed(branches: &[RejectedBranch]) -> String {
    let branch = |branch: &RejectedBranch| {
        let limits: Vec<String> = branch.violations.iter().map(ToString::to_string).collect();
        format!("{} ({})", branch.configuration, limits.join("; "))
    };
    branches.iter().map(branch).collect::<Vec<_>>().join(", ")
}
