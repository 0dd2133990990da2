//! An arm at given positions, seen from above.

use jointplay_cell::robot::{ChainPose, EffectorId};
use jointplay_cell::workcell::{Cell, ParentFrame};

use super::outline::outline;

/// The arm of an effector at the positions of a hand-off.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmPosture {
    /// The effector.
    pub effector: EffectorId,
    /// Poses of the links and wafers of the robot.
    pub pose: ChainPose,
}

impl ArmPosture {
    /// Joints of the arm from the first to the last, then the wafer centre (m).
    pub(super) fn joints(&self) -> Vec<[f64; 2]> {
        let links = &self.pose.base_from_link[self.effector.arm];
        let joints = links.iter().map(|link| [link.translation.x, link.translation.y]);
        joints.chain([self.wafer_centre()]).collect()
    }

    pub(super) fn wafer_centre(&self) -> [f64; 2] {
        let at = &self.pose.base_from_wafer[self.effector.arm][self.effector.effector].translation;
        [at.x, at.y]
    }

    /// Outlines of the bodies on the links of the arm (m).
    pub(super) fn outlines(&self, cell: &Cell) -> Vec<Vec<[f64; 2]>> {
        let links = &self.pose.base_from_link[self.effector.arm];
        let of_arm = cell.bodies.iter().filter_map(|body| match body.parent {
            ParentFrame::Link { arm, link } if arm == self.effector.arm => {
                Some(outline(&body.shape, &(links[link] * body.parent_from_shape)))
            }
            _ => None,
        });
        of_arm.collect()
    }
}
