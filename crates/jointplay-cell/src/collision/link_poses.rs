//! Poses of all moving bodies at one time.

use jointplay_core::spatial::Pose;
use nalgebra::Vector3;

use crate::violation::ViolationKind;
use crate::wafer::DroopError;

/// Poses of the platform, the links and the effectors in the base frame at one time.
#[derive(Debug)]
pub(crate) struct LinkPoses {
    pub(super) base_from_platform: Pose,
    /// Normal of the platform in the base frame.
    pub(crate) normal: Vector3<f64>,
    /// Arm by arm, in the order of [`Cell::append_arm_poses`](crate::workcell::Cell): links, then for each effector the deflected last link and the wafer.
    pub(super) poses: Vec<Pose>,
}

impl LinkPoses {
    /// The buffer of the poses, for reuse.
    pub(crate) fn into_buffer(mut self) -> Vec<Pose> {
        self.poses.clear();
        self.poses
    }
}

/// Why the poses of the links are unknown at one time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct PoseError {
    /// [`ViolationKind::Platform`] or [`ViolationKind::Droop`].
    pub(crate) kind: ViolationKind,
    pub(crate) reason: String,
}

impl From<crate::CellError> for PoseError {
    fn from(error: crate::CellError) -> Self {
        Self { kind: ViolationKind::Platform, reason: error.to_string() }
    }
}

impl From<DroopError> for PoseError {
    fn from(error: DroopError) -> Self {
        Self { kind: ViolationKind::Droop, reason: error.to_string() }
    }
}
