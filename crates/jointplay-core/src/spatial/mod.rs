//! Poses and tilts.

mod pose;
mod tilt;

pub use pose::{Pose, fit_in_plane, leaning, rotation_vector};
pub use tilt::Tilt;
