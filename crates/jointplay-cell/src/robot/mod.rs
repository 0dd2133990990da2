//! A three-rod robot that carries planar arms.
//!
//! | file | contents |
//! | --- | --- |
//! | `hybrid_robot` | description: axes, arms, effectors, limits |
//! | `validate` | conditions that a description has to fulfil |
//! | `model` | pose of the platform over the rods, by a virtualization |
//! | `arm_chain` | an arm as a sum of planar vectors |
//! | `forward`, `jacobian`, `acceleration` | from positions, velocities and accelerations of the axes to those of frames |
//! | `reach` | range of distances that an effector reaches |
//! | `inverse` | from a wafer's plane, centre and heading to all positions that reach it |
//! | `positions` | positions of all axes without allocation |
//! | `angle` | wrapped angles, rotations about z |
//!
//! Bodies are rigid here; [`wafer`](crate::wafer) adds droop and sag.

mod acceleration;
mod angle;
mod arm_chain;
mod cache_key;
mod forward;
mod hybrid_robot;
mod inverse;
mod jacobian;
mod model;
mod positions;
mod reach;
mod validate;

pub use acceleration::{AxesMotion, FrameMotion};
pub(crate) use angle::wrap_angle;
pub(crate) use arm_chain::ArmChain;
pub use forward::{ChainPose, EffectorDisplacement};
pub use hybrid_robot::{
    Arm, ArmJoint, Axis, AxisKind, Effector, EffectorId, HybridRobot, KinematicLimits, MAX_ARMS,
    MAX_AXES, MAX_JOINTS, RODS,
};
pub(crate) use inverse::PlanarPath;
pub use inverse::PosturePath;
pub use inverse::{
    Branch, BranchSelection, Configuration, Elbow, Inverse, LimitViolation, OutOfReach,
    ReachDirection, Redundancy, WaferTarget,
};
pub use jacobian::EffectorJacobian;
pub use model::PlatformModel;
pub use positions::Positions;
pub use validate::RobotPart;
