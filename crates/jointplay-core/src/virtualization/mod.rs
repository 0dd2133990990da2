//! Virtual joints that relieve an overconstrained platform, and how their displacements are found.
//!
//! A *virtualization* is a map X → sockets p_k(X) in the platform plane; the sides between the sockets are then ℓ_ij(X) = |p_j − p_i|.
//! Choosing X is choosing where the platform sits over the triangle of the ball centres: the three ball centres fix only the plane and the three sides.
//!
//! | virtualization | X | socket k |
//! | --- | --- | --- |
//! | [`Radial`] | l_k | l_k u(β_k) |
//! | [`Polar`] | l_k, φ_k | l_k u(β_k + φ_k) |
//! | [`Offset`] | dr_k, dφ_k | r_k u(β_k) + dr_k u(β_k + dφ_k) |
//! | [`Planar`] | u_k, v_k | r_k u(β_k) + (u_k, v_k) |
//!
//! with u(θ) = (cos θ, sin θ).
//! Your own virtualization implements [`Virtualization`]; `crates/jointplay/examples/03_own_virtualization.rs` shows one.

mod built_in;
mod definition;
mod metric;
mod offset;
mod planar;
mod platform;
mod polar;
mod radial;
mod solve;
mod solver;
mod virtual_joint;

pub use built_in::built_in;
pub use definition::{BuiltIn, Virtualization};
pub use metric::Metric;
pub use offset::Offset;
pub use planar::Planar;
pub use platform::{Platform, Sides, Sockets};
pub use polar::Polar;
pub use radial::Radial;
pub use solve::{Solution, SolveOptions, solve};
pub use solver::Solver;
pub use virtual_joint::{MAX_VIRTUAL_JOINTS, VirtualJoint, VirtualJointKind, VirtualJoints};

pub(crate) use platform::{check_not_collinear, sides_of, signed_area, unit};
pub(crate) use solve::RELATIVE_THRESHOLD;
