//! Loops and couplings: `connect` and `weld` between bodies or sites, `joint` between joints, `tendon` between sums of joints.

use jointplay_core::mechanism::{Coupling, JointCoordinate, JointKind};
use jointplay_core::spatial::Pose;
use nalgebra::Translation3;
use roxmltree::Node;

use super::placing::shift;
use super::reader::Reader;
use crate::import::draft::bare;
use crate::import::problem::Error;
use crate::import::xml::{Advice, Value, attribute, place};

impl<'a> Reader<'a> {
    /// An equality constraint: a loop closure, or an unsupported constraint.
    pub(super) fn equality(&mut self, node: Node<'a, 'a>) -> Result<(), Error> {
        let (xml, tag) = (self.draft.xml, node.tag_name().name());
        let class = self.defaults.class_of(xml, node, None)?;
        let active = attribute(node, "active");
        let active = active.or_else(|| self.defaults.attribute_value(class, "equality", "active"));
        if active.map(|active| xml.truth(&active)).transpose()? == Some(false) {
            self.draft.ignore(format!("inactive {tag}"));
            return Ok(());
        }
        let kind = match tag {
            "connect" => JointKind::Spherical,
            "weld" => JointKind::Fixed,
            "joint" => return self.coupling(node),
            "tendon" => return self.tendon_equality(node),
            "flex" | "flexvert" | "flexstrain" => {
                self.draft.ignore(tag);
                return Ok(());
            }
            _ => {
                let advice = Advice("set active=\"false\" to import the model without it");
                return Err(xml.unsupported(node, format!("<{tag}> in equality"), advice));
            }
        };
        let scale = attribute(node, "torquescale").filter(|_| tag == "weld");
        if scale.map(|scale| xml.number(&scale)).transpose()? == Some(0.0) {
            let advice = Advice("its bodies can rotate against each other; use a connect instead");
            return Err(xml.unsupported(node, "a weld whose torquescale is 0", advice));
        }
        let name = match xml.name(node)? {
            Some(name) => self.draft.constraint_name(name, place(node))?,
            None => self.draft.fresh(format!("{tag} {}", self.draft.descriptions.len() + 1)),
        };
        let (links, frames) = match (attribute(node, "site1"), attribute(node, "site2")) {
            (None, None) => self.between_bodies(node, kind)?,
            (Some(first), Some(second)) => {
                for attribute in ["body1", "body2", "anchor", "relpose"] {
                    if let Some(value) = crate::import::xml::attribute(node, attribute) {
                        return Err(xml.unusable(&value, "absent: the sites define the positions"));
                    }
                }
                let [(link_1, frame_1), (link_2, frame_2)] =
                    [self.site_of(&first)?, self.site_of(&second)?];
                let mut frames = [frame_1, frame_2];
                if kind == JointKind::Spherical {
                    // A connect joins points: the orientation of its sites is irrelevant, and must not count as a rotation.
                    let [world_from_1, world_from_2] =
                        [link_1, link_2].map(|link| self.world_from_link[link].rotation);
                    frames[1].rotation = world_from_2.inverse() * world_from_1 * frame_1.rotation;
                }
                ([link_1, link_2], frames)
            }
            (Some(_), None) => return Err(xml.missing(node, "site2")),
            (None, Some(_)) => return Err(xml.missing(node, "site1")),
        };
        let used = ["name", "class", "active", "site1", "site2", "body1", "body2", "relpose"];
        self.draft.ignore_attributes(node, &[&used[..], &["anchor"]].concat());
        self.draft.add_joint(bare(name, kind, links, frames), place(node))
    }

