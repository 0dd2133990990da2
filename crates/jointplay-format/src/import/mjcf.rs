//! Models of MuJoCo (MJCF): bodies in a tree, closed to loops by `connect` and `weld`.

use std::collections::{BTreeMap, BTreeSet};

use jointplay_core::mechanism::{Joint, JointKind, Mechanism, MechanismError, Play};
use jointplay_core::spatial::Pose;
use nalgebra::{Quaternion, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use roxmltree::{Document, Node};

use crate::mechanism::MAX_BYTES;
use crate::mechanism::frame::{pose, some_perpendicular};

/// Why a text is no model that can be taken over, and where.
pub type Error = crate::place::Error<Problem>;

/// What can be wrong in a model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// Not XML.
    #[error("{0}")]
    Xml(String),
    /// Something that would change the mechanism if it were passed over.
    #[error("{0} cannot be taken over")]
    Unsupported(String),
    /// An attribute that is missing or has an unusable value.
    #[error("`{attribute}` has to be {expected}")]
    Attribute {
        /// The attribute.
        attribute: &'static str,
        /// What it has to be.
        expected: &'static str,
    },
    /// Bodies and joints that make no mechanism.
    #[error(transparent)]
    Mechanism(#[from] MechanismError),
}

/// Elements inside a body that are no part of its mechanism.
const UNMOVING: [&str; 6] = ["geom", "inertial", "site", "camera", "light", "plugin"];

struct Reader<'a> {
    text: &'a str,
    in_degrees: bool,
    euler: String,
    links: Vec<String>,
    /// Pose of each link in the reference configuration [m].
    world_from_link: Vec<Pose>,
    joints: Vec<Joint>,
    ignored: BTreeMap<String, usize>,
}

/// Takes over a model; also lists what is ignored.
///
/// Hinges become revolute joints, slides prismatic, balls spherical and free joints floating; a body without joints is fixed to its parent.
/// `connect` closes a loop by a spherical joint, `weld` by a fixed one.
///
/// # Errors
/// [`Error`] with the place: text that is no XML, unusable values, or what would change the mechanism if it were ignored.
pub fn parse(text: &str) -> Result<(Mechanism, Vec<String>), Error> {
    if text.len() > MAX_BYTES {
        let what = format!("a text of more than {MAX_BYTES} bytes");
        return Err(Error::at(text, 0..0, Problem::Unsupported(what)));
    }
    let document = Document::parse(text).map_err(|error| {
        let at = error.pos();
        let line =
            text.split_inclusive('\n').take(at.row as usize - 1).map(str::len).sum::<usize>();
        Error::at(text, line..line, Problem::Xml(error.to_string()))
    })?;
    let root = document.root_element();
    let mut reader = Reader {
        text,
        in_degrees: true,
        euler: "xyz".to_owned(),
        links: vec!["world".to_owned()],
        world_from_link: vec![Pose::identity()],
        joints: Vec::new(),
        ignored: BTreeMap::new(),
    };
    reader.refuse_what_changes_all(root)?;
    for compiler in elements(root, "compiler") {
        reader.in_degrees =
            compiler.attribute("angle").map_or(reader.in_degrees, |a| a != "radian");
        reader.euler = compiler.attribute("eulerseq").unwrap_or(&reader.euler).to_owned();
    }
    for world in elements(root, "worldbody") {
        reader.bodies(world)?;
    }
    for equality in elements(root, "equality") {
        for node in equality.children().filter(Node::is_element) {
            reader.equality(node)?;
        }
    }
    let driven: BTreeSet<&str> = elements(root, "actuator")
        .flat_map(|actuator| actuator.children())
        .filter_map(|node| node.attribute("joint"))
        .collect();
    for joint in &mut reader.joints {
        joint.actuated = driven.contains(joint.name.as_str());
    }
    for node in root.children().filter(Node::is_element) {
        let name = node.tag_name().name();
        if !["compiler", "worldbody", "equality", "actuator"].contains(&name) {
            reader.ignore(name);
        }
    }
    let name = root.attribute("model").unwrap_or("MuJoCo model");
    let mechanism = Mechanism::new(name, reader.links, reader.joints)
        .map_err(|error| Error::at(text, root.range(), error.into()))?;
    let ignored = reader.ignored.into_iter().map(|(what, count)| format!("{count} × {what}"));
    Ok((mechanism, ignored.collect()))
}

