//! Models of Gazebo (SDF): links and joints in any graph, with poses in frames.
//!
//! The world is the base; in a model that is not fixed to a world, the canonical link is the base.
//! Links of static models are fixed to the world.

use jointplay_core::mechanism::JointKind;
use jointplay_core::spatial::Pose;
use roxmltree::Node;

use super::frames::{Frames, Kind, WORLD};
use crate::export::mechanism::POSITION_CONTROLLER;
use crate::import::draft::{Draft, bare};
use crate::import::model::{Dialect, Imported};
use crate::import::problem::Error;
use crate::import::xml::{
    Advice, Xml, attribute, child, children, content, elements, is_foreign, place,
};

const EXPAND: Advice =
    Advice("it represents a model of another file; `gz sdf -p FILE` prints the expanded model");

/// Elements of a world that do not affect the mechanism.
const WORLD_ASIDE: [&str; 15] = [
    "actor",
    "atmosphere",
    "audio",
    "gravity",
    "gui",
    "light",
    "magnetic_field",
    "physics",
    "plugin",
    "road",
    "scene",
    "spherical_coordinates",
    "state",
    "wind",
    "particle_emitter",
];

/// Elements of a model that do not affect the mechanism.
const MODEL_ASIDE: [&str; 5] =
    ["allow_auto_disable", "enable_wind", "gripper", "plugin", "self_collide"];

pub(super) struct Reader<'a> {
    pub(super) draft: Draft<'a>,
    pub(super) frames: Frames<'a>,
    /// Frames of the joints to be read.
    pub(super) joints: Vec<usize>,
    /// Link of the mechanism for each frame that is a link.
    pub(super) link_of_frame: Vec<Option<usize>>,
    /// Controllers of joints to positions.
    controllers: Vec<(usize, Node<'a, 'a>)>,
    /// Prefix, with `::`, of the only model of a file: its links need no prefix.
    pub(super) only_model: Option<String>,
}

pub(in crate::import) fn read<'a>(draft: Draft<'a>, root: Node<'a, 'a>) -> Result<Imported, Error> {
    let version = version(draft.xml, root)?;
    let frames = Frames::new(draft.xml, version);
    let mut reader = Reader {
        draft,
        frames,
        joints: Vec::new(),
        link_of_frame: Vec::new(),
        controllers: Vec::new(),
        only_model: None,
    };
    let mut top = None;
    for node in children(root) {
        match node.tag_name().name() {
            "world" | "model" if top.is_none() => top = Some(node),
            name @ ("world" | "model") => {
                let advice = Advice("a file is one mechanism; keep only one world or model");
                let what = format!("a second <{name}>");
                return Err(reader.draft.xml.unsupported(node, what, advice));
            }
            "include" => return Err(reader.draft.xml.unsupported(node, "<include>", EXPAND)),
            name => reader.draft.ignore(name),
        }
    }
    let top = top.ok_or_else(|| reader.draft.xml.missing(root, "world` or `model"))?;
    let name = reader.draft.xml.needed_name(top)?;
    let is_world = top.tag_name().name() == "world";
    reader.only_model = (!is_world).then(|| format!("{name}::"));
    reader.register(top, is_world)?;
    reader.frames.resolve()?;
    reader.links(top, is_world)?;
    for index in 0..reader.joints.len() {
        reader.joint(reader.joints[index])?;
    }
    for index in 0..reader.joints.len() {
        let frame = reader.joints[index];
        match reader.is_gearbox(frame) {
            true => reader.gearbox(frame)?,
            false => reader.mimics(frame)?,
        }
    }
    reader.attach_frames()?;
    reader.actuate();
    reader.add_floating_joints()?;
    reader.draft.finish(name, Dialect::Sdf)
}

/// The version of the format: its two numbers.
fn version<'a>(xml: Xml<'a>, root: Node<'a, 'a>) -> Result<(u32, u32), Error> {
    let value = attribute(root, "version").ok_or_else(|| xml.missing(root, "version"))?;
    let numbers = value.text.split_once('.');
    let numbers = numbers.and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    let known = numbers.filter(|version| ((1, 2)..=(1, 12)).contains(version));
    known.ok_or_else(|| xml.unusable(&value, "a version from 1.2 to 1.12"))
}

