//! Joints of SDF.

use std::f64::consts::TAU;

use jointplay_core::mechanism::JointKind;
use jointplay_core::spatial::Pose;
use nalgebra::{Unit, Vector3};
use roxmltree::Node;

use super::reader::Reader;
use crate::import::draft::bare;
use crate::import::problem::Error;
use crate::import::xml::{
    Advice, attribute, child, children, content, elements, is_foreign, place,
};
use jointplay_format::mechanism::frame::{pose, some_perpendicular};

/// Largest deviation of the axes of a universal joint from perpendicular (rad).
const PERPENDICULAR: f64 = 1e-6;

impl<'a> Reader<'a> {
    pub(super) fn joint(&mut self, frame: usize) -> Result<(), Error> {
        if self.is_gearbox(frame) {
            return Ok(());
        }
        let (node, xml) = (self.frames.node(frame), self.draft.xml);
        self.check_parts(node)?;
        let value = attribute(node, "type").ok_or_else(|| xml.missing(node, "type"))?;
        let kind = match value.text {
            "revolute" | "continuous" => JointKind::Revolute,
            "prismatic" => JointKind::Prismatic,
            "screw" => JointKind::Helical { lead: self.lead(node)? },
            "ball" => JointKind::Spherical,
            "universal" | "revolute2" => JointKind::Universal,
            "fixed" => JointKind::Fixed,
            _ => {
                let expected = "revolute, continuous, prismatic, screw, ball, universal, revolute2, fixed or gearbox";
                return Err(xml.unusable(&value, expected));
            }
        };
        let ends = [self.frames.end(frame, "parent")?, self.frames.end(frame, "child")?];
        let axes = match kind {
            JointKind::Spherical | JointKind::Fixed => [None, None],
            JointKind::Universal => [Some("axis"), Some("axis2")],
            _ => [Some("axis"), None],
        };
        for unused in ["axis", "axis2"].into_iter().filter(|name| !axes.contains(&Some(name))) {
            for _ in elements(node, unused) {
                self.draft.ignore(format!("{unused} of a {} joint", value.text));
            }
        }
        let [first, second] = axes.map(|name| name.map(|name| self.axis(frame, node, name)));
        let z = first.transpose()?.unwrap_or(Vector3::z_axis());
        let x = match second.transpose()? {
            None => some_perpendicular(z),
            Some(x) if x.dot(&z).abs() <= PERPENDICULAR => x,
            Some(_) => {
                let what = format!("a {} joint whose axes are not at a right angle", value.text);
                let advice = Advice("write it as two revolute joints with a link between them");
                return Err(xml.unsupported(node, what, advice));
            }
        };
        let world_from_joint = self.frames.world_from(frame) * pose(Vector3::zeros(), x, z);
        let on_link = |end: usize| self.frames.world_from(end).inverse() * world_from_joint;
        let frames: [Pose; 2] = ends.map(on_link);
        let links = ends.map(|end| self.link_of_frame[end].expect("every end is a link"));
        let name = self.shown(frame).to_owned();
        let mut joint = bare(name, kind, links, frames);
        let named = axes.into_iter().flatten();
        let limits = named.map(|name| self.limits(node, name)).collect::<Result<Vec<_>, _>>()?;
        let takes_limits = !matches!(kind, JointKind::Helical { .. }) && value.text != "continuous";
        if limits.iter().flatten().any(|end| end.is_finite()) {
            if takes_limits {
                joint.limits = limits;
            } else {
                self.draft.ignore(format!("limit of a {} joint", value.text));
            }
        }
        self.draft.add_joint(joint, place(node))
    }
    /// Rejects parts of a joint that would affect it, and lists the others as ignored.
    fn check_parts(&mut self, joint: Node<'a, 'a>) -> Result<(), Error> {
        let refused = |node: Node<'a, 'a>, what: &str| {
            let advice = Advice("its effect on the mechanism is unknown");
            Err(self.draft.xml.unsupported(node, what, advice))
        };
        let mut ignored = Vec::new();
        for part in children(joint) {
            let name = part.tag_name().name();
            match name {
                _ if is_foreign(part) => ignored.push(name.to_owned()),
                "parent" | "child" | "pose" | "thread_pitch" | "screw_thread_pitch" => {}
                "axis" | "axis2" => {
                    for inner in children(part) {
                        let inner_name = inner.tag_name().name();
                        match inner_name {
                            _ if is_foreign(inner) => {
                                ignored.push(inner_name.to_owned());
                            }
                            "xyz" | "use_parent_model_frame" | "mimic" => {}
                            "limit" => {
                                let sides = ["lower", "upper"];
                                let all = children(inner).map(|side| side.tag_name().name());
                                let others = all.filter(|side| !sides.contains(side));
                                ignored.extend(others.map(|other| format!("{other} of a limit")));
                            }
                            "dynamics" | "initial_position" => {
                                ignored.push(format!("{inner_name} of a joint"));
                            }
                            _ => return refused(inner, &format!("<{inner_name}> of an axis")),
                        }
                    }
                }
                "physics" | "sensor" => ignored.push(format!("{name} of a joint")),
                _ => return refused(part, &format!("<{name}> of a joint")),
            }
        }
        ignored.into_iter().for_each(|what| self.draft.ignore(what));
        Ok(())
    }