fn elements<'a>(node: Node<'a, 'a>, name: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(move |child| child.has_tag_name(name))
}

impl Reader<'_> {
    fn wrong(&self, node: Node, problem: Problem) -> Error {
        Error::at(self.text, node.range(), problem)
    }

    fn unsupported(&self, node: Node, what: impl Into<String>) -> Error {
        self.wrong(node, Problem::Unsupported(what.into()))
    }

    fn ignore(&mut self, what: &str) {
        *self.ignored.entry(what.to_owned()).or_default() += 1;
    }

    fn refuse_what_changes_all(&self, root: Node) -> Result<(), Error> {
        if !root.has_tag_name("mujoco") {
            return Err(self.unsupported(root, format!("`{}`", root.tag_name().name())));
        }
        let defaults = elements(root, "default").flat_map(|default| default.descendants());
        for node in defaults.filter(|node| node.has_tag_name("joint")) {
            let shapes = ["type", "axis", "pos", "range"];
            if shapes.iter().any(|attribute| node.has_attribute(*attribute)) {
                return Err(self.unsupported(node, "a default for joints"));
            }
        }
        for node in root.descendants().filter(Node::is_element) {
            let name = node.tag_name().name();
            for attribute in ["name", "model"] {
                let value = node.attribute(attribute).unwrap_or("unnamed");
                if value.trim().is_empty() || value.chars().any(char::is_control) {
                    let expected = "not empty and without control characters";
                    return Err(self.wrong(node, Problem::Attribute { attribute, expected }));
                }
            }
            if ["include", "frame", "replicate", "attach"].contains(&name) {
                return Err(self.unsupported(node, format!("`{name}`")));
            }
            if name == "compiler" && node.attribute("coordinate") == Some("global") {
                return Err(self.unsupported(node, "global coordinates"));
            }
        }
        Ok(())
    }

    /// All bodies of the tree, parents first.
    fn bodies(&mut self, world: Node) -> Result<(), Error> {
        // A stack of its own, for a chain of bodies can be as long as the file.
        let mut open = vec![(world, 0)];
        while let Some((node, link)) = open.pop() {
            let mut bodies = Vec::new();
            for child in node.children().filter(Node::is_element) {
                match child.tag_name().name() {
                    "body" => bodies.push(child),
                    "joint" | "freejoint" if link != 0 => {}
                    name if UNMOVING.contains(&name) => self.ignore(name),
                    name => return Err(self.unsupported(child, format!("`{name}` here"))),
                }
            }
            let mut children = Vec::new();
            for body in bodies {
                children.push((body, self.body(body, link)?));
            }
            open.extend(children.into_iter().rev());
        }
        Ok(())
    }

    /// A body with the joints to its parent; several joints have links without a body between them.
    fn body(&mut self, body: Node, parent: usize) -> Result<usize, Error> {
        let number = self.links.len();
        let name = body.attribute("name").map_or_else(|| format!("body {number}"), str::to_owned);
        let parent_from_body = self.pose(body)?;
        let world_from_body = self.world_from_link[parent] * parent_from_body;
        let moving = |node: &Node| node.has_tag_name("joint") || node.has_tag_name("freejoint");
        let joints: Vec<Node> = body.children().filter(moving).collect();
        let (mut from, mut place) = (parent, parent_from_body);
        for index in 0..joints.len().max(1) {
            let is_last = index + 1 >= joints.len();
            let link = if is_last { name.clone() } else { format!("{name}, part {}", index + 1) };
            let to = self.links.len();
            self.links.push(link);
            self.world_from_link.push(world_from_body);
            let fallback = format!("joint {}", self.joints.len() + 1);
            let mut joint = bare(fallback, JointKind::Fixed, [from, to], [place, Pose::identity()]);
            if let Some(&node) = joints.get(index) {
                self.shape(&mut joint, node)?;
                joint.frames[0] = place * joint.frames[1];
            }
            self.joints.push(joint);
            (from, place) = (to, Pose::identity());
        }
        Ok(from)
    }

    /// Kind, frame on the body, name and limits of a joint.
    fn shape(&mut self, joint: &mut Joint, node: Node) -> Result<(), Error> {
        let is_free = node.has_tag_name("freejoint");
        let kind = if is_free { "free" } else { node.attribute("type").unwrap_or("hinge") };
        joint.kind = match kind {
            "hinge" => JointKind::Revolute,
            "slide" => JointKind::Prismatic,
            "ball" => JointKind::Spherical,
            "free" => JointKind::Floating,
            _ => {
                let expected = "hinge, slide, ball or free";
                return Err(self.wrong(node, Problem::Attribute { attribute: "type", expected }));
            }
        };
        if let Some(name) = node.attribute("name") {
            name.clone_into(&mut joint.name);
        }
        let point = self.vector(node, "pos")?.unwrap_or_default();
        let axis = self.vector(node, "axis")?.unwrap_or(Vector3::z());
        let has_axis = matches!(joint.kind, JointKind::Revolute | JointKind::Prismatic);
        if kind != "free" {
            let z = if has_axis { self.unit(node, "axis", axis)? } else { Vector3::z_axis() };
            joint.frames[1] = pose(point, some_perpendicular(z), z);
        }
        if node.attribute("ref").is_some_and(|value| value.trim().parse() != Ok(0.0)) {
            return Err(self.unsupported(node, "a joint whose reference is not 0"));
        }
        let range = self.numbers::<2>(node, "range", "2 numbers")?;
        if let Some(range) = range.filter(|_| node.attribute("limited") != Some("false")) {
            if has_axis {
                let turns = joint.kind == JointKind::Revolute;
                joint.limits = vec![range.map(|v| if turns { self.radians(v) } else { v })];
            } else {
                self.ignore("range of a ball");
            }
        }
        for attribute in ["stiffness", "damping", "springref", "armature", "frictionloss"] {
            if node.has_attribute(attribute) {
                self.ignore(&format!("{attribute} of a joint"));
            }
        }
        Ok(())
    }

    /// A loop closure.
    fn equality(&mut self, node: Node) -> Result<(), Error> {
        let kind = match node.tag_name().name() {
            "connect" => JointKind::Spherical,
            "weld" => JointKind::Fixed,
            other => {
                self.ignore(&format!("equality/{other}"));
                return Ok(());
            }
        };
        if node.attribute("active") == Some("false") {
            self.ignore("inactive equality");
            return Ok(());
        }
        if node.has_attribute("site1") {
            return Err(self.unsupported(node, "a closure between sites"));
        }
        let body = |attribute: &'static str| match node.attribute(attribute) {
            None if attribute == "body2" => Ok(0),
            name => {
                self.links.iter().position(|link| Some(link.as_str()) == name).ok_or_else(|| {
                    let expected = "the name of a body";
                    self.wrong(node, Problem::Attribute { attribute, expected })
                })
            }
        };
        let links = [body("body1")?, body("body2")?];
        let [world_from_1, world_from_2] = links.map(|link| self.world_from_link[link]);
        let frames = if kind == JointKind::Spherical {
            let Some(anchor) = self.vector(node, "anchor")? else {
                let problem = Problem::Attribute { attribute: "anchor", expected: "given" };
                return Err(self.wrong(node, problem));
            };
            let frame = Pose::from_parts(Translation3::from(anchor), Rotation3::identity());
            [frame, world_from_2.inverse() * world_from_1 * frame]
        } else {
            let relative = self.numbers::<7>(node, "relpose", "7 numbers")?;
            // A quaternion of zeros stands for the pose of the reference configuration.
            let given = relative.filter(|pose| pose[3..].iter().any(|&entry| entry != 0.0));
            let first_from_second = match given {
                Some([x, y, z, a, b, c, d]) => {
                    Pose::from_parts(Translation3::new(x, y, z), quaternion([a, b, c, d]))
                }
                None => world_from_1.inverse() * world_from_2,
            };
            [first_from_second, Pose::identity()]
        };
        let fallback = || format!("{} {}", node.tag_name().name(), self.joints.len() + 1);
        let name = node.attribute("name").map_or_else(fallback, str::to_owned);
        self.joints.push(bare(name, kind, links, frames));
        Ok(())
    }

    /// Where a body is in its parent's frame.
    fn pose(&self, node: Node) -> Result<Pose, Error> {
        let point = self.vector(node, "pos")?.unwrap_or_default();
        let rotation = if let Some(entries) = self.numbers(node, "quat", "4 numbers")? {
            if entries == [0.0; 4] {
                let expected = "a quaternion that is not 0";
                return Err(self.wrong(node, Problem::Attribute { attribute: "quat", expected }));
            }
            quaternion(entries)
        } else if let Some([x, y, z, angle]) = self.numbers(node, "axisangle", "4 numbers")? {
            let axis = self.unit(node, "axisangle", Vector3::new(x, y, z))?;
            Rotation3::from_axis_angle(&axis, self.radians(angle))
        } else if let Some(angles) = self.numbers::<3>(node, "euler", "3 numbers")? {
            self.euler(angles)
        } else if node.has_attribute("xyaxes") || node.has_attribute("zaxis") {
            return Err(self.unsupported(node, "a body turned by `xyaxes` or `zaxis`"));
        } else {
            Rotation3::identity()
        };
        Ok(Pose::from_parts(Translation3::from(point), rotation))
    }

    /// Turns one after another: about axes that turn along (small letters) or stand still (capitals).
    fn euler(&self, angles: [f64; 3]) -> Rotation3<f64> {
        self.euler.chars().zip(angles).fold(Rotation3::identity(), |rotation, (letter, angle)| {
            let axis = match letter.to_ascii_lowercase() {
                'x' => Vector3::x_axis(),
                'y' => Vector3::y_axis(),
                _ => Vector3::z_axis(),
            };
            let turn = Rotation3::from_axis_angle(&axis, self.radians(angle));
            if letter.is_lowercase() { rotation * turn } else { turn * rotation }
        })
    }

    fn radians(&self, angle: f64) -> f64 {
        if self.in_degrees { angle.to_radians() } else { angle }
    }

    fn unit(
        &self,
        node: Node,
        attribute: &'static str,
        vector: Vector3<f64>,
    ) -> Result<Unit<Vector3<f64>>, Error> {
        Unit::try_new(vector, 1e-12).ok_or_else(|| {
            self.wrong(
                node,
                Problem::Attribute { attribute, expected: "a direction that is not 0" },
            )
        })
    }

    fn vector(&self, node: Node, attribute: &'static str) -> Result<Option<Vector3<f64>>, Error> {
        Ok(self.numbers::<3>(node, attribute, "3 numbers")?.map(Vector3::from))
    }

    fn numbers<const N: usize>(
        &self,
        node: Node,
        attribute: &'static str,
        expected: &'static str,
    ) -> Result<Option<[f64; N]>, Error> {
        let Some(value) = node.attribute(attribute) else { return Ok(None) };
        let numbers: Result<Vec<f64>, _> = value.split_whitespace().map(str::parse).collect();
        let numbers = numbers.ok().filter(|numbers| numbers.iter().all(|n: &f64| n.is_finite()));
        match numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok()) {
            Some(numbers) => Ok(Some(numbers)),
            None => Err(self.wrong(node, Problem::Attribute { attribute, expected })),
        }
    }
}

