//! A closed configuration and its outputs.

use jointplay_core::spatial::{Pose, continued_quaternion};
use nalgebra::DVector;

use super::variable::POSE_OUTPUTS;

/// A closed configuration and its outputs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Solved {
    /// Values of the drives (m, rad).
    pub(super) drives: Vec<f64>,
    /// (f + M) coordinates of a mechanism (m, rad); none of a robot, whose rods are its drives.
    pub(super) coordinates: DVector<f64>,
    /// Poses, then displacements of virtual joints, in the order of the variables.
    pub(super) outputs: Vec<f64>,
}

/// Appends position and unit quaternion of a pose.
///
/// # Arguments
/// * `before` – outputs of the configuration before, for the sign of the quaternion
pub(super) fn push_pose(outputs: &mut Vec<f64>, pose: &Pose, before: Option<&[f64]>) {
    let first = outputs.len();
    let near = before.and_then(|before| quaternion(before, first));
    outputs.extend_from_slice(pose.translation.vector.as_slice());
    outputs.extend(continued_quaternion(&pose.rotation, near.as_ref()));
}

/// The quaternion of the pose whose outputs begin at an index.
pub(super) fn quaternion(outputs: &[f64], first: usize) -> Option<[f64; 4]> {
    outputs.get(first + 3..first + POSE_OUTPUTS)?.try_into().ok()
}
