//! Gearboxes: ratios between the turns of two links about a third one.

use jointplay_core::mechanism::{Coupling, JointCoordinate, JointKind};
use nalgebra::Vector3;
use roxmltree::Node;

use super::reader::Reader;
use crate::import::problem::Error;
use crate::import::xml::{Advice, attribute, child, children, place};

/// Largest deviation of an axis of a gearbox from that of a revolute joint, as the difference of the cosine from 1.
const PARALLEL: f64 = 1e-9;

impl<'a> Reader<'a> {
    pub(super) fn is_gearbox(&self, frame: usize) -> bool {
        attribute(self.frames.node(frame), "type").is_some_and(|value| value.text == "gearbox")
    }

    /// Couples two revolute joints, after all joints are read: `θ2 = −ratio · θ1`, the angles of child and parent about the reference body.
    ///
    /// # Source
    /// \[SDFormat\], `gearbox_reference_body`
    pub(super) fn gearbox(&mut self, frame: usize) -> Result<(), Error> {
        let (node, xml) = (self.frames.node(frame), self.draft.xml);
        let body = child(node, "gearbox_reference_body");
        let body = body.ok_or_else(|| xml.missing(node, "gearbox_reference_body"))?;
        let body = self.frames.find(self.frames.scope(frame), &body)?;
        let ratio = match child(node, "gearbox_ratio") {
            Some(value) => match xml.number(&value)? {
                0.0 => return Err(xml.unusable(&value, "a number that is not 0")),
                ratio => ratio,
            },
            None => 1.0,
        };
        let turn = |end: &'static str, axis: &'static str| {
            let end = self.frames.end(frame, end)?;
            let direction = self.axis(frame, node, axis)?;
            let direction = self.frames.world_from(frame).rotation * direction.into_inner();
            self.turn_about(node, [body, end], direction)
        };
        let ((leader, one), (follower, other)) = (turn("parent", "axis")?, turn("child", "axis2")?);
        for part in children(node).map(|part| part.tag_name().name()) {
            let used = ["parent", "child", "pose", "axis", "axis2"];
            if !used.contains(&part) && !part.starts_with("gearbox_") {
                self.draft.ignore(format!("{part} of a gearbox"));
            }
        }
        let name = self.shown(frame).to_owned();
        let name = self.draft.constraint_name(&name, place(node))?;
        let coordinate = |joint| JointCoordinate { joint, freedom: 0 };
        let terms = vec![(coordinate(leader), -ratio * one * other)];
        let coupling = Coupling { name, follower: coordinate(follower), terms, offset: 0.0 };
        self.draft.add_coupling(coupling, place(node));
        Ok(())
    }

    /// The revolute joint between a body and a link about an axis, and the sign of the turn of the link about this axis.
    fn turn_about(
        &self,
        gearbox: Node<'a, 'a>,
        [body, link]: [usize; 2],
        axis: Vector3<f64>,
    ) -> Result<(usize, f64), Error> {
        let [Some(of_body), Some(of_link)] = [body, link].map(|one| self.link_of_frame[one]) else {
            let what = "a gearbox of frames that are no links";
            let advice = Advice("name the links of its parent, child and reference body");
            return Err(self.draft.xml.unsupported(gearbox, what, advice));
        };
        for (number, joint) in self.draft.descriptions.iter().enumerate() {
            let sign = match joint.links {
                links if links == [of_body, of_link] => 1.0,
                links if links == [of_link, of_body] => -1.0,
                _ => continue,
            };
            let first = if sign > 0.0 { body } else { link };
            let world_from_joint = self.frames.world_from(first) * joint.frames[0];
            let cosine = (world_from_joint.rotation * Vector3::z()).dot(&axis);
            if joint.kind == JointKind::Revolute && cosine.abs() >= 1.0 - PARALLEL {
                return Ok((number, sign * cosine.signum()));
            }
        }
        let what = format!(
            "a gearbox without a revolute joint of {:?} and {:?} about its axis",
            self.shown(body),
            self.shown(link)
        );
        let advice = Advice("parent and child turn on revolute joints of the reference body");
        Err(self.draft.xml.unsupported(gearbox, what, advice))
    }
}
