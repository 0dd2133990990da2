//! Robots of ROS (URDF): links in a tree; loops come from constraints, or from a second file, see [`super::parse_closed`].
//!
//! The root link is the base.
//! Joints of a transmission, or with a command interface, are actuated; a joint that mimics another is coupled to it.

use std::collections::BTreeSet;

use jointplay_core::mechanism::{Coupling, JointKind};
use jointplay_core::spatial::Pose;
use nalgebra::Vector3;
use roxmltree::Node;
use strsim::osa_distance;

use super::draft::{Draft, bare};
use super::model::{Dialect, Imported};
use super::problem::Error;
use super::urdf_constraint::constraint;
use super::urdf_place::{end, pose_of};
use super::xml::{
    Advice, EXPAND_XACRO, MOST_QUOTED, Value, attribute, children, content, elements, is_foreign,
    place,
};
use jointplay_format::mechanism::frame::{pose, some_perpendicular};

/// Reads a robot.
///
/// # Arguments
/// * `solved` – joints that the loops of a second file determine
pub(super) fn read<'a>(
    mut draft: Draft<'a>,
    root: Node<'a, 'a>,
    solved: &BTreeSet<&str>,
) -> Result<Imported, Error> {
    let xml = draft.xml;
    // Some robots have no name, which nothing refers to.
    let name = xml.name(root)?.unwrap_or("URDF robot");
    for node in children(root) {
        let tag = node.tag_name();
        match (is_foreign(node), tag.name()) {
            (false, "link" | "joint" | "constraint" | "transmission" | "ros2_control") => {}
            (true, _) if tag.namespace().is_some_and(|space| space.contains("xacro")) => {
                return Err(xml.unsupported(node, "a macro of xacro", EXPAND_XACRO));
            }
            (true, "joint") => {
                let advice = Advice("only joints of URDF itself are supported");
                return Err(xml.unsupported(node, "a joint of a dialect", advice));
            }
            (_, "constraint" | "loop_joint" | "ball_constraint") => {
                let advice = Advice("describe the loop by a joint in a second file of loops");
                let what = format!("<{}>, which closes a loop,", tag.name());
                return Err(xml.unsupported(node, what, advice));
            }
            (_, other) => draft.ignore(other),
        }
    }
    let links: Vec<Node> = elements(root, "link").collect();
    let joints: Vec<Node> = elements(root, "joint").collect();
    let children_of_joints = joints.iter().filter_map(|joint| elements(*joint, "child").next());
    let carried: BTreeSet<&str> =
        children_of_joints.filter_map(|child| child.attribute("link")).map(str::trim).collect();
    let is_root =
        |link: &&Node| link.attribute("name").is_some_and(|n| !carried.contains(n.trim()));
    // Some exporters connect a robot to a world that they do not list among the links.
    let is_world = |name: Option<&str>| name.map(str::trim) == Some("world");
    let lists_world = links.iter().any(|link| is_world(link.attribute("name")));
    let mut parents = joints.iter().flat_map(|joint| elements(*joint, "parent"));
    let world = parents.find(|parent| !lists_world && is_world(parent.attribute("link")));
    let base = links.iter().find(is_root).copied();
    match (world, base) {
        (Some(world), _) => {
            draft.add_link("world", place(world))?;
        }
        (None, Some(base)) => add_link(&mut draft, base)?,
        (None, None) => {
            let advice = Advice("URDF is a tree with one link that is the child of no joint");
            return Err(xml.unsupported(root, "a robot without a root link", advice));
        }
    }
    // Links follow the base in the order of the file.
    for link in links.into_iter().filter(|&link| world.is_some() || Some(link) != base) {
        add_link(&mut draft, link)?;
    }
    let mut is_carried = vec![false; draft.links()];
    let mut mimics = Vec::new();
    for node in joints {
        mimics.extend(joint(&mut draft, node, &mut is_carried, solved)?);
    }
    // After all joints: one can mimic a later one.
    for (node, element) in mimics {
        mimic(&mut draft, node, element)?;
    }
    let mut constraints = elements(root, "constraint").peekable();
    if constraints.peek().is_some() {
        let base_from_links = poses_at_zero(&draft);
        for node in constraints {
            constraint(&mut draft, node, &base_from_links)?;
        }
    }
    for section in children(root) {
        let driven: Vec<Node> = match section.tag_name().name() {
            "transmission" => elements(section, "joint").collect(),
            "ros2_control" => elements(section, "joint")
                .filter(|joint| elements(*joint, "command_interface").next().is_some())
                .collect(),
            _ => continue,
        };
        for node in driven {
            // Older files contain the name of the joint in the element's text.
            let value = attribute(node, "name").unwrap_or_else(|| content(node));
            match draft.joint(value.text) {
                Some(number) => draft.descriptions[number].actuated = true,
                // Controllers of robots that share a file of transmissions name joints of all of them.
                None => draft.ignore(format!(
                    "{} of the unknown joint {:?}",
                    section.tag_name().name(),
                    value.text.chars().take(MOST_QUOTED).collect::<String>(),
                )),
            }
        }
    }
    for section in elements(root, "ros2_control") {
        elements(section, "joint").try_for_each(|node| initial_value(&mut draft, node))?;
    }
    draft.finish(name, Dialect::Urdf)
}

