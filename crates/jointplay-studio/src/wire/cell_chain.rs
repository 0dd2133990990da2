//! Documents of the kinematic chain of a robot.

use jointplay::cell::robot::{self, Arm};
use jointplay::cell::workcell::Cell;
use jointplay::interop::export::HeldAt;
use serde::Serialize;
use utoipa::ToSchema;

use super::{Pair, Triple};
use crate::wire::cell_jogged::AxisKind;

/// Kinematic chain of a robot: the poses of its frames follow from it and from the channels of a window.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ChainDocument {
    /// Intersections of the rod axes with the base plane, x and y (m).
    pub(crate) base_points_m: Vec<Pair>,
    /// Its arms.
    pub(crate) arms: Vec<ArmChain>,
}

/// An arm.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ArmChain {
    /// Position of its first joint in the platform frame (m).
    pub(crate) mount_m: Triple,
    /// Joints from the platform outward.
    pub(crate) joints: Vec<JointChain>,
    /// Its effectors.
    pub(crate) effectors: Vec<EffectorChain>,
}

/// A joint of an arm, and the link after it.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct JointChain {
    /// Revolute about z, or prismatic along x.
    pub(crate) kind: AxisKind,
    /// Joint value with all axes at zero (m or rad).
    pub(crate) zero: f64,
    /// Axes that drive it.
    pub(crate) drives: Vec<DriveChain>,
    /// Position of the next joint in the frame of its link, x and y (m).
    pub(crate) next_m: Pair,
    /// Offset of its link along z (m).
    pub(crate) rise_m: f64,
}

/// An axis that drives a joint.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct DriveChain {
    /// Index of the axis.
    pub(crate) axis: usize,
    /// Transmission ratio.
    pub(crate) ratio: f64,
}

/// An effector: the wafer frame on the last link.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct EffectorChain {
    /// Name.
    pub(crate) name: String,
    /// Origin (m).
    pub(crate) center_m: Triple,
    /// Rotation about z (rad).
    pub(crate) heading_rad: f64,
}

/// Location of a wafer.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct HeldDocument {
    /// Index of the effector; `null` for a wafer in a slot.
    #[schema(required = true)]
    pub(crate) effector: Option<usize>,
    /// Index of the station and number of the slot; `null` for a wafer on an effector.
    #[schema(required = true, min_items = 2, max_items = 2)]
    pub(crate) slot: Option<Vec<usize>>,
    /// Origin (m) and vector part of its unit quaternion: in the wafer frame of the effector, or in the base frame.
    #[schema(min_items = 6, max_items = 6)]
    pub(crate) pose: Vec<f64>,
}

impl ChainDocument {
    pub(crate) fn new(cell: &Cell) -> Self {
        let robot = &cell.robot;
        Self {
            base_points_m: robot.gpr.base_points().map(|point| Pair([point.x, point.y])).to_vec(),
            arms: robot.arms.iter().map(ArmChain::new).collect(),
        }
    }
}

impl ArmChain {
    fn new(arm: &Arm) -> Self {
        let joints = arm.joints.iter().map(|joint| JointChain {
            kind: match joint.kind {
                robot::AxisKind::Rotary => AxisKind::Revolute,
                robot::AxisKind::Linear => AxisKind::Prismatic,
            },
            zero: joint.zero,
            drives: joint.drives.iter().map(|&(axis, ratio)| DriveChain { axis, ratio }).collect(),
            next_m: Pair([joint.length, joint.offset]),
            rise_m: joint.rise,
        });
        let effectors = arm.effectors.iter().map(|effector| EffectorChain {
            name: effector.name.clone(),
            center_m: Triple(effector.wafer_center),
            heading_rad: effector.heading,
        });
        Self {
            mount_m: Triple(arm.mount),
            joints: joints.collect(),
            effectors: effectors.collect(),
        }
    }
}

impl HeldDocument {
    pub(crate) fn new(cell: &Cell, held: &HeldAt) -> Self {
        let index = |id| cell.robot.effectors().position(|one| one == id);
        Self {
            effector: held.location.effector().and_then(index),
            slot: held.location.slot().map(|slot| vec![slot.station, slot.slot]),
            pose: held.pose.to_vec(),
        }
    }
}
