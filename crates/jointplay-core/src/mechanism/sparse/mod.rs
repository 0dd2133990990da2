//! Mechanisms with many loops: closed joint by joint, with the twists of all links as unknowns, by sparse algebra.
//!
//! A loop closure involves every joint of the loop, so that its equations fill up; what a joint refuses involves two links only.
//! Both give the same mobility and redundancy.

mod block_cholesky;
mod coupling;
mod joint_row;
mod least_values;
mod linear;
mod mobility;
mod motion;
mod system;

pub use mobility::SparseMobility;
pub use system::SparseSystem;
