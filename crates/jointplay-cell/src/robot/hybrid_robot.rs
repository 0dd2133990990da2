//! Description of a three-rod robot with planar arms.

use jointplay_core::gpr::Gpr;

use super::model::PlatformModel;

/// Number of rods; their axes come first.
pub const RODS: usize = 3;

/// Largest number of joints of an arm.
pub const MAX_JOINTS: usize = 4;

/// Largest number of arms.
pub const MAX_ARMS: usize = 2;

/// Largest number of effectors of an arm.
pub const MAX_EFFECTORS: usize = 4;

/// Largest number of axes: rods, and a motor for each joint.
pub const MAX_AXES: usize = RODS + MAX_ARMS * MAX_JOINTS;

/// Limits of the motion of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KinematicLimits {
    /// Largest velocity (m/s or rad/s).
    pub velocity: f64,
    /// Largest acceleration (m/s² or rad/s²).
    pub acceleration: f64,
    /// Largest jerk (m/s³ or rad/s³).
    pub jerk: f64,
}

/// Kind of motion of an axis or a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisKind {
    /// Rotation (rad): of an arm's joint, about the platform normal.
    Rotary,
    /// Translation (m): of a rod, along its vertical axis; of an arm's joint, along the x axis of the link before.
    Linear,
}

/// An axis: the motor of a rod, or of the arms on the platform.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Name in files and programs: `q1`, `T`, `R`, …
    pub name: String,
    /// Kind of motion.
    pub kind: AxisKind,
    /// Least position (m or rad).
    pub min: f64,
    /// Largest position (m or rad).
    pub max: f64,
    /// Position after HOME (m or rad).
    pub home: f64,
    /// Limits while no effector that the axis moves carries a wafer.
    pub empty: KinematicLimits,
    /// Limits while an effector that the axis moves carries a wafer.
    pub loaded: KinematicLimits,
}

/// A joint of an arm, and the link after it.
///
/// ```text
///    joint value  =  zero + Σ_a ratio_a · position of axis a
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ArmJoint {
    /// Rotation about the platform normal, or translation along the x axis of the link before.
    pub kind: AxisKind,
    /// Value where all axes are at zero (m or rad).
    pub zero: f64,
    /// Axes that drive the joint, as indices into [`HybridRobot::axes`] from [`RODS`] on, each with its transmission ratio.
    pub drives: Vec<(usize, f64)>,
    /// Distance to the next joint along the x axis of the link after this joint (m); on the last link the position of the wafer takes its place.
    pub length: f64,
    /// Distance to the next joint along the y axis of the link after this joint (m).
    pub offset: f64,
    /// Height of the link after this joint above the link before, along the platform normal (m).
    pub rise: f64,
}

/// An end effector: it holds a wafer.
#[derive(Debug, Clone, PartialEq)]
pub struct Effector {
    /// Name in programs: `A`, `B`, …
    pub name: String,
    /// Centre of the wafer in the frame of the last link (x along the link, y, z up), in the plane that the wafer rests on (m).
    pub wafer_center: [f64; 3],
    /// Heading of the wafer, about the platform normal from the last link (rad).
    pub heading: f64,
    /// Support of the wafer.
    pub support: crate::wafer::Support,
    /// Coefficient of friction between wafer and pads.
    pub friction: f64,
}

/// A planar serial arm on the platform.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// Name.
    pub name: String,
    /// First joint in the platform frame: x, y, and the height z of the first joint's plane (m).
    pub mount: [f64; 3],
    /// Joints from the platform outward; one to four.
    pub joints: Vec<ArmJoint>,
    /// End effectors; one or more.
    pub effectors: Vec<Effector>,
    /// Deflection under the arm's own weight and its load.
    pub droop: crate::wafer::Droop,
}

/// A three-rod robot with its arms.
#[derive(Debug, Clone, PartialEq)]
pub struct HybridRobot {
    /// Name.
    pub name: String,
    /// The three-rod robot under the platform.
    pub gpr: Gpr,
    /// Model of the platform's pose over the rods.
    pub model: PlatformModel,
    /// Axes: rods first, then the motors of the arms.
    pub axes: Vec<Axis>,
    /// Arms; one or two.
    pub arms: Vec<Arm>,
    /// Assumed parameters, each as text `key: reason` with the key of the robot file.
    pub assumed: Vec<String>,
}

/// Identity of an effector of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EffectorId {
    /// Index of the arm.
    pub arm: usize,
    /// Index of the effector on its arm.
    pub effector: usize,
}

impl HybridRobot {
    /// Whether a motor turns whole arms about their first joints and does nothing else.
    pub(crate) fn turns_whole_arms(&self, axis: usize) -> bool {
        let joints = self.arms.iter().flat_map(|arm| arm.joints.iter().enumerate());
        let mut driven = joints.filter(|(_, joint)| joint.drives.iter().any(|it| it.0 == axis));
        axis >= RODS && driven.all(|(index, joint)| index == 0 && joint.kind == AxisKind::Rotary)
    }
}
