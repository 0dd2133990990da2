//! Kinds of joints, and the elementary motions that they are sequences of.

mod factor;
mod kind;

pub(crate) use factor::Twist;
pub use factor::{Coordinate, Factor};
pub use kind::JointKind;
