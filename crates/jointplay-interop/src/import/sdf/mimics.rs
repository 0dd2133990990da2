//! Axes of joints that mimic those of others.

use jointplay_core::mechanism::{Coupling, JointCoordinate};
use roxmltree::Node;

use super::reader::Reader;
use crate::import::problem::Error;
use crate::import::xml::{attribute, child, children, elements, place};

/// Elements of an axis, in the order of the coordinates of a joint.
const AXES: [&str; 2] = ["axis", "axis2"];

impl<'a> Reader<'a> {
    /// Couples the axes of a joint that mimic others, after all joints are read.
    pub(super) fn mimics(&mut self, frame: usize) -> Result<(), Error> {
        for (freedom, name) in AXES.into_iter().enumerate() {
            let axes = elements(self.frames.node(frame), name);
            for mimic in axes.flat_map(|axis| elements(axis, "mimic")).collect::<Vec<_>>() {
                self.mimic(frame, freedom, mimic)?;
            }
        }
        Ok(())
    }

    /// `q = multiplier · (q_leader − reference) + offset`
    fn mimic(&mut self, frame: usize, freedom: usize, mimic: Node<'a, 'a>) -> Result<(), Error> {
        let xml = self.draft.xml;
        let follower = self.draft.joint(self.shown(frame)).expect("its joint has been read");
        if freedom >= self.draft.descriptions[follower].kind.freedoms() {
            self.draft.ignore("mimic of an axis that the joint does not have");
            return Ok(());
        }
        let value = attribute(mimic, "joint").ok_or_else(|| xml.missing(mimic, "joint"))?;
        let found = self.frames.find(self.frames.scope(frame), &value)?;
        let leader = self.draft.joint(self.shown(found));
        let leader = leader.ok_or_else(|| xml.unusable(&value, "the name of a joint"))?;
        let axis = attribute(mimic, "axis");
        let of_leader = match axis.as_ref().map_or(AXES[0], |axis| axis.text) {
            "axis" => 0,
            "axis2" => 1,
            _ => return Err(xml.unusable(&axis.expect("it is given"), "axis or axis2")),
        };
        if of_leader >= self.draft.descriptions[leader].kind.freedoms() {
            return Err(xml.unusable(axis.as_ref().unwrap_or(&value), "an axis of a joint"));
        }
        let number = |name: &str, default: f64| {
            child(mimic, name).map_or(Ok(default), |value| xml.number(&value))
        };
        let (ratio, offset) = (number("multiplier", 1.0)?, number("offset", 0.0)?);
        let offset = offset - ratio * number("reference", 0.0)?;
        let parts = children(mimic).map(|part| part.tag_name().name());
        let unknown = parts.filter(|name| !["multiplier", "offset", "reference"].contains(name));
        for name in unknown.collect::<Vec<_>>() {
            self.draft.ignore(format!("{name} of a mimic"));
        }
        self.draft.ignore_attributes(mimic, &["joint", "axis"]);
        let name = self.draft.fresh(match freedom {
            0 => format!("mimic of {}", self.shown(frame)),
            _ => format!("mimic of {} of {}", AXES[freedom], self.shown(frame)),
        });
        let coordinate = |joint, freedom| JointCoordinate { joint, freedom };
        let terms = vec![(coordinate(leader, of_leader), ratio)];
        let follower = coordinate(follower, freedom);
        self.draft.add_coupling(Coupling { name, follower, terms, offset }, place(mimic));
        Ok(())
    }
}