/// Poses of the links in the base, with all joints at zero (m).
fn poses_at_zero(draft: &Draft) -> Vec<Pose> {
    let mut carried: Vec<Vec<(usize, Pose)>> = vec![Vec::new(); draft.links()];
    for joint in &draft.descriptions {
        let [parent, child] = joint.links;
        carried[parent].push((child, joint.frames[0] * joint.frames[1].inverse()));
    }
    let mut poses = vec![Pose::identity(); draft.links()];
    // Each link is the child of one joint at most, so that no link is reached twice.
    let mut open = vec![0];
    while let Some(parent) = open.pop() {
        for &(child, parent_from_child) in &carried[parent] {
            poses[child] = poses[parent] * parent_from_child;
            open.push(child);
        }
    }
    poses
}

/// The initial position of a joint of `ros2_control` is where the search for a closed configuration starts.
fn initial_value<'a>(draft: &mut Draft<'a>, node: Node<'a, 'a>) -> Result<(), Error> {
    let is_named = |node: &Node, name| node.attribute("name").map(str::trim) == Some(name);
    let states = elements(node, "state_interface").filter(|state| is_named(state, "position"));
    let mut values = states.flat_map(|state| elements(state, "param"));
    let Some(value) = values.find(|param| is_named(param, "initial_value")) else { return Ok(()) };
    let number = attribute(node, "name").and_then(|name| draft.joint(name.text));
    let Some(joint) = number.map(|number| &mut draft.descriptions[number]) else { return Ok(()) };
    if joint.kind.freedoms() == 1 {
        joint.guess = vec![draft.xml.number(&content(value))?];
    }
    Ok(())
}

fn add_link<'a>(draft: &mut Draft<'a>, link: Node<'a, 'a>) -> Result<(), Error> {
    draft.add_link(draft.xml.needed_name(link)?, place(link))?;
    children(link).for_each(|part| draft.ignore(part.tag_name().name()));
    Ok(())
}

/// A joint and its element `mimic`.
type Mimic<'a> = (Node<'a, 'a>, Node<'a, 'a>);

