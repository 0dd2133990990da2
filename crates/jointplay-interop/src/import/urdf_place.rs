//! Links and poses that elements of URDF name.

use jointplay_core::spatial::Pose;
use nalgebra::{Quaternion, Rotation3, Translation3, UnitQuaternion};
use roxmltree::Node;

use super::draft::Draft;
use super::problem::Error;
use super::xml::{Advice, attribute};

/// Largest difference of the length of a quaternion from 1: files round its numbers.
const QUATERNION_TOLERANCE: f64 = 0.01;

/// The link at an end of a joint.
pub(super) fn end<'a>(
    draft: &Draft<'a>,
    joint: Node<'a, 'a>,
    end: Option<Node<'a, 'a>>,
    name: &'static str,
) -> Result<usize, Error> {
    let xml = draft.xml;
    let end = end.ok_or_else(|| xml.missing(joint, name))?;
    let link = attribute(end, "link").ok_or_else(|| xml.missing(end, "link"))?;
    draft.link(link.text).ok_or_else(|| xml.unknown("link", &link, draft.link_names()))
}

/// Pose of an `origin`.
pub(super) fn pose_of<'a>(draft: &Draft<'a>, origin: Node<'a, 'a>) -> Result<Pose, Error> {
    let xml = draft.xml;
    let vector = |name| {
        let value = attribute(origin, name);
        value.map(|value| xml.vector(&value)).transpose().map(Option::unwrap_or_default)
    };
    let known = ["xyz", "rpy", "quat_xyzw"];
    if let Some(other) = origin.attributes().find(|found| !known.contains(&found.name())) {
        let what = format!("`{}` of <origin>", other.name());
        return Err(xml.unsupported(origin, what, Advice("it has xyz, and rpy or quat_xyzw")));
    }
    let (xyz, rpy) = (vector("xyz")?, vector("rpy")?);
    let rotation = match attribute(origin, "quat_xyzw") {
        None => Rotation3::from_euler_angles(rpy.x, rpy.y, rpy.z),
        Some(_) if attribute(origin, "rpy").is_some() => {
            let what = "an <origin> with both rpy and quat_xyzw";
            return Err(xml.unsupported(origin, what, Advice("keep one of them")));
        }
        Some(value) => {
            let [x, y, z, w] = xml.numbers(&value, "4 numbers")?;
            let quaternion = Quaternion::new(w, x, y, z);
            if (quaternion.norm() - 1.0).abs() > QUATERNION_TOLERANCE {
                return Err(xml.unusable(&value, "a quaternion of length 1"));
            }
            UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix()
        }
    };
    Ok(Pose::from_parts(Translation3::from(xyz), rotation))
}
