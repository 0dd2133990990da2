//! Poses and tilts.

mod pose;
mod tilt;

pub use pose::{Pose, fit_in_plane, leaning};
pub use tilt::Tilt;