    /// A polynomial between two joints: y − y₀ = a₀ + a₁ (x − x₀), counted from the reference positions.
    fn coupling(&mut self, node: Node<'a, 'a>) -> Result<(), Error> {
        let xml = self.draft.xml;
        let first = attribute(node, "joint1").ok_or_else(|| xml.missing(node, "joint1"))?;
        let follower = self.draft.coordinate(&first)?;
        let second = attribute(node, "joint2");
        let leader = second.map(|second| self.draft.coordinate(&second)).transpose()?;
        let [constant, ratio] = self.linear_polynomial(node, leader.is_some())?;
        let mut offset = constant + self.reference(follower);
        let mut terms = Vec::new();
        if let Some(leader) = leader {
            offset -= ratio * self.reference(leader);
            terms.push((leader, ratio));
        }
        let name = match xml.name(node)? {
            Some(name) => self.draft.constraint_name(name, place(node))?,
            None => self.draft.fresh(format!("coupling {}", self.draft.couplings() + 1)),
        };
        let used = ["name", "class", "active", "joint1", "joint2", "polycoef"];
        self.draft.ignore_attributes(node, &used);
        self.draft.add_coupling(Coupling { name, follower, terms, offset }, place(node));
        Ok(())
    }

    /// Value of a coordinate in MuJoCo's reference configuration (m, rad).
    pub(super) fn reference(&self, one: JointCoordinate) -> f64 {
        self.draft.descriptions[one.joint].guess.first().copied().unwrap_or(0.0)
    }

    /// Constant and linear coefficient of an equality; others have to be zero where there is a variable.
    pub(super) fn linear_polynomial(
        &self,
        node: Node<'a, 'a>,
        has_variable: bool,
    ) -> Result<[f64; 2], Error> {
        let xml = self.draft.xml;
        let Some(value) = attribute(node, "polycoef") else { return Ok([0.0, 1.0]) };
        let all: Vec<f64> = value
            .text
            .split_whitespace()
            .map(|number| number.parse().ok().filter(|number: &f64| number.is_finite()))
            .collect::<Option<_>>()
            .filter(|all: &Vec<f64>| (1..=5).contains(&all.len()))
            .ok_or_else(|| xml.unusable(&value, "1 to 5 numbers"))?;
        if has_variable && all.iter().skip(2).any(|&coefficient| coefficient != 0.0) {
            let advice = Advice("only constant and linear coefficients are supported");
            let what = "a polynomial of higher degree in an equality";
            return Err(xml.unsupported(node, what, advice));
        }
        Ok([all[0], all.get(1).copied().unwrap_or(1.0)])
    }

    fn between_bodies(
        &self,
        node: Node<'a, 'a>,
        kind: JointKind,
    ) -> Result<([usize; 2], [Pose; 2]), Error> {
        let xml = self.draft.xml;
        let body = |value: &Value| {
            let link = self.draft.link(value.text);
            link.ok_or_else(|| xml.unknown("body", value, self.draft.link_names()))
        };
        let first = attribute(node, "body1").ok_or_else(|| xml.missing(node, "body1"))?;
        let second = attribute(node, "body2").map_or(Ok(0), |second| body(&second))?;
        let links = [body(&first)?, second];
        let [world_from_1, world_from_2] = links.map(|link| self.world_from_link[link]);
        let anchor = attribute(node, "anchor").map(|anchor| xml.vector(&anchor)).transpose()?;
        if kind == JointKind::Spherical {
            // In the first body's frame.
            let frame = shift(anchor.ok_or_else(|| xml.missing(node, "anchor"))?);
            return Ok((links, [frame, world_from_2.inverse() * world_from_1 * frame]));
        }
        // In the second body's frame; where `relpose` is given, its position is that of the anchor.
        let anchor = shift(anchor.unwrap_or_default());
        let mut first_from_anchor = world_from_1.inverse() * world_from_2 * anchor;
        if let Some(value) = attribute(node, "relpose") {
            let [x, y, z, a, b, c, d] = xml.numbers(&value, "7 numbers")?;
            // A quaternion of zeros means the reference configuration.
            if [a, b, c, d] != [0.0; 4] {
                let rotation = xml.quaternion(&value, [a, b, c, d])?;
                first_from_anchor = Pose::from_parts(Translation3::new(x, y, z), rotation);
            }
        }
        Ok((links, [first_from_anchor, anchor]))
    }

    fn site_of(&self, value: &Value) -> Result<(usize, Pose), Error> {
        let site = self.sites.get(value.text).copied();
        site.ok_or_else(|| self.draft.xml.unknown("site", value, self.sites.keys().copied()))
    }
}
