//! How far what moves can have gone between two samples, at most.

use super::scene::{Holder, Item};
use crate::motion::Sample;
use crate::robot::{HybridRobot, MAX_AXES, MotionKind, RODS};

/// Slack for what the bounds leave out: the platform's shift and twist by its tilt, of the size of the tilt, and the droop's change by reach.
const SLACK: f64 = 1.1;

/// How far points of one item go by the axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Levers {
    /// By each motor of the arms [m/m or m/rad].
    arms: [f64; MAX_AXES],
    /// Largest distance of a point from the platform's origin [m].
    far: f64,
}

/// How far points of an item went, at most.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Travel {
    /// By the rods [m].
    pub(super) plane: f64,
    /// By the arms, parallel to the platform [m].
    pub(super) arm: f64,
}

impl Travel {
    pub(super) fn total(self) -> f64 {
        self.plane + self.arm
    }
}

/// What all axes did between two samples, at most.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moved {
    /// Path of each axis [m or rad].
    axes: [f64; MAX_AXES],
    /// Path of the platform's height over its origin [m].
    height: f64,
    /// Angle that its normal turned by [rad].
    pub(super) lean: f64,
}

/// The base triangle, as far as it gears rods to the platform.
pub(super) struct Gearing {
    /// Sum of the absolute weights by which the rods lift the platform's origin.
    weights: f64,
    /// Heights of the base triangle over each side [m], at the corner of each rod.
    heights: [f64; RODS],
    radius: f64,
}

impl Gearing {
    pub(super) fn new(robot: &HybridRobot) -> Self {
        let b = robot.gpr.base_points();
        let area = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        let corner = |k: usize| [b[k].x, b[k].y];
        let whole = area(corner(0), corner(1), corner(2));
        let origin = [0.0, 0.0];
        let weight = |k: usize| area(corner((k + 1) % 3), corner((k + 2) % 3), origin) / whole;
        let side = |k: usize| (b[(k + 1) % 3] - b[(k + 2) % 3]).norm();
        Self {
            weights: (0..RODS).map(|k| weight(k).abs()).sum(),
            heights: [0, 1, 2].map(|k| whole.abs() / side(k)),
            radius: b.iter().map(|point| point.norm()).fold(0.0, f64::max),
        }
    }

    /// What all axes did between two samples, at most.
    pub(super) fn moved(&self, from: &Sample, to: &Sample) -> Moved {
        let dt = to.time - from.time;
        let mut axes = [0.0; MAX_AXES];
        for (axis, moved) in axes.iter_mut().enumerate().take(from.positions.len()) {
            *moved =
                path(dt, |s| (s.velocities[axis], s.accelerations[axis], s.jerks[axis]), from, to);
        }
        let mean = |values: &[f64]| (values[0] + values[1] + values[2]) / 3.0;
        let lean: f64 = (0..RODS)
            .map(|rod| {
                let off = |s: &Sample| {
                    (
                        s.velocities[rod] - mean(&s.velocities),
                        s.accelerations[rod] - mean(&s.accelerations),
                        s.jerks[rod] - mean(&s.jerks),
                    )
                };
                path(dt, off, from, to) / self.heights[rod]
            })
            .sum();
        let rods = axes[..RODS].iter().copied().fold(0.0, f64::max);
        Moved { axes, height: self.weights * rods, lean: SLACK * lean }
    }

    /// How far points of an item went, at most.
    pub(super) fn travel(&self, levers: &Levers, moved: &Moved) -> Travel {
        let plane = moved.height + moved.lean * (levers.far + 0.5 * self.radius);
        let arm: f64 = levers.arms.iter().zip(&moved.axes).map(|(lever, path)| lever * path).sum();
        Travel { plane: SLACK * plane, arm: SLACK * arm }
    }
}

/// Length of the way of one coordinate between two samples, at most: its largest speed for the whole time.
fn path(dt: f64, of: impl Fn(&Sample) -> (f64, f64, f64), from: &Sample, to: &Sample) -> f64 {
    let ((v0, a0, j0), (v1, a1, j1)) = (of(from), of(to));
    let acceleration = a0.abs().max(a1.abs()) + dt * j0.abs().max(j1.abs());
    dt * (v0.abs().max(v1.abs()) + 0.5 * dt * acceleration)
}

impl Levers {
    /// Of an item that moves.
    pub(super) fn new(robot: &HybridRobot, item: &Item) -> Self {
        let mut arms = [0.0; MAX_AXES];
        let (arm, links, own) = match item.holder {
            Holder::Link { arm, link } => (arm, link + 1, item.solid.reach()),
            Holder::Effector(id) => {
                let effector = &robot.arms[id.arm].effectors[id.effector];
                let [x, y, z] = effector.wafer_center;
                let out = x.hypot(y).hypot(z) + item.solid.reach();
                (id.arm, robot.arms[id.arm].joints.len(), out)
            }
            Holder::Platform | Holder::World | Holder::Slot(_) => {
                return Self { arms, far: item.solid.reach() };
            }
        };
        let described = &robot.arms[arm];
        // From the item inward, the farthest that it can be from each joint.
        let mut out = own;
        for (place, joint) in described.joints[..links].iter().enumerate().rev() {
            if place + 1 < links {
                out += joint.length.hypot(joint.offset);
            }
            for &(axis, ratio) in &joint.drives {
                arms[axis] += ratio.abs()
                    * match joint.kind {
                        MotionKind::Turn => out,
                        MotionKind::Slide => 1.0,
                    };
            }
            if joint.kind == MotionKind::Slide {
                out += slide(robot, joint);
            }
            out += joint.rise.abs();
        }
        let [x, y, z] = described.mount;
        Self { arms, far: out + x.hypot(y).hypot(z) }
    }
}

/// The farthest that a sliding joint goes out [m].
fn slide(robot: &HybridRobot, joint: &crate::robot::ArmJoint) -> f64 {
    let most: f64 = joint
        .drives
        .iter()
        .map(|&(axis, ratio)| {
            let axis = &robot.axes[axis];
            ratio.abs() * axis.min.abs().max(axis.max.abs())
        })
        .sum();
    joint.zero.abs() + most
}