/// Adds a joint; returns it with its `mimic`, if it has one.
fn joint<'a>(
    draft: &mut Draft<'a>,
    node: Node<'a, 'a>,
    is_carried: &mut [bool],
    solved: &BTreeSet<&str>,
) -> Result<Option<Mimic<'a>>, Error> {
    let xml = draft.xml;
    let name = xml.needed_name(node)?;
    let value = attribute(node, "type").ok_or_else(|| xml.missing(node, "type"))?;
    let kind = match value.text {
        "revolute" | "continuous" => JointKind::Revolute,
        "prismatic" => JointKind::Prismatic,
        "fixed" => JointKind::Fixed,
        "floating" => JointKind::Floating,
        "planar" => JointKind::Planar,
        "spherical" => JointKind::Spherical,
        _ => {
            let expected = "revolute, continuous, prismatic, fixed, floating, planar or spherical";
            return Err(xml.unusable(&value, expected));
        }
    };
    let (mut ends, mut parts, mut mimic) = ([None, None], [None, None, None], None);
    for part in children(node) {
        let slot = match part.tag_name().name() {
            "parent" => &mut ends[0],
            "child" => &mut ends[1],
            "origin" => &mut parts[0],
            "axis" => &mut parts[1],
            "limit" => &mut parts[2],
            "mimic" if solved.contains(name) => {
                draft.ignore("mimic of a joint that a loop determines");
                continue;
            }
            "mimic" => &mut mimic,
            other => {
                if let Some(known) = similar_to_known(other) {
                    let advice = Advice("correct the name, or remove the element");
                    let what = format!("<{other}> of a joint, which may be <{known}> misspelled,");
                    return Err(xml.unsupported(part, what, advice));
                }
                // Elements of other tools carry masses, friction, controllers and the like.
                draft.ignore(format!("{other} of a joint"));
                continue;
            }
        };
        if slot.replace(part).is_some() {
            let advice = Advice("a joint has at most one");
            let what = format!("a second <{}> of a joint", part.tag_name().name());
            return Err(xml.unsupported(part, what, advice));
        }
    }
    let [parent, child] = ends;
    let links = [end(draft, node, parent, "parent")?, end(draft, node, child, "child")?];
    if std::mem::replace(&mut is_carried[links[1]], true) {
        let advice = Advice("URDF is a tree; close the loop by a joint in a second file of loops");
        let what = format!(
            "link {:?}, which is the child of another joint already,",
            draft.link_name(links[1])
        );
        return Err(xml.unsupported(child.unwrap_or(node), what, advice));
    }
    let [origin, axis, limit] = parts;
    let parent_from_child = origin.map_or(Ok(Pose::identity()), |origin| pose_of(draft, origin))?;
    let has_axis = matches!(kind, JointKind::Revolute | JointKind::Prismatic | JointKind::Planar);
    let xyz = axis.filter(|_| has_axis).and_then(|axis| attribute(axis, "xyz"));
    if let Some(axis) = axis.filter(|_| has_axis) {
        let has_text = axis.text().is_some_and(|text| !text.trim().is_empty());
        if xyz.is_none() && (has_text || axis.attributes().len() > 0) {
            let advice = Advice("write it as <axis xyz=\"0 0 1\"/>");
            return Err(xml.unsupported(axis, "an <axis> without xyz", advice));
        }
        draft.ignore_attributes(axis, &["xyz"]);
    }
    let z = match xyz {
        Some(xyz) => xml.direction(&xyz)?,
        None if has_axis => Vector3::x_axis(),
        None => Vector3::z_axis(),
    };
    let child_from_joint = pose(Vector3::zeros(), some_perpendicular(z), z);
    let frames = [parent_from_child * child_from_joint, child_from_joint];
    let mut joint = bare(name.to_owned(), kind, links, frames);
    if let Some(limit) = limit {
        draft.ignore_attributes(limit, &["lower", "upper"]);
        let bounds = [attribute(limit, "lower"), attribute(limit, "upper")];
        let has_bounds = bounds.iter().any(Option::is_some);
        let [least, most] =
            bounds.map(|bound| bound.map_or(Ok(0.0), |bound: Value| xml.bound(&bound)));
        let (least, most) = (least?, most?);
        match value.text {
            "revolute" | "prismatic" if least.is_infinite() && most.is_infinite() => {}
            "revolute" | "prismatic" if least < most => joint.limits = vec![[least, most]],
            "revolute" | "prismatic" if least > most => {
                let advice = Advice("the lower one is 0 where it is not written");
                return Err(xml.unsupported(limit, "a <limit> with lower above upper", advice));
            }
            "revolute" | "prismatic" if has_bounds => {
                draft.ignore(
                    "limit whose lower is its upper, of a joint that is imported without limits",
                );
            }
            // By the format, both ends are 0 by default, which would lock the joint. Files that omit them mean a joint without limits, and programs disagree.
            "revolute" | "prismatic" => {
                draft.ignore("limit without lower and upper, which are 0 by default, of a joint that is imported without limits");
            }
            other if has_bounds => draft.ignore(format!("limit of a {other} joint")),
            _ => {}
        }
    }
    draft.add_joint(joint, place(node))?;
    Ok(mimic.map(|mimic| (node, mimic)))
}

