//! A three-rod robot that carries planar arms.
//!
//! | file | role |
//! | --- | --- |
//! | `validate` | what makes a robot |
//! | `model` | where the platform sits over the rods, by a virtualization |
//! | `arm_chain` | an arm as arrows that turn in its plane |
//! | `forward`, `jacobian`, `acceleration` | from positions to poses, how fast, and with which accelerations |
//! | `reach` | how far an effector comes |
//! | `inverse` | from a wafer's plane, centre and heading to all positions that reach it |

mod acceleration;
mod arm_chain;
mod forward;
mod inverse;
mod jacobian;
mod model;
mod positions;
mod reach;
mod validate;

pub use acceleration::{AxesMotion, FrameMotion};
pub(crate) use arm_chain::ArmChain;
pub use forward::{ChainPose, EffectorDisplacement};
pub use inverse::{
    Branch, BranchSelection, Configuration, Elbow, Inverse, LimitViolation, OutOfReach, Reaching,
    WaferTarget,
};
pub use jacobian::EffectorJacobian;
pub use model::PlatformModel;
pub use positions::Positions;
pub use validate::RobotPart;

use jointplay_core::gpr::Gpr;

/// Number of rods; their positions come first among those of all axes.
pub const RODS: usize = 3;

/// Most joints of an arm.
pub const MAX_JOINTS: usize = 4;

/// Most arms.
pub const MAX_ARMS: usize = 2;

/// Most axes: those of the rods, and a motor for each joint.
pub const MAX_AXES: usize = RODS + MAX_ARMS * MAX_JOINTS;

/// What an axis may do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KinematicLimits {
    /// Largest speed [m/s or rad/s].
    pub velocity: f64,
    /// Largest acceleration [m/s² or rad/s²].
    pub acceleration: f64,
    /// Largest jerk [m/s³ or rad/s³].
    pub jerk: f64,
}

/// Whether an axis, or a joint, turns or slides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisKind {
    /// About the platform normal [rad].
    Rotary,
    /// Along the radial direction of its link [m].
    Linear,
}

/// A motor: of a rod, or of the arms on the platform.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What it is called in files and programs: `q1`, `T`, `R`, …
    pub name: String,
    /// What its position is.
    pub kind: AxisKind,
    /// Least position [m or rad].
    pub min: f64,
    /// Largest position [m or rad].
    pub max: f64,
    /// Position that HOME goes to [m or rad].
    pub home: f64,
    /// While no effector that it moves carries a wafer.
    pub empty: KinematicLimits,
    /// While one does.
    pub loaded: KinematicLimits,
}

/// A joint of an arm, and the link after it.
///
/// ```text
///    joint value  =  zero + Σ_a ratio_a · position of axis a
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ArmJoint {
    /// Turns about the platform normal, or slides along the x axis of the link before.
    pub kind: AxisKind,
    /// Value where all axes are at zero [m or rad].
    pub zero: f64,
    /// Axes that move it, as indices into [`HybridRobot::axes`] from [`RODS`] on, each with its belt ratio.
    pub drives: Vec<(usize, f64)>,
    /// Where the next joint is along the x axis of the link after it [m]; on the last link the wafer's place says it.
    pub length: f64,
    /// Where the next joint is along the y axis of the link after it [m].
    pub offset: f64,
    /// Rise of the link after it above the one before, along the platform normal [m].
    pub rise: f64,
}

/// What holds a wafer.
#[derive(Debug, Clone, PartialEq)]
pub struct Effector {
    /// What it is called in programs: `A`, `B`, …
    pub name: String,
    /// Centre of the wafer in the frame of the last link (x along the link, y, z up), z the plane it rests on [m].
    pub wafer_center: [f64; 3],
    /// Where the wafer's heading points, about the platform normal from the last link [rad].
    pub heading: f64,
    /// How it carries a wafer.
    pub support: crate::wafer::Support,
    /// Friction between wafer and pads.
    pub friction: f64,
}

/// A planar serial arm on the platform.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// What it is called.
    pub name: String,
    /// First joint in the platform frame: x, y, and the height of the first joint's plane z [m].
    pub mount: [f64; 3],
    /// From the platform out; one to four.
    pub joints: Vec<ArmJoint>,
    /// One or more.
    pub effectors: Vec<Effector>,
    /// How it gives way under its own weight and its load.
    pub droop: crate::wafer::Droop,
}

/// A three-rod robot with its arms.
#[derive(Debug, Clone, PartialEq)]
pub struct HybridRobot {
    /// What it is called.
    pub name: String,
    /// The robot under the platform.
    pub gpr: Gpr,
    /// Where the platform sits over the rods.
    pub model: PlatformModel,
    /// Rods first, then the motors of the arms.
    pub axes: Vec<Axis>,
    /// One or two.
    pub arms: Vec<Arm>,
    /// Which of the parameters are assumed rather than known, as keys of the file with the reason.
    pub assumed: Vec<String>,
}

/// An effector of a robot, by arm and place on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EffectorId {
    /// Index of the arm.
    pub arm: usize,
    /// Index of the effector on the arm.
    pub effector: usize,
}