    /// Direction of an axis in the frame of its joint.
    pub(super) fn axis(
        &self,
        frame: usize,
        joint: Node<'a, 'a>,
        name: &'static str,
    ) -> Result<Unit<Vector3<f64>>, Error> {
        let xml = self.draft.xml;
        let axis = elements(joint, name).next().ok_or_else(|| xml.missing(joint, name))?;
        let Some(xyz) = elements(axis, "xyz").next() else { return Ok(Vector3::z_axis()) };
        let direction = xml.direction(&content(xyz))?;
        let scope = self.frames.scope(frame);
        let in_model = child(axis, "use_parent_model_frame");
        let in_model = in_model.map(|value| xml.truth(&value)).transpose()?;
        let in_model = in_model.unwrap_or(self.frames.axes_are_in_model());
        let expressed_in = match self.frames.named(scope, xyz, "expressed_in")? {
            None if in_model => scope,
            None => return Ok(direction),
            Some(other) => other,
        };
        let joint_from_other = self.frames.world_from(frame).rotation.inverse()
            * self.frames.world_from(expressed_in).rotation;
        Ok(Unit::new_normalize(joint_from_other * direction.into_inner()))
    }

    /// Lead of a screw joint (m/rad).
    ///
    /// The newer element is in metres per revolution of a right-handed thread, the older one in radians per metre of a left-handed one.
    fn lead(&self, joint: Node<'a, 'a>) -> Result<f64, Error> {
        let xml = self.draft.xml;
        if let Some(pitch) = child(joint, "screw_thread_pitch") {
            return Ok(xml.number(&pitch)? / TAU);
        }
        let pitch = child(joint, "thread_pitch");
        let pitch = pitch.ok_or_else(|| xml.missing(joint, "screw_thread_pitch"))?;
        match xml.number(&pitch)? {
            0.0 => Err(xml.unusable(&pitch, "a number that is not 0")),
            pitch => Ok(-1.0 / pitch),
        }
    }

    /// Least and greatest coordinate about an axis, infinite where there is none (m, rad).
    fn limits(&mut self, joint: Node<'a, 'a>, axis: &'static str) -> Result<[f64; 2], Error> {
        const NONE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
        let limit = elements(joint, axis).flat_map(|axis| elements(axis, "limit")).next();
        let Some(limit) = limit else { return Ok(NONE) };
        let end = |side: usize| {
            let value = child(limit, ["lower", "upper"][side]);
            value.map_or(Ok(NONE[side]), |value| self.draft.xml.bound(&value))
        };
        let (least, most) = (end(0)?, end(1)?);
        if least < most {
            return Ok([least, most]);
        }
        if least > most {
            let advice = Advice("exchange them");
            return Err(self.draft.xml.unsupported(
                limit,
                "a <limit> with lower above upper",
                advice,
            ));
        }
        self.draft
            .ignore("limit whose lower is its upper, of a joint that is imported without limits");
        Ok(NONE)
    }
}