impl<'a> Reader<'a> {
    /// Enters all frames of a world or model: links, joints, models and explicit frames.
    fn register(&mut self, top: Node<'a, 'a>, is_world: bool) -> Result<(), Error> {
        let xml = self.draft.xml;
        let mut open = Vec::new();
        if is_world {
            open.push((top, WORLD, false));
        } else {
            let model = self.frames.add(WORLD, Kind::Model, top)?;
            open.push((top, model, self.is_static(top, false)?));
        }
        while let Some((node, scope, is_static)) = open.pop() {
            let (mut models, mut joints) = (Vec::new(), Vec::new());
            for inner in children(node) {
                let name = inner.tag_name().name();
                let in_world = scope == WORLD;
                match name {
                    "joint" if is_foreign(inner) => {
                        let advice = Advice("only joints of SDF itself are supported");
                        return Err(xml.unsupported(inner, "a joint of a dialect", advice));
                    }
                    _ if is_foreign(inner) => self.draft.ignore(name),
                    "model" => {
                        let is_static = self.is_static(inner, is_static)?;
                        models.push((
                            inner,
                            self.frames.add(scope, Kind::Model, inner)?,
                            is_static,
                        ));
                    }
                    "link" if !in_world => {
                        self.frames.add(scope, Kind::Link { is_static }, inner)?;
                        self.ignore_parts(inner);
                    }
                    "frame" => {
                        self.frames.add(scope, Kind::Frame, inner)?;
                    }
                    "joint" => joints.push(inner),
                    "pose" | "static" if !in_world => {}
                    "plugin"
                        if attribute(inner, "name")
                            .is_some_and(|name| name.text == POSITION_CONTROLLER) =>
                    {
                        self.controllers.push((scope, inner));
                    }
                    "include" => return Err(xml.unsupported(inner, "<include>", EXPAND)),
                    _ if in_world && WORLD_ASIDE.contains(&name) => self.draft.ignore(name),
                    _ if !in_world && MODEL_ASIDE.contains(&name) => self.draft.ignore(name),
                    _ => {
                        let advice = Advice("its effect on the mechanism is unknown");
                        let what = format!("<{name}> in {}", node.tag_name().name());
                        return Err(xml.unsupported(inner, what, advice));
                    }
                }
            }
            for joint in joints {
                let frame = self.frames.add(scope, Kind::Joint, joint)?;
                if is_static {
                    self.draft.ignore("joint of a static model");
                } else {
                    self.joints.push(frame);
                }
            }
            open.extend(models.into_iter().rev());
        }
        Ok(())
    }

    /// Marks the joints that a controller drives to positions as actuated.
    fn actuate(&mut self) {
        for (scope, plugin) in std::mem::take(&mut self.controllers) {
            let frame = child(plugin, "joint_name").map(|name| self.frames.find(scope, &name));
            let joint = frame.and_then(|found| self.draft.joint(self.shown(found.ok()?)));
            match joint {
                Some(joint) => self.draft.descriptions[joint].actuated = true,
                None => self.draft.ignore("position controller of an unknown joint"),
            }
        }
    }

    fn is_static(&self, model: Node<'a, 'a>, around: bool) -> Result<bool, Error> {
        let value = child(model, "static");
        let own = value.map(|value| self.draft.xml.truth(&value)).transpose()?;
        Ok(around || own.unwrap_or(false))
    }

    /// Lists the parts of a link except its pose as ignored.
    fn ignore_parts(&mut self, link: Node<'a, 'a>) {
        for part in children(link).filter(|part| part.tag_name().name() != "pose") {
            self.draft.ignore(part.tag_name().name());
        }
    }

