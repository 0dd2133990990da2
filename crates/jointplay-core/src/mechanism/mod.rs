//! Any mechanism: links and joints with any number of loops.
//!
//! A [`Mechanism`] is what the user describes and never changes; spanning tree and loop closures are derived from it in [`Kinematics`].
//! [`MechanismSystem`] is its constraint system, against which every analysis is written.

mod assembly;
mod blocks;
mod closing;
mod closure;
mod description;
mod evidence;
mod exaggeration;
pub mod joint;
mod kinematics;
mod limits;
mod motion;
mod position;
mod relief;
mod relieved_motion;
mod singular;
mod sparse;
mod suggest;
mod symmetry;
mod system;
mod tree;
mod unassembled;
mod virtual_candidates;

pub use assembly::{assemble, branches, guess};
pub use blocks::{Block, MechanismMobility, blocks, mechanism_mobility};
pub use closing::close;
pub use closure::Closure;
pub use description::{
    Carrier, Joint, LinearAndAngular, MAX_LINKS, Mechanism, MechanismError, VirtualJoint,
    VirtualMotion,
};
pub use evidence::{
    JointWrench, LinkMotion, MobilityClass, ScrewAxis, SelfStress, link_motion, self_stresses,
};
pub use exaggeration::{ExaggeratedPlay, exaggerate_play};
pub use joint::JointKind;
pub use kinematics::Kinematics;
pub use limits::BeyondLimits;
pub use motion::{
    Drive, DrivenMotion, SingularConfiguration, Stop, Waypoint, drive, drive_with_progress,
};
pub use position::{Position, PositionSolver};
pub use relief::{CommandedJoints, Relief, ReliefSolver, relieve, virtual_weights};
pub use relieved_motion::drive_relieved;
pub use sparse::{SparseMobility, SparseSystem};
pub use suggest::{Suggestion, Suggestions, suggest};
pub use system::{MAX_DENSE, MechanismSystem};
pub use unassembled::Unassembled;
