//! Models of MuJoCo (MJCF): bodies in a tree, closed to loops by `connect` and `weld`.
//!
//! Hinges become revolute joints, slides prismatic, balls spherical and free joints floating; a body without joints is fixed to its parent.
//! `connect` closes a loop by a spherical joint, `weld` by a fixed one.
//! Coordinates of hinges and slides are MuJoCo's own: a joint whose `ref` is not 0 starts there.
//! Those of balls and free joints count from where the model has the body.

mod closures;
mod defaults;
mod include;
mod placing;
mod reader;
mod tendons;

pub use include::{Expanded, IncludeError, expand_includes};
pub(super) use reader::read;
