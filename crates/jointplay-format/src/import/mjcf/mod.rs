//! Models of MuJoCo (MJCF): bodies in a tree, closed to loops by `connect` and `weld`.
//!
//! Hinges become revolute joints, slides prismatic, balls spherical and free joints floating; a body without joints is fixed to its parent.
//! `connect` closes a loop by a spherical joint, `weld` by a fixed one.
//! Coordinates of hinges and slides are MuJoCo's own: a joint whose `ref` is not 0 starts there.
//! Those of balls and free joints count from where the model has the body.

mod closures;
mod defaults;
mod placing;

use std::collections::BTreeMap;

use jointplay_core::mechanism::JointKind;
use jointplay_core::spatial::Pose;
use nalgebra::{Translation3, Unit, Vector3};
use roxmltree::Node;

use super::draft::{Draft, bare};
use super::problem::Error;
use super::xml::{Advice, attribute, children, elements, place};
use super::{Dialect, Imported};
use crate::mechanism::frame::{pose, some_perpendicular};
use defaults::Defaults;
use placing::Angles;

/// Elements of a body that are no part of its mechanism.
const UNMOVING: [&str; 5] = ["geom", "inertial", "camera", "light", "plugin"];

/// Sections of a model that are no part of its mechanism.
const ASIDE: [&str; 12] = [
    "option",
    "size",
    "visual",
    "statistic",
    "asset",
    "contact",
    "tendon",
    "sensor",
    "keyframe",
    "custom",
    "extension",
    "deformable",
];

/// Attributes that place a body, frame or site.
const PLACING: [&str; 6] = ["pos", "quat", "axisangle", "euler", "xyaxes", "zaxis"];

const INCLUDED: Advice = Advice(
    "it stands for other elements; load the model with MuJoCo and save it (mj_saveLastXML) to have them written out",
);

struct Reader<'a> {
    draft: Draft<'a>,
    angles: Angles,
    autolimits: bool,
    defaults: Defaults<'a>,
    /// Pose of each link in MuJoCo's reference configuration [m].
    world_from_link: Vec<Pose>,
    /// Link and place of each site [m].
    sites: BTreeMap<&'a str, (usize, Pose)>,
}

/// A body or the world whose contents are still to be read.
struct Open<'a> {
    node: Node<'a, 'a>,
    parent: usize,
    /// Where the frame that holds the body is on its parent [m].
    parent_from_frame: Pose,
    class: Option<&'a str>,
}

/// An element in a body, with the frames around it composed.
struct Item<'a> {
    node: Node<'a, 'a>,
    body_from_frame: Pose,
    class: Option<&'a str>,
}

pub(super) fn read<'a>(draft: Draft<'a>, root: Node<'a, 'a>) -> Result<Imported, Error> {
    let mut reader = Reader {
        draft,
        angles: Angles::default(),
        autolimits: true,
        defaults: Defaults::default(),
        world_from_link: vec![Pose::identity()],
        sites: BTreeMap::new(),
    };
    reader.draft.add_link("world", place(root))?;
    for compiler in elements(root, "compiler") {
        reader.compiler(compiler)?;
    }
    for section in elements(root, "default") {
        reader.defaults.section(&mut reader.draft, section)?;
    }
    for world in elements(root, "worldbody") {
        reader.tree(world)?;
    }
    for section in children(root) {
        match section.tag_name().name() {
            "compiler" | "default" | "worldbody" => {}
            "equality" => children(section).try_for_each(|node| reader.equality(node))?,
            "actuator" => children(section).try_for_each(|node| reader.actuator(node))?,
            name if ASIDE.contains(&name) => reader.draft.ignore(name),
            "include" => {
                return Err(reader.draft.xml.unsupported(section, "<include>", INCLUDED));
            }
            name => {
                let advice = Advice("MJCF knows no such section");
                let what = format!("<{name}> here");
                return Err(reader.draft.xml.unsupported(section, what, advice));
            }
        }
    }
    let model = attribute(root, "model");
    let name = model.map(|value| reader.draft.xml.printable(&value)).transpose()?;
    reader.draft.finish(name.unwrap_or("MuJoCo model"), Dialect::Mjcf)
}

impl<'a> Reader<'a> {
    fn compiler(&mut self, node: Node<'a, 'a>) -> Result<(), Error> {
        let xml = self.draft.xml;
        if let Some(angle) = attribute(node, "angle") {
            self.angles.in_degrees = match angle.text {
                "degree" => true,
                "radian" => false,
                _ => return Err(xml.unusable(&angle, "degree or radian")),
            };
        }
        if let Some(sequence) = attribute(node, "eulerseq") {
            self.angles.set_sequence(xml, &sequence)?;
        }
        if let Some(autolimits) = attribute(node, "autolimits") {
            self.autolimits = xml.truth(&autolimits)?;
        }
        if let Some(coordinate) = attribute(node, "coordinate").filter(|c| c.text != "local") {
            let expected = "local: MuJoCo 2.3.3 or older can load and save a model of global ones";
            return Err(xml.unusable(&coordinate, expected));
        }
        let used = ["angle", "eulerseq", "autolimits", "coordinate"];
        self.draft.ignore_attributes(node, &used);
        Ok(())
    }

