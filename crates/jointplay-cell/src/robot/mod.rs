//! A hybrid robot: a parallel platform on three rods (GPR) that carries serial planar arms.
//!
//! The platform tilts within the play of its ball joints; a virtualization, a model of this play by virtual joints, determines its pose over the rods.
//!
//! | file | contents |
//! | --- | --- |
//! | `hybrid_robot` | description: axes, arms, effectors, limits |
//! | `validate` | conditions of a valid description |
//! | `model` | pose of the platform over the rods, by a virtualization |
//! | `arm_chain` | an arm as a sum of planar vectors |
//! | `forward`, `jacobian`, `acceleration` | motion of frames by positions, velocities and accelerations of the axes |
//! | `reach` | range of distances that an effector reaches |
//! | `inverse` | axis positions for the plane, centre and heading of a wafer |
//! | `positions` | positions of all axes without allocation |
//! | `resolution` | rounded positions, whose rods have exact differences |
//! | `rotation_about_z` | rotations about z |
//!
//! Bodies are rigid here; [`wafer`](crate::wafer) adds droop and sag.

mod acceleration;
mod arm_chain;
mod cache_key;
mod forward;
mod hybrid_robot;
mod inverse;
mod jacobian;
mod model;
mod positions;
mod reach;
mod resolution;
mod rotation_about_z;
mod validate;

pub(crate) use acceleration::PlanarMotions;
pub use acceleration::{AxesMotion, FrameMotion};
pub(crate) use arm_chain::ArmChain;
pub use forward::{ChainPose, EffectorDisplacement};
pub use hybrid_robot::{
    Arm, ArmJoint, Axis, AxisKind, Effector, EffectorId, HybridRobot, KinematicLimits, MAX_ARMS,
    MAX_AXES, MAX_EFFECTORS, MAX_JOINTS, RODS,
};
pub use inverse::PosturePath;
pub use inverse::{
    Branch, BranchSelection, Configuration, Elbow, Inverse, LimitViolation, OutOfReach,
    ReachDirection, Redundancy, WaferTarget,
};
pub(crate) use inverse::{PlanarPath, PostureCandidate, PostureChange};
pub use jacobian::EffectorJacobian;
pub use model::PlatformModel;
pub use positions::Positions;
pub(crate) use resolution::RodMultiples;
pub use validate::RobotPart;
