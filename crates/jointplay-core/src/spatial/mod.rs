//! Poses, tilts and angles.

#[cfg(feature = "std")]
mod angle;
mod pose;
mod quaternion;
mod tilt;
mod twist;

#[cfg(feature = "std")]
pub use angle::{nearest_angle, wrap_angle};
#[cfg(feature = "std")]
pub(crate) use pose::NEARLY_HALF;
pub use pose::{Pose, fit_in_plane, heading, rotation_vector, tilt_rotation};
pub use quaternion::{continued_quaternion, quaternion_rate};
pub use tilt::Tilt;
pub use twist::FrameTwist;