    /// All bodies of the tree, parents first.
    fn tree(&mut self, world: Node<'a, 'a>) -> Result<(), Error> {
        // A stack of its own, for a chain of bodies can be as long as the file.
        let mut open =
            vec![Open { node: world, parent: 0, parent_from_frame: Pose::identity(), class: None }];
        while let Some(next) = open.pop() {
            let node = next.node;
            let is_world = node == world;
            let class = self.childclass(node)?.or(next.class);
            let items = self.items(node, class)?;
            let link = if is_world { 0 } else { self.body(&next, &items)? };
            let mut bodies = Vec::new();
            for item in items {
                match item.node.tag_name().name() {
                    "body" => bodies.push(Open {
                        node: item.node,
                        parent: link,
                        parent_from_frame: item.body_from_frame,
                        class: item.class,
                    }),
                    "joint" | "freejoint" if !is_world => {}
                    "site" => self.site(&item, link)?,
                    name if UNMOVING.contains(&name) => self.draft.ignore(name),
                    name @ ("include" | "replicate" | "attach" | "composite" | "flexcomp") => {
                        let what = format!("<{name}>");
                        return Err(self.draft.xml.unsupported(item.node, what, INCLUDED));
                    }
                    name => {
                        let advice = Advice("MJCF knows no such element of a body");
                        let what = format!("<{name}> here");
                        return Err(self.draft.xml.unsupported(item.node, what, advice));
                    }
                }
            }
            open.extend(bodies.into_iter().rev());
        }
        Ok(())
    }

