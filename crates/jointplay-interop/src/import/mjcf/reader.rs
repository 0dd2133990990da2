//! Models of MuJoCo (MJCF): bodies in a tree, closed to loops by `connect` and `weld`.
//!
//! Hinges become revolute joints, slides prismatic, balls spherical and free joints floating; a body without joints is fixed to its parent.
//! `connect` closes a loop by a spherical joint, `weld` by a fixed one.
//! Coordinates of hinges and slides are MuJoCo's own: a joint whose `ref` is not 0 starts there.
//! Those of balls and free joints count from where the model has the body.

use std::collections::BTreeMap;

use jointplay_core::mechanism::JointKind;
use jointplay_core::spatial::Pose;
use nalgebra::{Unit, Vector3};
use roxmltree::Node;

use super::defaults::Defaults;
use super::placing::{Angles, PLACING, shift};
use crate::import::draft::{Draft, bare};
use crate::import::model::{Dialect, Imported};
use crate::import::problem::Error;
use crate::import::xml::{Advice, ENDLESS, attribute, children, elements, place};
use jointplay_format::mechanism::frame::{pose, some_perpendicular};

/// Elements of a body that do not affect the mechanism.
const UNMOVING: [&str; 5] = ["geom", "inertial", "camera", "light", "plugin"];

/// Sections of a model that do not affect the mechanism.
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

const INCLUDED: Advice = Advice(
    "it represents other elements; load the model with MuJoCo and save it (mj_saveLastXML) to expand them",
);

pub(super) struct Reader<'a> {
    pub(super) draft: Draft<'a>,
    pub(super) angles: Angles,
    pub(super) autolimits: bool,
    pub(super) defaults: Defaults<'a>,
    /// Pose of each link in MuJoCo's reference configuration (m).
    pub(super) world_from_link: Vec<Pose>,
    /// Link and pose of each site (m).
    pub(super) sites: BTreeMap<&'a str, (usize, Pose)>,
}

/// A body or the world before its contents are read.
struct Open<'a> {
    node: Node<'a, 'a>,
    parent: usize,
    /// Pose in its parent of the frame that contains the body (m).
    parent_from_frame: Pose,
    class: Option<&'a str>,
}

/// An element in a body, with the frames around it composed.
struct Item<'a> {
    node: Node<'a, 'a>,
    body_from_frame: Pose,
    class: Option<&'a str>,
}