/// A joint that mimics another: q = multiplier · q_other + offset.
fn mimic<'a>(draft: &mut Draft<'a>, joint: Node<'a, 'a>, mimic: Node<'a, 'a>) -> Result<(), Error> {
    let xml = draft.xml;
    let name = attribute(joint, "name").ok_or_else(|| xml.missing(joint, "name"))?;
    let leader = attribute(mimic, "joint").ok_or_else(|| xml.missing(mimic, "joint"))?;
    let (follower, leader) = (draft.coordinate(&name)?, draft.coordinate(&leader)?);
    let number = |name, default| {
        attribute(mimic, name).map_or(Ok(default), |value: Value| xml.number(&value))
    };
    let (ratio, offset) = (number("multiplier", 1.0)?, number("offset", 0.0)?);
    draft.ignore_attributes(mimic, &["joint", "multiplier", "offset"]);
    let name = draft.fresh(format!("mimic of {}", name.text));
    let terms = vec![(leader, ratio)];
    draft.add_coupling(Coupling { name, follower, terms, offset }, place(mimic));
    Ok(())
}

/// Elements of a joint that determine the mechanism.
const KNOWN: [&str; 6] = ["parent", "child", "origin", "axis", "limit", "mimic"];
/// Largest number of letters by which a misspelled name differs.
const MISSPELLED: usize = 2;

/// The known element of a joint that an unknown one may be, misspelled.
fn similar_to_known(name: &str) -> Option<&'static str> {
    let lower = name.to_lowercase();
    KNOWN.into_iter().find(|known| osa_distance(&lower, known) <= MISSPELLED)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::testing;
    use jointplay_core::mechanism::JointCoordinate;

    const ARM: &str = r#"<robot name="arm">
  <link name="hand"><visual/></link>
  <link name="base"/>
  <joint name="wrist" type="revolute">
    <origin xyz="0 0 1" rpy="0 0 0.5"/>
    <parent link="base"/>
    <child link="hand"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="5" velocity="1"/>
    <dynamics damping="1"/>
  </joint>
  <transmission name="t"><joint name="wrist"/></transmission>
