//! Poses of elements.

use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Translation3};
use roxmltree::Node;

use crate::import::problem::Error;
use crate::import::xml::{Xml, attribute, content, elements};

/// The pose of an element, in the frame to which it is relative.
pub(super) fn pose<'a>(xml: Xml<'a>, node: Node<'a, 'a>) -> Result<Pose, Error> {
    let Some(element) = elements(node, "pose").next() else { return Ok(Pose::identity()) };
    if let Some(frame) = attribute(element, "frame").filter(|frame| !frame.text.is_empty()) {
        return Err(xml.unusable(&frame, "empty: from version 1.7 on use relative_to instead"));
    }
    let value = content(element);
    if value.text.is_empty() {
        return Ok(Pose::identity());
    }
    let format = attribute(element, "rotation_format");
    let degrees = attribute(element, "degrees");
    let in_degrees = degrees.map(|degrees| xml.truth(&degrees)).transpose()?.unwrap_or(false);
    let (point, rotation) = match format.as_ref().map_or("euler_rpy", |format| format.text) {
        "euler_rpy" => {
            let [x, y, z, r, p, w] = xml.numbers(&value, "6 numbers: x y z roll pitch yaw")?;
            let [r, p, w] = [r, p, w].map(|v: f64| if in_degrees { v.to_radians() } else { v });
            ([x, y, z], Rotation3::from_euler_angles(r, p, w))
        }
        "quat_xyzw" => {
            let [x, y, z, a, b, c, w] = xml.numbers(&value, "7 numbers: x y z qx qy qz qw")?;
            ([x, y, z], xml.quaternion(&value, [w, a, b, c])?)
        }
        _ => {
            let format = format.expect("the default is known");
            return Err(xml.unusable(&format, "euler_rpy or quat_xyzw"));
        }
    };
    Ok(Pose::from_parts(Translation3::from(point), rotation))
}
