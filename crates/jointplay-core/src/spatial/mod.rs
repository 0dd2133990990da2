//! Poses and tilts.

mod pose;
mod tilt;

pub use pose::{Pose, fit_in_plane, heading, rotation_vector, tilt_rotation};
pub use tilt::Tilt;
