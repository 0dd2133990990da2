//! Any mechanism: links and joints with any number of loops.
//!
//! A [`Mechanism`] is what the user describes and never changes; spanning tree and loop closures are derived from it in [`Kinematics`].

mod description;
pub mod joint;

pub use description::{
    Carrier, Joint, MAX_LINKS, Mechanism, MechanismError, Play, VirtualJoint, VirtualMotion,
};
pub use joint::JointKind;
