//! Links and poses that elements of URDF name.

use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Translation3};
use roxmltree::Node;

use super::draft::Draft;
use super::problem::Error;
use super::xml::attribute;

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
    let (xyz, rpy) = (vector("xyz")?, vector("rpy")?);
    let rotation = Rotation3::from_euler_angles(rpy.x, rpy.y, rpy.z);
    Ok(Pose::from_parts(Translation3::from(xyz), rotation))
}
