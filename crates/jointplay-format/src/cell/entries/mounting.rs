//! Heights of arms, for an arm that is mounted above the others.

use jointplay_cell::robot::{Arm, HybridRobot};
use jointplay_cell::workcell::{Body, Cell, ParentFrame};
use nalgebra::Point3;

use super::super::file::{read, robot_of};
use super::super::files::Files;
use crate::units::mm;

/// Vertical distance between arms (m).
const GAP: f64 = 0.02;
/// Height assumed above and below arms whose bodies are not known (m).
const UNKNOWN_BODIES: f64 = 0.05;
/// Thickness assumed for wafers that are not known (m).
const UNKNOWN_WAFER: f64 = 0.001;

/// Heights in the platform frame.
pub(super) struct Heights {
    /// Top of the platform and of all arms with their bodies and wafers (m).
    top: f64,
    /// Lowest point of each arm with its bodies (m).
    bottoms: Vec<f64>,
    gap: f64,
}

impl Heights {
    /// The heights of a cell, or of its robot alone if the cell has errors; `None` without a valid robot.
    pub(super) fn of(text: &str, files: &mut Files) -> Option<Self> {
        if let Ok(cell) = read(text, files) {
            return Some(Self::of_robot(&cell.robot, Some(&cell)));
        }
        Some(Self::of_robot(&robot_of(text, files)?, None))
    }

    fn of_robot(robot: &HybridRobot, cell: Option<&Cell>) -> Self {
        let bodies = cell.map_or(&[][..], |cell| cell.bodies.as_slice());
        let wafer = cell.map_or(UNKNOWN_WAFER, |cell| cell.wafer.thickness);
        let margin = if cell.is_some() { 0.0 } else { UNKNOWN_BODIES };
        let of_arm = |(index, arm): (usize, &Arm)| {
            let links = link_heights(arm);
            let last = links.last().copied().unwrap_or_default();
            let wafers = arm.effectors.iter().map(|one| last + one.wafer_center[2]);
            let of_bodies = bodies.iter().flat_map(|body| match body.parent {
                ParentFrame::Link { arm, link } if arm == index => {
                    extent(body).map(|height| links[link] + height).into()
                }
                _ => Vec::new(),
            });
            let wafers: Vec<f64> = wafers.flat_map(|height| [height, height + wafer]).collect();
            let all: Vec<f64> = links.iter().copied().chain(wafers).chain(of_bodies).collect();
            let bottom = all.iter().copied().fold(f64::INFINITY, f64::min);
            let top = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            [bottom - margin, top + margin]
        };
        let arms: Vec<[f64; 2]> = robot.arms.iter().enumerate().map(of_arm).collect();
        let platform = bodies.iter().filter(|body| body.parent == ParentFrame::Platform);
        let tops = arms.iter().map(|[_, top]| *top);
        let top = tops.chain(platform.map(|body| extent(body)[1])).fold(0.0, f64::max);
        let gap = GAP + cell.map_or(0.0, |cell| cell.clearance);
        Self { top, bottoms: arms.into_iter().map(|[bottom, _]| bottom).collect(), gap }
    }

    /// Height of the mount of a new arm whose lowest body is this far below it, in whole millimetres (mm).
    pub(super) fn mount_mm(&self, below: f64) -> f64 {
        mm(self.top + self.gap + below).ceil()
    }

    /// Distance by which a duplicate of an arm is mounted above it, in whole millimetres (mm).
    pub(super) fn raise_mm(&self, arm: usize) -> f64 {
        let bottom = self.bottoms.get(arm).copied().unwrap_or_default();
        mm(self.top + self.gap - bottom).ceil()
    }
}

/// Height of each link's frame (m).
fn link_heights(arm: &Arm) -> Vec<f64> {
    let mut height = arm.mount[2];
    let of_joint = |joint: &jointplay_cell::robot::ArmJoint| {
        height += joint.rise;
        height
    };
    arm.joints.iter().map(of_joint).collect()
}

/// Lowest and highest point of a body in its parent frame (m).
fn extent(body: &Body) -> [f64; 2] {
    let height = |vertex: &[f64; 3]| (body.parent_from_shape * Point3::from(*vertex)).z;
    let surface = body.shape.surface();
    let start = [f64::INFINITY, f64::NEG_INFINITY];
    surface.vertices.iter().map(height).fold(start, |[low, high], z| [low.min(z), high.max(z)])
}