pub(in crate::import) fn read<'a>(draft: Draft<'a>, root: Node<'a, 'a>) -> Result<Imported, Error> {
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

    /// Reads all bodies of the tree, parents first.
    fn tree(&mut self, world: Node<'a, 'a>) -> Result<(), Error> {
        // An explicit stack, because a chain of bodies can be as long as the file.
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

    /// The contents of a body, including those of its frames, in the order of the file.
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

    /// The default class that a body or frame sets for its contents.
    fn childclass(&self, node: Node<'a, 'a>) -> Result<Option<&'a str>, Error> {
        let class = attribute(node, "childclass");
        class.map(|class| self.defaults.known(self.draft.xml, &class)).transpose()
    }

    /// A body with the joints to its parent; between several joints there are links without a body.
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
                    let name =
                        self.draft.fresh(format!("joint {}", self.draft.descriptions.len() + 1));
                    let frames = [before, Pose::identity()];
                    self.draft
                        .add_joint(bare(name, JointKind::Fixed, [from, to], frames), place(node))?;
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
    /// * `before` – pose of the body in the joint's first link, in the reference configuration (m)
    fn joint(&mut self, item: &Item<'a>, links: [usize; 2], before: Pose) -> Result<(), Error> {
        let (node, xml) = (item.node, self.draft.xml);
        let is_free = node.tag_name().name() == "freejoint";
        let class = self.defaults.class_of(xml, node, item.class)?;
        let value = |name| {
            attribute(node, name).or_else(|| self.defaults.attribute_value(class, "joint", name))
        };
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
                // The coordinate counts from the joint's position at MuJoCo's zero.
                joint.frames[0] *= kind.factors()[0].transform(&[-reference]);
                joint.guess = vec![reference];
            }
        }
        let mut passed_over = None;
        if let Some(range) = value("range").filter(|_| kind != JointKind::Floating) {
            let [least, most] = xml.numbers(&range, "2 numbers")?;
            let limited = match value("limited") {
                Some(limited) if limited.text != "auto" => xml.truth(&limited)?,
                _ if self.autolimits => least < most,
                _ => {
                    let advice =
                        Advice("without `autolimits`, a joint needs the attribute `limited`");
                    return Err(xml.unsupported(node, "a range alone", advice));
                }
            };
            let [least, most] = [least, most].map(|end| match end.abs() < ENDLESS {
                true => end,
                false => f64::INFINITY.copysign(end),
            });
            match (limited, has_axis) {
                (true, true) if least.is_infinite() && most.is_infinite() => {}
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
        let Some(name) = self.draft.xml.name(item.node)? else {
            self.draft.ignore("site without a name");
            return Ok(());
        };
        let class = self.defaults.class_of(self.draft.xml, item.node, item.class)?;
        let default = |name| self.defaults.attribute_value(class, "site", name);
        let pose = self.angles.pose(self.draft.xml, item.node, default)?;
        let link_from_site = item.body_from_frame * pose;
        self.draft.add_frame(name, place(item.node), link, link_from_site)?;
        self.sites.insert(name, (link, link_from_site));
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

    /// Pose of a body or frame.
    fn pose(&self, node: Node<'a, 'a>) -> Result<Pose, Error> {
        self.angles.pose(self.draft.xml, node, |_| None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::testing;

    const FOUR_BAR: &str = r#"<mujoco model="four-bar">
  <compiler angle="degree"/>
  <option timestep="0.001"/>
  <default><geom rgba="1 0 0 1"/><default class="d"><joint damping="1"/></default></default>
  <worldbody>
    <geom type="plane"/>
    <body name="crank" pos="0 0 0" euler="0 0 90" childclass="d">
      <joint name="a" axis="0 0 2" range="-90 90" armature="1"/>
      <geom/>
      <body name="coupler" pos="1 0 0" euler="0 0 -90">
        <joint name="b" axis="0 0 1"/>
        <joint name="b2" type="slide" axis="1 0 0"/>
        <site name="tip" pos="1 0 0"/>
      </body>
    </body>
    <body name="rocker" pos="2 0 0">
      <joint name="d" axis="0 0 1"/>
      <site name="top" pos="0 1 0"/>
    </body>
  </worldbody>
  <equality>
    <connect name="c" body1="coupler" body2="rocker" anchor="2 0 0" solref="0.01 1"/>
    <weld site1="tip" site2="top" active="false"/>
  </equality>
  <actuator><motor joint="a"/><motor site="tip"/></actuator>
</mujoco>"#;

    #[test]
    fn equalities_of_joints_are_couplings() {
        let equalities = r#"<equality>
    <joint name="gear" joint1="d" joint2="a" polycoef="0.1 -2"/>
    <joint joint1="b"/>
    <joint joint1="b2" joint2="d" active="false" polycoef="0 0 1"/>"#;
        let text = FOUR_BAR
            .replace("<equality>", equalities)
            .replace("range=\"-90 90\"", "ref=\"30\" range=\"-90 90\"");
        let model = testing::read(&text);
        let [gear, held] = model.mechanism.couplings() else { panic!() };
        let joint = |name| model.mechanism.joint(name).unwrap();
        assert_eq!((gear.name.as_str(), gear.follower.joint), ("gear", joint("d")));
        assert_eq!((gear.terms[0].0.joint, gear.terms[0].1), (joint("a"), -2.0));
        // Counted from the reference of the leader.
        let expected = 0.1 + 2.0 * f64::to_radians(30.0);
        assert!((gear.offset - expected).abs() < 1e-15, "{}", gear.offset);
        assert_eq!((held.follower.joint, held.terms.len(), held.offset), (joint("b"), 0, 0.0));
        assert!(model.ignored.contains(&"1 × inactive joint".to_owned()), "{:?}", model.ignored);
    }

    #[test]
    fn connect_closes_a_loop() {
        let model = testing::read(FOUR_BAR);
        let mechanism = &model.mechanism;
        assert_eq!(mechanism.links(), ["world", "crank", "coupler, part 1", "coupler", "rocker"]);
        assert_eq!(mechanism.loops(), 1);
        let [a, b, b2, d, c] = mechanism.joints() else { panic!() };
        assert!(a.actuated && !b.actuated && !d.actuated);
        assert_eq!(a.limits, [[-90.0, 90.0].map(f64::to_radians)]);
        assert!((a.frames[0].rotation * Vector3::x() - Vector3::y()).norm() < 1e-15);
        assert_eq!(b.frames[0].translation.vector, Vector3::x());
        assert!((b2.frames[0].rotation * Vector3::z() - Vector3::x()).norm() < 1e-15);
        assert_eq!(c.kind, JointKind::Spherical);
        // The coupler is parallel to the ground and one above it, and so is the anchor over the rocker.
        assert!((c.frames[1].translation.vector - Vector3::y()).norm() < 1e-15);
        let ignored = [
            "1 × armature of joint",
            "1 × damping of joint",
            "1 × default of geom",
            "2 × geom",
            "1 × inactive weld",
            "1 × motor that drives no joint",
            "1 × option",
            "1 × solref of connect",
        ];
        assert_eq!(model.ignored, ignored);
    }

    #[test]
    fn sites_are_frames_of_their_bodies() {
        let model = testing::read(
            "<mujoco><worldbody><site name=\"base\" pos=\"1 2 3\"/><body name=\"a\"><joint/><site name=\"a\" pos=\"0 0 1\"/><site/></body></worldbody></mujoco>",
        );
        let frames = model.mechanism.frames().iter();
        let found: Vec<_> = frames.map(|one| (one.name.as_str(), one.link)).collect();
        assert_eq!(found, [("base", 0), ("a (2)", 1)]);
        let renamed = "frame \"a\" is called \"a (2)\": a link has its name";
        assert_eq!(model.ignored, [renamed, "1 × site without a name"]);
        let two = "<mujoco><worldbody><body name=\"a\"><joint/></body><site name=\"s\"/><site name=\"t\"/></worldbody></mujoco>";
        let (from, to) = ("<site name=\"t\"/>", "<site name=\"s\"/>");
        testing::refuse(two, from, to, to, "\"s\"");
    }

    /// The joint of a body, from its element.
    #[track_caller]
    fn joint(element: &str) -> jointplay_core::mechanism::Joint {
        let text = format!("<mujoco><worldbody><body>{element}</body></worldbody></mujoco>");
        testing::read(&text).mechanism.joints()[0].clone()
    }

    #[test]
    fn every_kind_of_joint_is_imported() {
        for (element, kind) in [
            ("<joint/>", JointKind::Revolute),
            ("<joint type=\"hinge\"/>", JointKind::Revolute),
            ("<joint type=\"slide\"/>", JointKind::Prismatic),
            ("<joint type=\"ball\" range=\"0 30\"/>", JointKind::Spherical),
            ("<joint type=\"free\"/>", JointKind::Floating),
            ("<freejoint/>", JointKind::Floating),
            ("", JointKind::Fixed),
        ] {
            assert_eq!(joint(element).kind, kind, "{element}");
        }
    }

    #[test]
    fn limits_are_those_of_mujoco() {
        let limits =
            |attributes: &str| joint(&format!("<joint type=\"slide\" {attributes}/>")).limits;
        assert_eq!(limits("range=\"1 2\""), [[1.0, 2.0]]);
        assert_eq!(limits("range=\"1 2\" limited=\"auto\""), [[1.0, 2.0]]);
        assert!(limits("range=\"1 2\" limited=\"false\"").is_empty());
        assert!(limits("range=\"0 0\"").is_empty());
        assert_eq!(limits("range=\"-1e10 2\""), [[f64::NEG_INFINITY, 2.0]]);
        assert_eq!(limits("range=\"1 1e12\""), [[1.0, f64::INFINITY]]);
        assert!(limits("range=\"-1e10 1e10\"").is_empty());
        // A free joint has no limits, and needs no `limited` where a class has a range.
        let free =
            "<mujoco><compiler autolimits=\"false\"/><default><joint range=\"-1 1\"/></default>
            <worldbody><body><joint type=\"free\"/></body></worldbody></mujoco>";
        let free = testing::read(free);
        assert_eq!(free.mechanism.joints()[0].kind, JointKind::Floating);
        assert!(free.mechanism.joints()[0].limits.is_empty());
        // A joint whose reference is not zero keeps its own coordinates.
        let joint = joint("<joint type=\"slide\" ref=\"0.5\" range=\"0 1\"/>");
        assert_eq!((joint.limits, joint.guess), (vec![[0.0, 1.0]], vec![0.5]));
        assert_eq!(joint.frames[0].translation.vector, -Vector3::z() * 0.5);
    }

    #[test]
    fn generated_names_avoid_given_names() {
        let text = "<mujoco><worldbody><body/><body name=\"body 1\"/></worldbody></mujoco>";
        assert_eq!(testing::read(text).mechanism.links(), ["world", "body 1 (2)", "body 1"]);
    }

    #[test]
    fn unsupported_and_invalid_elements_are_rejected() {
        let refuse =
            |from, to, blamed, message| testing::refuse(FOUR_BAR, from, to, blamed, message);
        let option = "<option timestep=\"0.001\"/>";
        refuse("\"0 0 2\"", "\"0 0 0\"", "0 0 0", "a direction that is not 0");
        refuse(
            "\"2 0 0\" sol",
            "\"2 0\" sol",
            "2 0",
            "`anchor` is \"2 0\", but has to be 3 numbers",
        );
        refuse(
            " anchor=\"2 0 0\"",
            "",
            "<connect name=\"c\" body1=\"coupler\" body2=\"rocker\" solref=\"0.01 1\"/>",
            "`connect` needs `anchor`",
        );
        refuse("body2=\"rocker\"", "body2=\"roker\"", "roker", "did you mean `rocker`?");
        refuse(option, "<include file=\"a\"/>", "<include file=\"a\"/>", "mj_saveLastXML");
        refuse(
            "<geom/>",
            "<replicate count=\"2\"/>",
            "<replicate count=\"2\"/>",
            "<replicate> cannot",
        );
        refuse("<geom/>", "<gem/>", "<gem/>", "no such element");
        refuse(option, "<options/>", "<options/>", "no such section");
        refuse("\"slide\"", "\"screw\"", "screw", "hinge, slide, ball or free");
        refuse("name=\"d\"", "name=\"a\"", "<joint name=\"a\" axis=\"0 0 1\"/>", "used twice");
        refuse(
            "\"rocker\" pos",
            "\"crank\" pos",
            "<body name=\"crank\" pos=\"2 0 0\">",
            "used twice",
        );
        refuse("name=\"d\"", "name=\"\"", "", "a name, not empty");
        refuse("\"degree\"", "\"grad\"", "grad", "degree or radian");
        refuse("angle=\"degree\"", "eulerseq=\"xyw\"", "xyw", "3 letters of x, y, z, X, Y, Z");
        refuse("angle=\"degree\"", "eulerseq=\"xy\"", "xy", "3 letters");
        refuse("angle=\"degree\"", "coordinate=\"global\"", "global", "MuJoCo 2.3.3");
        refuse(
            "angle=\"degree\"",
            "autolimits=\"false\"",
            "<joint name=\"a\" axis=\"0 0 2\" range=\"-90 90\" armature=\"1\"/>",
            "a range alone",
        );
        refuse("\"-90 90\"", "\"90 -90\" limited=\"true\"", "90 -90", "the least before");
        refuse(
            "euler=\"0 0 90\"",
            "euler=\"0 0 90\" quat=\"1 0 0 0\"",
            "0 0 90",
            "has to be absent",
        );
        refuse("euler=\"0 0 90\"", "quat=\"0 0 0 0\"", "0 0 0 0", "a quaternion that is not 0");
        refuse("euler=\"0 0 90\"", "xyaxes=\"1 0 0 -2 0 0\"", "1 0 0 -2 0 0", "not parallel");
        refuse("childclass=\"d\"", "childclass=\"e\"", "e", "default class \"e\" is not known");
        refuse(
            "<default class=\"d\">",
            "<default>",
            "<default><joint damping=\"1\"/></default>",
            "`default` needs `class`",
        );
        refuse(
            "active=\"false\"",
            "torquescale=\"0\"",
            "<weld site1=\"tip\" site2=\"top\" torquescale=\"0\"/>",
            "use a connect instead",
        );
        refuse(
            "site2=\"top\" active=\"false\"",
            "",
            "<weld site1=\"tip\" />",
            "`weld` needs `site2`",
        );
        refuse(
            "site2=\"top\" active=\"false\"",
            "site2=\"tap\"",
            "tap",
            "site \"tap\" is not known",
        );
        refuse(
            "<weld site1=\"tip\" site2=\"top\" active=\"false\"/>",
            "<joint joint1=\"a\" joint2=\"d\" polycoef=\"0 1 2\"/>",
            "<joint joint1=\"a\" joint2=\"d\" polycoef=\"0 1 2\"/>",
            "a polynomial of higher degree",
        );
        refuse("motor joint=\"a\"", "motor joint=\"z\"", "z", "joint \"z\" is not known");
    }
}