</robot>"#;

    #[test]
    fn the_root_link_is_the_base() {
        let model = testing::read(ARM);
        assert_eq!(model.mechanism.links(), ["base", "hand"]);
        let [wrist] = model.mechanism.joints() else { panic!() };
        assert!(wrist.actuated);
        assert_eq!(wrist.limits, [[-1.0, 1.0]]);
        assert_eq!(wrist.frames[1].rotation * Vector3::z(), Vector3::y());
        assert_eq!(wrist.frames[0].translation.vector, Vector3::z());
        let ignored = [
            "1 × dynamics of a joint",
            "1 × effort of limit",
            "1 × velocity of limit",
            "1 × visual",
        ];
        assert_eq!(model.ignored, ignored);
    }

    #[test]
    fn a_quaternion_turns_as_the_angles_do() {
        let angles = testing::read(ARM).mechanism.joints()[0].frames;
        // Sine and cosine of half of 0.5 rad.
        let quaternion = "quat_xyzw=\"0 0 0.247403959254523 0.9689124217106447\"";
        let frames =
            testing::read(&ARM.replace("rpy=\"0 0 0.5\"", quaternion)).mechanism.joints()[0].frames;
        let difference = frames[0].to_homogeneous() - angles[0].to_homogeneous();
        assert!(difference.norm() < 1e-14, "{difference}");
    }

    #[test]
    fn attributes_that_would_move_a_joint_are_not_passed_over() {
        let refuse = |from, to, blamed, message| testing::refuse(ARM, from, to, blamed, message);
        let origin = "<origin xzy=\"0 0 1\" rpy=\"0 0 0.5\"/>";
        refuse("xyz=\"0 0 1\"", "xzy=\"0 0 1\"", origin, "`xzy` of <origin>");
        let both = "<origin xyz=\"0 0 1\" rpy=\"0 0 0.5\" quat_xyzw=\"0 0 0 1\"/>";
        refuse("0.5\"/>", "0.5\" quat_xyzw=\"0 0 0 1\"/>", both, "both rpy and quat_xyzw");
        refuse("rpy=\"0 0 0.5\"", "quat_xyzw=\"0 0 0 0\"", "0 0 0 0", "a quaternion of length 1");
        // The square of such a number is infinite.
        refuse("rpy=\"0 0 0.5\"", "quat_xyzw=\"0 0 0 1e200\"", "0 0 0 1e200", "of length 1");
        let axis = "<axis xyz=\"0 1 0\"/>";
        refuse(axis, "<axis xzy=\"0 1 0\"/>", "<axis xzy=\"0 1 0\"/>", "an <axis> without xyz");
        refuse(axis, "<axis>0 1 0</axis>", "<axis>0 1 0</axis>", "an <axis> without xyz");
        let limit = "<limit lower=\"2\" upper=\"1\" effort=\"5\" velocity=\"1\"/>";
        refuse("lower=\"-1\"", "lower=\"2\"", limit, "lower above upper");
        // Files of other tools have angles in the axis, which have no effect.
        let model = testing::read(&ARM.replace("<axis ", "<axis rpy=\"0 0 0\" "));
        assert!(model.ignored.contains(&"1 × rpy of axis".to_owned()), "{:?}", model.ignored);
    }

    #[test]
    fn every_kind_of_joint_is_imported() {
        for (kind, expected) in [
            ("revolute", JointKind::Revolute),
            ("continuous", JointKind::Revolute),
            ("prismatic", JointKind::Prismatic),
            ("fixed", JointKind::Fixed),
            ("floating", JointKind::Floating),
            ("planar", JointKind::Planar),
            ("spherical", JointKind::Spherical),
        ] {
            let model = testing::read(&ARM.replace("\"revolute\"", &format!("{kind:?}")));
            let wrist = &model.mechanism.joints()[0];
            assert_eq!(wrist.kind, expected);
            let has_limits = matches!(kind, "revolute" | "prismatic");
            assert_eq!(wrist.limits.len(), usize::from(has_limits), "{kind}");
            let listed = format!("1 × limit of a {kind} joint");
            assert_eq!(model.ignored.contains(&listed), !has_limits, "{:?}", model.ignored);
        }
    }

    #[test]
    fn limits_without_ends_are_listed() {
        let bare = |kind: &str, ends: &str| {
            let text = ARM.replace("lower=\"-1\" upper=\"1\" ", ends);
            assert_ne!(text, ARM);
            let model = testing::read(&text.replace("\"revolute\"", &format!("{kind:?}")));
            let listed = model.ignored.into_iter().find(|what| what.contains("limit without"));
            (model.mechanism.joints()[0].limits.clone(), listed.unwrap_or_default())
        };
        let listed = "1 × limit without lower and upper, which are 0 by default, of a joint that is imported without limits";
        for kind in ["revolute", "prismatic"] {
            assert_eq!(bare(kind, ""), (vec![], listed.to_owned()), "{kind}");
        }
        // Continuous joints have no limits, and one end has the other one's default.
        assert_eq!(bare("continuous", ""), (vec![], String::new()));
        assert_eq!(bare("revolute", "upper=\"1\" "), (vec![[0.0, 1.0]], String::new()));
        assert_eq!(bare("revolute", "lower=\"-1\" "), (vec![[-1.0, 0.0]], String::new()));
    }

    #[test]
    fn limits_may_have_one_end() {
        let limits = |lower: &str, upper: &str| {
            let limit = format!("lower=\"{lower}\" upper=\"{upper}\"");
            let text = ARM.replace("lower=\"-1\" upper=\"1\"", &limit);
            assert_ne!(text, ARM);
            testing::read(&text).mechanism.joints()[0].limits.clone()
        };
        assert_eq!(limits("-inf", "2"), [[f64::NEG_INFINITY, 2.0]]);
        assert_eq!(limits("0.5", "1e16"), [[0.5, f64::INFINITY]]);
        assert!(limits("-1e17", "INF").is_empty());
    }

    #[test]
    fn joints_start_within_their_limits() {
        let text = ARM.replace("lower=\"-1\" upper=\"1\"", "lower=\"0.3\" upper=\"1\"");
        let read = testing::read(&text);
        assert_eq!(read.mechanism.joints()[0].guess, [0.3]);
        let listed = "joint \"wrist\" starts at its limit: zero is beyond".to_owned();
        assert!(read.ignored.contains(&listed), "{:?}", read.ignored);
        assert!(testing::read(ARM).mechanism.joints()[0].guess.is_empty());
    }

    #[test]
    fn a_world_that_is_not_a_link_of_the_file_is_the_base() {
        let hung = "<joint name=\"hung\" type=\"fixed\"><parent link=\"world\"/><child link=\"base\"/></joint>";
        let text = ARM.replace("<transmission", &format!("{hung}<transmission"));
        assert_eq!(testing::read(&text).mechanism.links(), ["world", "hand", "base"]);
        let listed = text.replace("<transmission", "<link name=\"world\"/><transmission");
        assert_eq!(testing::read(&listed).mechanism.links(), ["world", "hand", "base"]);
    }

    #[test]
    fn a_default_namespace_is_accepted() {
        let all = ARM.replace("<robot", "<robot xmlns=\"http://www.ros.org\"");
        assert_eq!(testing::read(&all).mechanism, testing::read(ARM).mechanism);
    }

    #[test]
    fn joints_with_a_command_are_actuated() {
        let control = "<ros2_control><joint name=\"wrist\"><command_interface name=\"position\"/></joint></ros2_control>";
        let transmission = "<transmission name=\"t\"><joint name=\"wrist\"/></transmission>";
        let is_actuated = |text: &str| testing::read(text).mechanism.joints()[0].actuated;
        assert!(is_actuated(&ARM.replace(transmission, control)));
        assert!(!is_actuated(&ARM.replace(transmission, &control.replace("command", "state"))));
        assert!(is_actuated(&ARM.replace("<joint name=\"wrist\"/>", "<joint>wrist</joint>")));
    }

    #[test]
    fn initial_positions_are_guesses() {
        let control = "<ros2_control><joint name=\"wrist\"><state_interface name=\"position\"><param name=\"initial_value\">0.25</param></state_interface></joint></ros2_control>";
        let transmission = "<transmission name=\"t\"><joint name=\"wrist\"/></transmission>";
        let with = ARM.replace(transmission, control);
        assert_eq!(testing::read(&with).mechanism.joints()[0].guess, [0.25]);
        assert!(
            testing::read(&with.replace("position", "velocity")).mechanism.joints()[0]
                .guess
                .is_empty()
        );
        testing::refuse(&with, "0.25", "a quarter", "a quarter", "a number");
    }

    #[test]
    fn elements_of_other_tools_are_listed_as_ignored() {
        let exported = ARM
            .replace("<dynamics", "<joint_properties friction=\"0.0\"/><dynamics")
            .replace("<transmission", "<gazebo reference=\"hand\"/><sensor/><transmission")
            .replace("<joint name=\"wrist\"/>", "<joint name=\"west\"/>");
        let model = testing::read(&exported);
        assert_eq!(model.mechanism.joints().len(), testing::read(ARM).mechanism.joints().len());
        assert!(!model.mechanism.joints()[0].actuated);
        for what in [
            "1 × joint_properties of a joint",
            "1 × gazebo",
            "1 × sensor",
            "1 × transmission of the unknown joint \"west\"",
        ] {
            assert!(model.ignored.iter().any(|found| found == what), "{:?}", model.ignored);
        }
    }

    #[test]
    fn a_joint_that_mimics_another_is_coupled_to_it() {
        let finger = r#"<link name="finger"/><link name="palm"/>
  <joint name="grip" type="prismatic"><parent link="hand"/><child link="finger"/>
    <mimic joint="fold" multiplier="-0.02" offset="0.01"/></joint>
  <joint name="fold" type="revolute"><parent link="hand"/><child link="palm"/>
    <mimic joint="wrist"/></joint>
  <transmission"#;
        let model = testing::read(&ARM.replace("<transmission", finger));
        let [grip, fold] = model.mechanism.couplings() else { panic!() };
        let of = |joint| JointCoordinate { joint, freedom: 0 };
        let expected = Coupling {
            name: "mimic of grip".to_owned(),
            follower: of(1),
            terms: vec![(of(2), -0.02)],
            offset: 0.01,
        };
        assert_eq!(grip, &expected);
        assert_eq!(
            (fold.follower, &fold.terms[..], fold.offset),
            (of(2), &[(of(0), 1.0)][..], 0.0)
        );
        assert_eq!(model.mechanism.kutzbach_mobility(), 1);
    }

    /// A chain of followers, the last one listed first, and one that states where it starts.
    #[test]
    fn joints_that_mimic_start_where_their_couplings_hold() {
        let chain = r#"<robot name="gripper">
  <link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
  <joint name="tip" type="continuous"><parent link="b"/><child link="c"/><mimic joint="knuckle" multiplier="-2"/></joint>
  <joint name="knuckle" type="revolute"><parent link="a"/><child link="b"/><limit lower="0.05" upper="1"/>
    <mimic joint="lift" multiplier="3" offset="0.1"/></joint>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="a"/><limit lower="0" upper="0.3"/></joint>
  <joint name="own" type="continuous"><parent link="c"/><child link="d"/><mimic joint="tip" offset="0.5"/></joint>
  <ros2_control><joint name="lift"><state_interface name="position"><param name="initial_value">0.2</param></state_interface></joint></ros2_control>
</robot>"#;
        let guesses = |text: &str| {
            let joints = testing::read(text).mechanism.joints().to_vec();
            joints.into_iter().map(|joint| joint.guess).collect::<Vec<_>>()
        };
        let near = |found: &[f64], expected: f64| (found[0] - expected).abs() < 1e-12;
        let found = guesses(chain);
        assert!(
            near(&found[0], -1.4) && near(&found[1], 0.7) && near(&found[3], -0.9),
            "{found:?}"
        );
        let stated = chain.replace("<joint name=\"lift\"><state", "<joint name=\"own\"><state");
        let found = guesses(&stated);
        assert!(near(&found[0], -0.2) && near(&found[1], 0.1) && near(&found[3], 0.2), "{found:?}");
        // A ring starts somewhere.
        let ring = chain.replace("joint=\"lift\"", "joint=\"own\"");
        assert_eq!(guesses(&ring).len(), 4);
    }

    #[test]
    fn unsupported_and_invalid_elements_are_rejected() {
        let refuse = |from: &str, to: &str, blamed: &str, message: &str| {
            testing::refuse(ARM, from, to, blamed, message)
        };
        refuse("\"revolute\"", "\"hinge\"", "hinge", "revolute, continuous");
        refuse("<dynamics damping=\"1\"/>", "<mimic joint=\"x\"/>", "x", "known: wrist");
        let mimic = "<mimic joint=\"wrist\" multiplier=\"2\"/>";
        refuse("<dynamics damping=\"1\"/>", mimic, mimic, "twice");
        let mimic = "<mimic joint=\"wrist\" multiplier=\"two\"/>";
        refuse("<dynamics damping=\"1\"/>", mimic, "two", "number");
        refuse("<dynamics damping=\"1\"/>", "<axis/>", "<axis/>", "a second <axis>");
        // A misspelled element would be another mechanism.
        for (found, known) in
            [("axes", "axis"), ("Axis", "axis"), ("orgin", "origin"), ("limits", "limit")]
        {
            let element = format!("<{found}/>");
            let message = format!("which may be <{known}> misspelled");
            refuse("<dynamics damping=\"1\"/>", &element, &element, &message);
        }
        for harmless in [
            "dynamics",
            "calibration",
            "safety_controller",
            "joint_properties",
            "hardwareInterface",
            "mechanicalReduction",
            "physics",
            "friction",
            "sensor",
            "gazebo",
            "provideFeedback",
            "implicitSpringDamper",
            "actuator",
            "motor",
            "drive",
            "safety",
        ] {
            assert_eq!(similar_to_known(harmless), None, "{harmless}");
        }
        refuse("\"0 1 0\"", "\"0 0 0\"", "0 0 0", "a direction that is not 0");
        refuse("\"0 1 0\"", "\"0 1\"", "0 1", "3 numbers");
        refuse("\"0 0 0.5\"", "\"0 0 nan\"", "0 0 nan", "3 numbers");
        refuse(
            "<parent link=\"base\"/>",
            "<parent link=\"bass\"/>",
            "bass",
            "did you mean `base`?",
        );
        refuse("<parent link=\"base\"/>", "<parent/>", "<parent/>", "`parent` needs `link`");
        refuse(
            "<parent link=\"base\"/>",
            "",
            "<joint name=\"wrist\" type=\"revolute\">",
            "needs `parent`",
        );
        refuse(
            "<parent link=\"base\"/>",
            "<parent link=\"hand\"/>",
            "<joint name=\"wrist\" type=\"revolute\">",
            "to itself",
        );
        refuse(
            "<link name=\"base\"/>",
            "<link name=\"base\"/><link name=\"x\"/>",
            "<link name=\"x\"/>",
            "not connected to the base",
        );
        refuse(
            "<link name=\"base\"/>",
            "<link name=\"hand\"/>",
            "<robot name=\"arm\">",
            "without a root link",
        );
        let closure = "<loop_joint name=\"c\"/>";
        let closed = format!("{closure}<transmission");
        refuse("<transmission", &closed, closure, "second file of loops");
        let second = "<joint name=\"b\" type=\"fixed\"><parent link=\"base\"/><child link=\"hand\"/></joint><transmission";
        refuse("<transmission", second, "<child link=\"hand\"/>", "a second file of loops");
        let space =
            "<robot name=\"arm\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:arm/>";
        refuse("<robot name=\"arm\">", space, "<xacro:arm/>", "xacro FILE > robot.urdf");
        let formula = "<link name=\"base\"/><link name=\"tip\"/><joint name=\"x\" type=\"fixed\"><origin xyz=\"${l/2} 0 0\"/><parent link=\"base\"/><child link=\"tip\"/></joint>";
        refuse(
            "<link name=\"base\"/>",
            formula,
            "${l/2} 0 0",
            "an expression of xacro in `xyz` cannot be imported: expand the file first",
        );
        let space = "<robot name=\"arm\" xmlns:drake=\"d\"><drake:joint/>";
        refuse("<robot name=\"arm\">", space, "<drake:joint/>", "a joint of a dialect");
    }
}
