//! Any mechanism: links and joints with any number of loops.
//!
//! A [`Mechanism`] is what the user describes and never changes; spanning tree and loop closures are derived from it in [`Kinematics`].
//! [`MechanismSystem`] is its constraint system, against which every analysis is written.

mod assembly;
mod attached_frame;
mod ball;
mod blocks;
mod closing;
mod closure;
mod commanded_positions;
mod coupling;
mod coupling_conflicts;
mod coupling_rows;
mod description;
mod drive_from;
mod drive_path;
mod driven_motion;
mod elementary;
mod evidence;
mod exaggeration;
mod far_closing;
mod frame_drive;
mod frame_path;
mod frames;
mod free_motions;
mod home;
pub mod joint;
mod kinematics;
mod limits;
mod link_poses;
mod mechanism_error;
mod motion;
mod motions;
mod nearest;
mod posing;
mod position;
mod principal_directions;
mod reach;
mod relief;
mod relieved_branch;
mod relieved_motion;
mod second_order_closing;
mod self_stress;
mod single_commands;
mod singular;
mod singular_search;
mod small_commands;
mod span;
mod sparse;
mod suggest;
mod suggest_options;
mod supports;
mod symmetry;
mod system;
mod tree;
mod unassembled;
mod undetermined;
mod virtual_candidates;
mod virtual_sets;

pub use crate::spatial::FrameTwist;
pub use assembly::{Branches, MAX_BRANCHES, assemble, branches, guess, is_same_configuration};
pub use attached_frame::{AttachedFrame, FrameId};
pub use blocks::{Block, MechanismMobility, OpenLoops, blocks, mechanism_mobility};
pub use closing::close;
pub use closure::Closure;
pub use commanded_positions::CommandedPositions;
pub use coupling::{Coupling, JointCoordinate};
pub use description::{
    Carrier, Joint, LinearAndAngular, MAX_LINKS, Mechanism, VirtualJoint, VirtualMotion,
};
pub use drive_from::{DEFAULT_STEPS, drive_from, held_actuators};
pub use drive_path::{Drive, DrivePath};
pub use driven_motion::{DrivenMotion, SingularConfiguration, Stop, Waypoint};
pub use elementary::{ElementaryChain, ElementaryMotion};
pub use evidence::{
    LinkMotion, MobilityClass, ScrewAxis, link_motion, poses_along_motion,
    poses_along_sparse_motion,
};
pub use exaggeration::{ExaggeratedPlay, exaggerate_play, exaggerated_link_poses};
pub use frame_drive::drive_frames;
pub use frame_path::{FramePath, FrameTarget, OrientationTarget};
pub use free_motions::{FreeMotion, free_motions};
pub use home::{
    close_at_rest, close_commanded, close_nearly, close_sparse, commanded_guess, near_miss_at_guess,
};
pub use joint::JointKind;
pub use kinematics::Kinematics;
pub use limits::BeyondLimits;
pub use link_poses::LinkPoses;
pub use mechanism_error::MechanismError;
pub use motion::{drive, drive_along};
pub use nearest::nearest_closure;
pub use posing::{Posed, pose_commanded, relieve_commanded};
pub use position::{
    ChangedDimension, Dexterity, DifferentialKinematics, DimensionDerivatives, Position,
    PositionSolver, dexterity,
};
pub use reach::{PointTarget, ReachedPoint, reach_point};
pub use relief::{CommandedJoints, Relief, ReliefSolver, relieve, virtual_weights};
pub use relieved_motion::drive_relieved;
pub use self_stress::{
    CouplingForce, JointWrench, SelfStress, SelfStresses, StressScrew, self_stresses,
};
pub use single_commands::{SingleCommand, single_commands, single_displacements};
pub use small_commands::{Commands, SMALL_COMMAND, small_commands};
pub use sparse::{SparseMobility, SparseSystem};
pub use suggest::{Suggestion, Suggestions, suggest};
pub use suggest_options::{SuggestOptions, SuggestionRank};
pub use system::{MAX_DENSE, MechanismSystem};
pub use unassembled::{OpenCoupling, OpenLoop, Unassembled};
pub use undetermined::Undetermined;
