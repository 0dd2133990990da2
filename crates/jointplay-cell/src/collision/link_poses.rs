//! Poses of all moving links at one time.

use jointplay_core::spatial::Pose;
use nalgebra::Vector3;

use crate::violation::Kind;
use crate::wafer::DroopError;

/// Where all that moves is at one time.
#[derive(Debug)]
pub(crate) struct Places {
    pub(super) base_from_platform: Pose,
    pub(crate) normal: Vector3<f64>,
    /// Arm by arm, as [`Cell::place_arm`] adds them: links, then for each effector the last link deflected, and its wafer.
    pub(super) poses: Vec<Pose>,
}

impl Places {
    /// The room that they took.
    pub(crate) fn into_room(mut self) -> Vec<Pose> {
        self.poses.clear();
        self.poses
    }
}

/// Why the poses of all that moves are unknown at one time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Unplaced {
    /// [`Kind::Platform`] or [`Kind::Droop`].
    pub(crate) kind: Kind,
    pub(crate) why: String,
}

impl From<crate::CellError> for Unplaced {
    fn from(error: crate::CellError) -> Self {
        Self { kind: Kind::Platform, why: error.to_string() }
    }
}

impl From<DroopError> for Unplaced {
    fn from(error: DroopError) -> Self {
        Self { kind: Kind::Droop, why: error.to_string() }
    }
}