    /// Adds the base, then all links in the order of the file.
    fn links(&mut self, top: Node<'a, 'a>, is_world: bool) -> Result<(), Error> {
        let frames: Vec<usize> = self.frames.links().collect();
        let Some(&first) = frames.first() else {
            let advice = Advice("a mechanism has links and joints");
            return Err(self.draft.xml.unsupported(top, "a file without links", advice));
        };
        self.link_of_frame = vec![None; self.frames.len()];
        let names_world = |&joint: &usize| {
            let node = self.frames.node(joint);
            ["parent", "child"]
                .iter()
                .any(|end| elements(node, end).any(|end| content(end).text == "world"))
        };
        let has_static = frames.iter().any(|&frame| self.frames.is_static(frame));
        let has_world = is_world || has_static || self.joints.iter().any(names_world);
        let mut order = frames.clone();
        if has_world {
            self.draft.add_link("world", place(top))?;
            self.link_of_frame[WORLD] = Some(0);
        } else {
            let base = self.frames.canonical_link().unwrap_or(first);
            order.retain(|&frame| frame != base);
            order.insert(0, base);
            let name = self.shown(base).to_owned();
            self.draft.remark(format!(
                "the model is not fixed to the world: its link {name:?} is the base"
            ));
        }
        for frame in order {
            let span = place(self.frames.node(frame));
            let link = self.draft.add_link(self.shown(frame).to_owned(), span.clone())?;
            self.link_of_frame[frame] = Some(link);
            if self.frames.is_static(frame) {
                let name = self.draft.fresh(format!("{} is static", self.draft.link_name(link)));
                let frames = [self.frames.world_from(frame), Pose::identity()];
                self.draft.add_joint(bare(name, JointKind::Fixed, [0, link], frames), span)?;
            }
        }
        Ok(())
    }

    /// Adds the frames that move with links.
    fn attach_frames(&mut self) -> Result<(), Error> {
        for frame in self.frames.explicit().collect::<Vec<_>>() {
            let carrier = self.frames.link_of(frame)?;
            let Some(link) = self.link_of_frame[carrier] else {
                self.draft.ignore("frame");
                continue;
            };
            let link_from_world = self.frames.world_from(carrier).inverse();
            let name = self.shown(frame).to_owned();
            let link_from_frame = link_from_world * self.frames.world_from(frame);
            let place = place(self.frames.node(frame));
            self.draft.add_frame(&name, place, link, link_from_frame)?;
        }
        Ok(())
    }

    /// The name of a frame, as the mechanism has it.
    pub(super) fn shown(&self, frame: usize) -> &str {
        let name = self.frames.name(frame);
        self.only_model.as_deref().and_then(|model| name.strip_prefix(model)).unwrap_or(name)
    }

    /// Adds floating joints between the base and groups of links without a connection to it.
    fn add_floating_joints(&mut self) -> Result<(), Error> {
        let frame_of_link = |link: usize| {
            let found = self.link_of_frame.iter().position(|&found| found == Some(link));
            found.expect("every link is a frame")
        };
        let world_from_base = self.frames.world_from(frame_of_link(0));
        let mut group: Vec<usize> = (0..self.draft.links()).collect();
        for joint in &self.draft.descriptions {
            let [a, b] = joint.links.map(|link| root_of(&mut group, link));
            group[a.max(b)] = a.min(b);
        }
        let mut free = Vec::new();
        for (frame, link) in self.link_of_frame.iter().enumerate() {
            let Some(link) = *link else { continue };
            // The first link of each group represents it.
            if link != 0 && root_of(&mut group, link) == link {
                free.push((link, frame));
            }
        }
        for (link, frame) in free {
            let of = self.draft.link_name(link).to_owned();
            self.draft.remark(format!("link {of:?} is not fixed to the world: it floats"));
            let name = self.draft.fresh(format!("{of} floats"));
            let frames =
                [world_from_base.inverse() * self.frames.world_from(frame), Pose::identity()];
            let joint = bare(name, JointKind::Floating, [0, link], frames);
            self.draft.add_joint(joint, self.draft.link_place(link))?;
        }
        Ok(())
    }
}

