//! Frames from an origin, a normal and a heading.

use jointplay_core::spatial::{Pose, tilt_rotation};
use nalgebra::{Rotation3, Vector3};

/// The frame at an origin with a given normal: a heading about the vertical, then the tilt.
#[must_use]
pub fn frame(origin: Vector3<f64>, normal: &Vector3<f64>, heading: f64) -> Pose {
    let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), heading);
    Pose::from_parts(origin.into(), tilt_rotation(normal) * turned)
}