/// The rotation of a quaternion, its real part first.
fn quaternion([w, x, y, z]: [f64; 4]) -> Rotation3<f64> {
    UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)).to_rotation_matrix()
}

fn bare(name: String, kind: JointKind, links: [usize; 2], frames: [Pose; 2]) -> Joint {
    Joint {
        name,
        kind,
        links,
        frames,
        actuated: false,
        guess: Vec::new(),
        limits: Vec::new(),
        clearance: Play::default(),
        stiffness: Play::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOUR_BAR: &str = r#"<mujoco model="four-bar">
  <option timestep="0.001"/>
  <worldbody>
    <geom type="plane"/>
    <body name="crank" pos="0 0 0" euler="0 0 90">
      <joint name="a" axis="0 0 2" range="-90 90"/>
      <geom/>
      <body name="coupler" pos="1 0 0" euler="0 0 -90">
        <joint name="b" axis="0 0 1"/>
        <joint name="b2" type="slide" axis="1 0 0"/>
      </body>
    </body>
    <body name="rocker" pos="2 0 0">
      <joint name="d" axis="0 0 1"/>
    </body>
  </worldbody>
  <equality>
    <connect name="c" body1="coupler" body2="rocker" anchor="2 0 0"/>
    <joint joint1="a"/>
  </equality>
  <actuator><motor joint="a"/></actuator>
</mujoco>"#;

    #[test]
    fn a_loop_is_closed_by_connect() {
        let (mechanism, ignored) = parse(FOUR_BAR).unwrap();
        assert_eq!(mechanism.links(), ["world", "crank", "rocker", "coupler, part 1", "coupler"]);
        assert_eq!(mechanism.loops(), 1);
        let [a, d, b, b2, c] = mechanism.joints() else { panic!() };
        assert!(a.actuated && !b.actuated && !d.actuated);
        assert_eq!(a.limits, [[-90.0, 90.0].map(f64::to_radians)]);
        assert!((a.frames[0].rotation * Vector3::x() - Vector3::y()).norm() < 1e-15);
        assert_eq!(b.frames[0].translation.vector, Vector3::x());
        assert!((b2.frames[0].rotation * Vector3::z() - Vector3::x()).norm() < 1e-15);
        assert_eq!(c.kind, JointKind::Spherical);
        // The coupler is parallel to the ground and one above it, and so is the anchor over the rocker.
        assert!((c.frames[1].translation.vector - Vector3::y()).norm() < 1e-15);
        assert_eq!(ignored, ["1 × equality/joint", "2 × geom", "1 × option"]);
    }

    #[test]
    fn what_would_change_the_mechanism_is_refused() {
        for (from, to, message) in [
            ("axis=\"0 0 2\"", "axis=\"0 0 0\"", "a direction that is not 0"),
            ("anchor=\"2 0 0\"", "anchor=\"2 0\"", "`anchor` has to be 3 numbers"),
            ("body2=\"rocker\"", "body2=\"roker\"", "the name of a body"),
            ("<option timestep=\"0.001\"/>", "<include file=\"a\"/>", "`include` cannot"),
            ("type=\"slide\"", "type=\"screw\"", "hinge, slide, ball or free"),
            (
                "<option timestep=\"0.001\"/>",
                "<default><default><joint axis=\"1 0 0\"/></default></default>",
                "a default for joints",
            ),
            ("name=\"d\"", "name=\"a\"", "used twice"),
            ("</mujoco>", "", ""),
        ] {
            assert!(FOUR_BAR.contains(from), "{from}");
            let error = parse(&FOUR_BAR.replacen(from, to, 1)).unwrap_err();
            assert!(error.to_string().contains(message), "{}", error.with_excerpt("x"));
        }
    }

    #[test]
    fn deep_trees_do_not_overflow_the_stack() {
        let deep = |count: usize| {
            let (open, close) = ("<body>".repeat(count), "</body>".repeat(count));
            format!("<mujoco><worldbody>{open}{close}</worldbody></mujoco>")
        };
        assert_eq!(parse(&deep(900)).unwrap().0.joints().len(), 900);
        let _ = parse(&deep(100_000)).unwrap_err();
    }

    #[test]
    fn no_cut_text_panics() {
        for cut in 0..FOUR_BAR.len() {
            for text in [&FOUR_BAR[..cut], &FOUR_BAR[cut..]] {
                if let Err(error) = parse(text) {
                    let _ = error.with_excerpt("x");
                }
            }
        }
    }
}