/// The smallest link of a group, with path compression.
fn root_of(group: &mut [usize], mut link: usize) -> usize {
    while group[link] != link {
        group[link] = group[group[link]];
        link = group[link];
    }
    link
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::testing;
    use nalgebra::Vector3;
    use std::f64::consts::TAU;

    const ARM: &str = r#"<sdf version="1.9">
  <model name="arm">
    <plugin name="p" filename="f"/>
    <link name="foot"/>
    <frame name="hip" attached_to="foot"><pose>0 0 1 0 0 0</pose></frame>
    <link name="leg">
      <pose relative_to="hip">0 0 0 0 0 0</pose>
      <collision name="c"/>
    </link>
    <joint name="knee" type="revolute">
      <parent>foot</parent>
      <child>leg</child>
      <axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis>
    </joint>
  </model>
</sdf>"#;

    #[test]
    fn without_a_world_the_canonical_link_is_the_base() {
        let model = testing::read(ARM);
        assert_eq!(model.mechanism.links(), ["foot", "leg"]);
        let [knee] = model.mechanism.joints() else { panic!() };
        assert_eq!(knee.limits, [[-1.0, 1.0]]);
        assert_eq!(knee.frames[0].translation.vector, Vector3::z());
        assert_eq!(knee.frames[1].rotation * Vector3::z(), Vector3::y());
        let base = "the model is not fixed to the world: its link \"foot\" is the base";
        assert_eq!(model.ignored, [base, "1 × collision", "1 × plugin"]);
        let other = ARM.replace("name=\"arm\"", "name=\"arm\" canonical_link=\"leg\"");
        assert_eq!(testing::read(&other).mechanism.links(), ["leg", "foot"]);
    }

    /// Two wheels on a carrier that turns; the second joint has the carrier as its child.
    const GEARS: &str = r#"<sdf version="1.9"><world name="w"><model name="gears">
        <link name="carrier"/><link name="wheel"/><link name="pinion"/>
        <joint name="arm" type="revolute"><parent>world</parent><child>carrier</child><axis><xyz>0 0 1</xyz></axis></joint>
        <joint name="first" type="revolute"><parent>carrier</parent><child>wheel</child><axis><xyz>0 0 1</xyz></axis></joint>
        <joint name="second" type="revolute"><parent>pinion</parent><child>carrier</child><axis><xyz>0 0 1</xyz></axis></joint>
        <joint name="teeth" type="gearbox"><parent>wheel</parent><child>pinion</child>
            <axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 0 1</xyz></axis2>
            <gearbox_ratio>2.5</gearbox_ratio><gearbox_reference_body>carrier</gearbox_reference_body>
        </joint></model></world></sdf>"#;

    #[test]
    fn gearboxes_couple_the_joints_of_their_reference_body() {
        let ratio = |text: &str| {
            let mechanism = testing::read(text).mechanism;
            assert_eq!(mechanism.joints().len(), 3);
            let [coupling] = mechanism.couplings() else { panic!() };
            assert_eq!(coupling.name, "gears::teeth");
            assert_eq!((coupling.follower.joint, coupling.terms[0].0.joint), (2, 1));
            coupling.terms[0].1
        };
        // Without a world, names have no prefix.
        let model = GEARS.replace("<world name=\"w\">", "").replace("</world>", "");
        let model = model
            .replace("<link name=\"carrier\"/>", "<link name=\"base\"/><link name=\"carrier\"/>");
        let read = testing::read(&model.replace("<parent>world", "<parent>base"));
        assert_eq!(read.mechanism.couplings()[0].name, "teeth");
        // The pinion turns by −2.5 times the wheel about the carrier, and the carrier by 2.5 times about the pinion.
        assert_eq!(ratio(GEARS), 2.5);
        assert_eq!(ratio(&GEARS.replace("<axis2><xyz>0 0 1", "<axis2><xyz>0 0 -1")), -2.5);
        assert_eq!(ratio(&GEARS.replace("<gearbox_ratio>2.5</gearbox_ratio>", "")), 1.0);
        let element =
            "<joint name=\"teeth\" type=\"gearbox\"><parent>wheel</parent><child>pinion</child>";
        let refuse = |from, to, blamed, message| testing::refuse(GEARS, from, to, blamed, message);
        refuse("<axis2><xyz>0 0 1", "<axis2><xyz>0 1 0", element, "without a revolute joint of");
        refuse("body>carrier", "body>wheel", element, "turn on revolute joints of the reference");
        refuse("ratio>2.5", "ratio>0", "0", "a number that is not 0");
        refuse("body>carrier", "body>cart", "cart", "frame \"cart\" is not known");
    }

    /// Before, a name was looked for among the joints of the whole file.
    #[test]
    fn a_position_controller_drives_the_joint_of_its_own_model() {
        let joint = |name: &str, parent: &str, child: &str| {
            format!(
                "<joint name=\"{name}\" type=\"revolute\"><parent>{parent}</parent><child>{child}</child><axis><xyz>0 0 1</xyz></axis></joint>"
            )
        };
        let controller = format!(
            "<plugin filename=\"f\" name=\"{POSITION_CONTROLLER}\"><joint_name>A</joint_name></plugin>"
        );
        let links =
            |names: [&str; 2]| names.map(|name| format!("<link name=\"{name}\"/>")).concat();
        let inner = format!(
            "<model name=\"s\">{}{}{controller}</model>",
            links(["l", "k"]),
            joint("A", "l", "k")
        );
        let fixed = "<joint name=\"f\" type=\"fixed\"><parent>world</parent><child>base</child></joint><joint name=\"w\" type=\"fixed\"><parent>arm</parent><child>s::l</child></joint>";
        let model = format!(
            "<model name=\"m\">{}{fixed}{}{inner}</model>",
            links(["base", "arm"]),
            joint("A", "base", "arm")
        );
        let actuated = |text: String| {
            let model = testing::read(&text);
            assert!(
                !model.ignored.iter().any(|what| what.contains("unknown")),
                "{:?}",
                model.ignored
            );
            let joints = model.mechanism.joints().iter().filter(|joint| joint.actuated);
            joints.map(|joint| joint.name.clone()).collect::<Vec<_>>()
        };
        assert_eq!(actuated(format!("<sdf version=\"1.9\">{model}</sdf>")), ["s::A"]);
        let world = format!("<sdf version=\"1.9\"><world name=\"w\">{model}</world></sdf>");
        assert_eq!(actuated(world), ["m::s::A"]);
    }

    #[test]
    fn in_a_world_a_free_model_floats() {
        let text =
            ARM.replace("<model", "<world name=\"w\"><gravity>0 0 1</gravity><model").replace(
                "</model>",
                "</model><model name=\"t\"><static>1</static><link name=\"l\"/></model></world>",
            );
        let model = testing::read(&text);
        assert_eq!(model.mechanism.links(), ["world", "arm::foot", "arm::leg", "t::l"]);
        let kinds: Vec<_> = model
            .mechanism
            .joints()
            .iter()
            .map(|joint| (joint.name.as_str(), joint.kind.name(), joint.links))
            .collect();
        let expected = [
            ("t::l is static", "fixed", [0, 3]),
            ("arm::knee", "revolute", [1, 2]),
            ("arm::foot floats", "floating", [0, 1]),
        ];
        assert_eq!(kinds, expected);
        let floats = "link \"arm::foot\" is not fixed to the world: it floats";
        assert_eq!(model.ignored, [floats, "1 × collision", "1 × gravity", "1 × plugin"]);
    }

    /// The joint of the arm with another type and other elements.
    #[track_caller]
    fn knee(kind: &str, elements: &str) -> Imported {
        let start = ARM.find("<axis>").unwrap();
        let end = ARM.find("</axis>").unwrap() + "</axis>".len();
        let text = format!("{}{elements}{}", &ARM[..start], &ARM[end..]);
        testing::read(&text.replace("\"revolute\"", &format!("{kind:?}")))
    }

    #[test]
    fn every_kind_of_joint_is_imported() {
        let (x, y) = ("<axis><xyz>1 0 0</xyz></axis>", "<axis2><xyz>0 1 0</xyz></axis2>");
        let helical = |lead| JointKind::Helical { lead };
        for (kind, elements, expected) in [
            ("revolute", x.to_owned(), JointKind::Revolute),
            ("continuous", x.to_owned(), JointKind::Revolute),
            ("prismatic", x.to_owned(), JointKind::Prismatic),
            ("ball", String::new(), JointKind::Spherical),
            ("fixed", String::new(), JointKind::Fixed),
            ("universal", format!("{x}{y}"), JointKind::Universal),
            ("revolute2", format!("{x}{y}"), JointKind::Universal),
            (
                "screw",
                format!("{x}<screw_thread_pitch>0.3</screw_thread_pitch>"),
                helical(0.3 / TAU),
            ),
            ("screw", format!("{x}<thread_pitch>4</thread_pitch>"), helical(-0.25)),
        ] {
            let joint = knee(kind, &elements).mechanism.joints()[0].clone();
            assert_eq!(joint.kind, expected, "{elements}");
            let z = joint.frames[0].rotation * Vector3::z();
            let axis = if elements.is_empty() { Vector3::z() } else { Vector3::x() };
            assert_eq!(z, axis, "{kind}");
        }
    }

    #[test]
    fn limits_may_have_one_end() {
        let limit = |kind: &str, lower: &str, upper: &str| {
            let limit = format!("<limit><lower>{lower}</lower><upper>{upper}</upper></limit>");
            let model = knee(
                kind,
                &format!("<axis>{limit}</axis><screw_thread_pitch>1</screw_thread_pitch>"),
            );
            let listed = model.ignored.into_iter().find(|what| what.contains("limit"));
            (model.mechanism.joints()[0].limits.clone(), listed.unwrap_or_default())
        };
        assert_eq!(limit("prismatic", "-2", "3"), (vec![[-2.0, 3.0]], String::new()));
        assert_eq!(limit("revolute", "-inf", "inf"), (vec![], String::new()));
        assert_eq!(limit("revolute", "-1e16", "1e16"), (vec![], String::new()));
        let upper = (vec![[f64::NEG_INFINITY, 1.0]], String::new());
        assert_eq!(limit("revolute", "-1e16", "1"), upper);
        let lower = (vec![[-1.0, f64::INFINITY]], String::new());
        assert_eq!(limit("revolute", "-1", "inf"), lower);
        let one = "<axis><limit><lower>0.2</lower></limit></axis>";
        assert_eq!(knee("prismatic", one).mechanism.joints()[0].limits, [[0.2, f64::INFINITY]]);
        let equal =
            "1 × limit whose lower is its upper, of a joint that is imported without limits";
        assert_eq!(limit("revolute", "0", "0"), (vec![], equal.to_owned()));
        assert_eq!(limit("screw", "0", "1"), (vec![], "1 × limit of a screw joint".to_owned()));
        let limits = "<axis><limit><lower>2</lower><upper>1</upper></limit>";
        let blamed = "<limit><lower>2</lower><upper>1</upper></limit>";
        testing::refuse(ARM, "<axis>", limits, blamed, "lower above upper");
    }

    #[test]
    fn before_1_7_joints_may_share_names_with_links_and_axes_may_be_in_the_model_frame() {
        let old = ARM.replace("\"1.9\"", "\"1.6\"").replace("\"knee\"", "\"leg\"");
        let old = old.replace(
            "<pose relative_to=\"hip\">0 0 0 0 0 0<",
            "<pose>0 0 0 0 0 1.57079632679489662<",
        );
        let axis = |text: &str| {
            let joint = testing::read(text).mechanism.joints()[0].clone();
            (joint.frames[0].rotation * Vector3::z()).map(|entry| (entry * 1e9).round() / 1e9)
        };
        assert_eq!(axis(&old), -Vector3::x());
        let in_model = "<use_parent_model_frame>true</use_parent_model_frame></axis>";
        assert_eq!(axis(&old.replace("</axis>", in_model)), Vector3::y());
        // Before 1.5, there was no other frame of axes.
        assert_eq!(axis(&old.replace("\"1.6\"", "\"1.4\"")), Vector3::y());
    }

    #[test]
    fn unsupported_and_invalid_elements_are_rejected() {
        let refuse = |from, to, blamed, message| testing::refuse(ARM, from, to, blamed, message);
        let plugin = "<plugin name=\"p\" filename=\"f\"/>";
        refuse("\"1.9\"", "\"1.0\"", "1.0", "a version from 1.2 to 1.12");
        refuse(" version=\"1.9\"", "", "<sdf>", "`sdf` needs `version`");
        refuse(
            "</model>",
            "</model><model name=\"b\"/>",
            "<model name=\"b\"/>",
            "a second <model>",
        );
        refuse(
            plugin,
            "<include><uri>u</uri></include>",
            "<include><uri>u</uri></include>",
            "gz sdf -p",
        );
        refuse(plugin, "<plugins/>", "<plugins/>", "<plugins> in model cannot be imported");
        refuse("\"revolute\"", "\"gears\"", "gears", "revolute, continuous");
        let gearbox = "<joint name=\"knee\" type=\"gearbox\">";
        refuse("\"revolute\"", "\"gearbox\"", gearbox, "needs `gearbox_reference_body`");
        refuse(
            "\"revolute\"",
            "\"universal\"",
            "<joint name=\"knee\" type=\"universal\">",
            "needs `axis2`",
        );
        refuse(
            "\"revolute\"",
            "\"screw\"",
            "<joint name=\"knee\" type=\"screw\">",
            "needs `screw_thread_pitch`",
        );
        refuse("</axis>", "<mimic joint=\"x\"/></axis>", "x", "frame \"x\" is not known");
        refuse("</axis>", "<mimic joint=\"hip\"/></axis>", "hip", "the name of a joint");
        refuse("</axis>", "<mimic/></axis>", "<mimic/>", "`mimic` needs `joint`");
        let itself = "<mimic joint=\"knee\"/>";
        let axis = format!("{itself}</axis>");
        testing::refuse(ARM, "</axis>", &axis, itself, "twice");
        let second = "<mimic joint=\"knee\" axis=\"axis2\"/></axis>";
        refuse("</axis>", second, "axis2", "an axis of a joint");
        let third = "<mimic joint=\"knee\" axis=\"axis3\"/></axis>";
        refuse("</axis>", third, "axis3", "axis or axis2");
        let text = "<mimic joint=\"knee\"><offset>much</offset></mimic></axis>";
        refuse("</axis>", text, "much", "a number");
        refuse(
            "</axis>",
            "</axis><gearbox_ratio>2</gearbox_ratio>",
            "<gearbox_ratio>2</gearbox_ratio>",
            "of a joint cannot",
        );
        refuse("<xyz>0 1 0", "<xyz>0 0 0", "0 0 0", "a direction that is not 0");
        refuse("<xyz>", "<xyz expressed_in=\"hp\">", "hp", "frame \"hp\" is not known");
        refuse("<parent>foot", "<parent>food", "food", "did you mean `foot`?");
        refuse(
            "<parent>foot</parent>",
            "",
            "<joint name=\"knee\" type=\"revolute\">",
            "needs `parent`",
        );
        refuse(
            "<parent>foot",
            "<parent>leg",
            "<joint name=\"knee\" type=\"revolute\">",
            "to itself",
        );
        refuse("\"knee\"", "\"leg\"", "<joint name=\"leg\" type=\"revolute\">", "used twice");
        refuse("0 0 1 0 0 0", "0 0 1 0 0", "0 0 1 0 0", "6 numbers: x y z roll pitch yaw");
        refuse("<pose>", "<pose frame=\"a\">", "a", "use relative_to instead");
        refuse("<pose>", "<pose rotation_format=\"q\">", "q", "euler_rpy or quat_xyzw");
        refuse(
            "<pose>",
            "<pose relative_to=\"leg\">",
            "<frame name=\"hip\" attached_to=\"foot\"><pose relative_to=\"leg\">0 0 1 0 0 0</pose></frame>",
            "in a circle",
        );
        let foreign = "<d:joint xmlns:d=\"drake\"/>";
        refuse(plugin, foreign, foreign, "a joint of a dialect");
        let circle = "<frame name=\"a\" attached_to=\"b\"><pose relative_to=\"foot\"/></frame><frame name=\"b\" attached_to=\"a\"><pose relative_to=\"foot\"/></frame>";
        let text = ARM.replace(plugin, circle);
        testing::refuse(
            &text,
            "<parent>foot",
            "<parent>a",
            &circle[..circle.find("<frame name=\"b\"").unwrap()],
            "the link of \"arm::a\" depends on itself",
        );
        refuse(
            " relative_to=\"hip\">0 0",
            " relative_to=\"hip\" degrees=\"no\">0 0",
            "no",
            "true or false",
        );
    }

    #[test]
    fn axes_of_a_universal_joint_must_be_perpendicular() {
        let text = ARM.replace("\"revolute\"", "\"universal\"");
        let axis2 = "</axis><axis2><xyz>0 1 1</xyz></axis2>";
        testing::refuse(
            &text,
            "</axis>",
            axis2,
            "<joint name=\"knee\" type=\"universal\">",
            "two revolute joints",
        );
    }
}