    /// What a body holds, that in its frames too, in the order of the file.
    fn items(
        &mut self,
        body: Node<'a, 'a>,
        class: Option<&'a str>,
    ) -> Result<Vec<Item<'a>>, Error> {
        let inside = |node, body_from_frame, class| {
            let wrap = move |node| Item { node, body_from_frame, class };
            children(node).map(wrap).collect::<Vec<_>>().into_iter().rev()
        };
        let mut items = Vec::new();
        let mut open: Vec<Item> = inside(body, Pose::identity(), class).collect();
        while let Some(item) = open.pop() {
            if item.node.tag_name().name() == "frame" {
                self.draft.xml.name(item.node)?;
                let class = self.childclass(item.node)?.or(item.class);
                let place = item.body_from_frame * self.pose(item.node)?;
                open.extend(inside(item.node, place, class));
            } else {
                items.push(item);
            }
        }
        Ok(items)
    }

    /// The default class that a body or frame gives to what it holds.
    fn childclass(&self, node: Node<'a, 'a>) -> Result<Option<&'a str>, Error> {
        let class = attribute(node, "childclass");
        class.map(|class| self.defaults.known(self.draft.xml, &class)).transpose()
    }

    /// A body with the joints to its parent; several joints have links without a body between them.
    fn body(&mut self, open: &Open<'a>, items: &[Item<'a>]) -> Result<usize, Error> {
        let node = open.node;
        let name = match self.draft.xml.name(node)? {
            Some(name) => name.to_owned(),
            None => self.draft.fresh(format!("body {}", self.draft.links())),
        };
        let parent_from_body = open.parent_from_frame * self.pose(node)?;
        let world_from_body = self.world_from_link[open.parent] * parent_from_body;
        let moving = |item: &&Item| matches!(item.node.tag_name().name(), "joint" | "freejoint");
        let joints: Vec<&Item> = items.iter().filter(moving).collect();
        let (mut from, mut before) = (open.parent, parent_from_body);
        for index in 0..joints.len().max(1) {
            let is_last = index + 1 >= joints.len();
            let link = if is_last {
                name.clone()
            } else {
                self.draft.fresh(format!("{name}, part {}", index + 1))
            };
            let to = self.draft.add_link(link, place(node))?;
            self.world_from_link.push(world_from_body);
            match joints.get(index) {
                Some(item) => self.joint(item, [from, to], before)?,
                None => {
                    let name = self.draft.fresh(format!("joint {}", self.draft.descriptions.len() + 1));
                    let frames = [before, Pose::identity()];
                    self.draft.add_joint(bare(name, JointKind::Fixed, [from, to], frames), place(node))?;
                }
            }
            (from, before) = (to, Pose::identity());
        }
        let mut used = vec!["name", "childclass"];
        used.extend(PLACING);
        self.draft.ignore_attributes(node, &used);
        Ok(from)
    }

    /// A joint of a body.
    ///
    /// # Arguments
    /// * `before` – the body's place on the joint's first link, in the reference configuration [m]
    fn joint(
        &mut self,
        item: &Item<'a>,
        links: [usize; 2],
        before: Pose,
    ) -> Result<(), Error> {
        let (node, xml) = (item.node, self.draft.xml);
        let is_free = node.tag_name().name() == "freejoint";
        let class = self.defaults.class_of(xml, node, item.class)?;
        let value = |name| attribute(node, name).or_else(|| self.defaults.of(class, "joint", name));
        let kind = if is_free { None } else { value("type") };
        let kind = match kind.as_ref().map_or(if is_free { "free" } else { "hinge" }, |k| k.text) {
            "hinge" => JointKind::Revolute,
            "slide" => JointKind::Prismatic,
            "ball" => JointKind::Spherical,
            "free" => JointKind::Floating,
            _ => {
                let kind = kind.expect("both defaults are known");
                return Err(xml.unusable(&kind, "hinge, slide, ball or free"));
            }
        };
        let name = match xml.name(node)? {
            Some(name) => name.to_owned(),
            None => self.draft.fresh(format!("joint {}", self.draft.descriptions.len() + 1)),
        };
        let has_axis = matches!(kind, JointKind::Revolute | JointKind::Prismatic);
        let si = |v: f64| if kind == JointKind::Revolute { self.angles.radians(v) } else { v };
        let mut body_from_joint = Pose::identity();
        if kind != JointKind::Floating {
            let point = value("pos").map(|pos| xml.vector(&pos)).transpose()?.unwrap_or_default();
            let point = item.body_from_frame * nalgebra::Point3::from(point);
            body_from_joint = shift(point.coords);
            if has_axis {
                let axis = value("axis").map(|axis| xml.direction(&axis)).transpose()?;
                let axis = axis.unwrap_or(Vector3::z_axis());
                let z = Unit::new_normalize(item.body_from_frame.rotation * axis.into_inner());
                body_from_joint = pose(point.coords, some_perpendicular(z), z);
            }
        }
        let mut joint = bare(name, kind, links, [before * body_from_joint, body_from_joint]);
        if let Some(reference) = value("ref").filter(|_| has_axis) {
            let reference = si(xml.number(&reference)?);
            if reference != 0.0 {
                let turned = kind.factors()[0].transform(&[reference]);
                joint.frames[1] *= turned;
                joint.guess = vec![reference];
            }
        }
        let mut passed_over = None;
        if let Some(range) = value("range").filter(|_| !is_free) {
            let [least, most] = xml.numbers(&range, "2 numbers")?;
            let limited = match value("limited") {
                Some(limited) if limited.text != "auto" => xml.truth(&limited)?,
                _ if self.autolimits => least < most,
                _ => {
                    let advice = Advice("without `autolimits`, a joint has to say whether it is `limited`");
                    return Err(xml.unsupported(node, "a range alone", advice));
                }
            };
            match (limited, has_axis) {
                (true, true) if least < most => joint.limits = vec![[least, most].map(si)],
                (true, true) => return Err(xml.unusable(&range, "the least before the greatest")),
                (true, false) => passed_over = Some("range of a ball"),
                (false, _) => {}
            }
        }
        passed_over.into_iter().for_each(|what| self.draft.ignore(what));
        let used = ["name", "class", "type", "pos", "axis", "ref", "range", "limited"];
        self.draft.ignore_attributes(node, &used);
        self.draft.add_joint(joint, place(node))
    }

    fn site(&mut self, item: &Item<'a>, link: usize) -> Result<(), Error> {
        self.draft.ignore("site");
        let Some(name) = self.draft.xml.name(item.node)? else { return Ok(()) };
        let class = self.defaults.class_of(self.draft.xml, item.node, item.class)?;
        let default = |name| self.defaults.of(class, "site", name);
        let pose = self.angles.pose(self.draft.xml, item.node, default)?;
        self.sites.insert(name, (link, item.body_from_frame * pose));
        Ok(())
    }

    fn actuator(&mut self, node: Node<'a, 'a>) -> Result<(), Error> {
        let joint = attribute(node, "joint").or_else(|| attribute(node, "jointinparent"));
        let Some(joint) = joint else {
            self.draft.ignore(format!("{} that drives no joint", node.tag_name().name()));
            return Ok(());
        };
        match self.draft.joint(joint.text) {
            Some(number) => self.draft.descriptions[number].actuated = true,
            None => return Err(self.draft.xml.unknown("joint", &joint, self.draft.joint_names())),
        }
        Ok(())
    }

    /// Where a body or frame is.
    fn pose(&self, node: Node<'a, 'a>) -> Result<Pose, Error> {
        self.angles.pose(self.draft.xml, node, |_| None)
    }
}

/// A displacement without a turn.
fn shift(by: Vector3<f64>) -> Pose {
    Pose::from_parts(Translation3::from(by), nalgebra::Rotation3::identity())
}
