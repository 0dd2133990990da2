//! Mechanisms as models of Gazebo.

use jointplay_core::mechanism::joint::Factor;
use jointplay_core::mechanism::{FrameId, JointKind, Kinematics, Mechanism};
use jointplay_core::spatial::Pose;
use nalgebra::{DVector, Translation3, Vector3};

use super::Written;
use super::error::Error;
use super::mimics::{Mimic, Mimics};
use super::sdf_names::{WORLD, with_permitted_names};
use super::skeleton::{DEFAULT_STIFFNESS, Skeleton};
use super::xml::{Xml, number, roll_pitch_yaw, vector};

/// The version of the format.
const VERSION: &str = "1.9";
/// The first version of the format whose axes mimic others.
const VERSION_WITH_MIMICS: &str = "1.11";
/// A mechanism at a closed configuration as a model of Gazebo (SDF), with its loops.
///
/// Links have their frames; each joint is one of the same kind, or a sequence of slides and hinges with links between them.
/// Virtual joints are slides and hinges with a spring; actuated joints have a position controller.
/// The base is fixed to the world; attached frames are frames; an axis that is coupled to another mimics it, such that an actuated one leads; couplings that others imply are omitted.
///
/// # Arguments
/// * `coordinates` – (f + M) of a closed configuration: there the joints of the model are at zero (m, rad)
///
/// # Errors
/// [`Error::Core`] for coordinates that are not those of the mechanism; [`Error::Coupling`] for couplings of one coordinate, of more than two, and for those that together fix their coordinates.
///
/// # Source
/// \[SDFormat\]
pub fn sdf(mechanism: &Mechanism, coordinates: &DVector<f64>) -> Result<Written, Error> {
    let (mechanism, renamed) = &with_permitted_names(mechanism);
    let skeleton = Skeleton::new(mechanism, coordinates)?;
    let mimics = mimics(&skeleton)?;
    let kinematics = Kinematics::new(mechanism);
    let poses = kinematics.link_poses(coordinates)?;
    let mut writer = Writer {
        skeleton: &skeleton,
        xml: Xml::new(),
        poses: poses.clone(),
        driven: Vec::new(),
        renamed: Vec::new(),
        fixed_to_world: None,
        lost: renamed.iter().chain(&skeleton.lost).chain(&mimics.lost).cloned().collect(),
        mimics,
    };
    let version = if writer.mimics.all.is_empty() { VERSION } else { VERSION_WITH_MIMICS };
    writer.xml.open("sdf", &[("version", version.into())]);
    writer.xml.open("model", &[("name", mechanism.name().into())]);
    let base = &mechanism.links()[0];
    for (link, name) in mechanism.links().iter().enumerate() {
        if name != WORLD || link > 0 {
            writer.link(name, &poses[link]);
        }
    }
    if base != WORLD {
        writer.fix_to_world(base);
    } else if mechanism.joints().iter().any(|joint| joint.links[1] == 0)
        || mechanism.frames().iter().any(|frame| frame.link == 0)
    {
        let name = skeleton.fresh(format!("{WORLD}, part 1"));
        writer.link(&name, &poses[0]);
        writer.fix_to_world(&name);
        let added = format!(
            "link {name:?} is added: in SDF, the world is no child of a joint and has no frames"
        );
        writer.lost.push(added);
        writer.fixed_to_world = Some(name);
    }
    for joint in 0..mechanism.joints().len() {
        writer.joint(joint, &kinematics);
    }
    for (k, frame) in mechanism.frames().iter().enumerate() {
        let link = writer.child_name(frame.link);
        writer.xml.open("frame", &[("name", frame.name.clone()), ("attached_to", link)]);
        writer.pose(&mechanism.link_from_frame(FrameId::Attached(k)), None);
        writer.xml.close();
    }
    writer.controllers();
    writer.xml.close();
    writer.xml.close();
    let (text, mut lost) = (writer.xml.text, writer.lost);
    if coordinates.iter().any(|&value| value != 0.0) {
        lost.push("joints of the model are at zero in the reference configuration; limits are shifted with them".to_owned());
    }
    lost.push("masses are not those of a real robot: each link has the same".to_owned());
    Ok(Written { text, loops: None, lost })
}

struct Writer<'s, 'a> {
    skeleton: &'s Skeleton<'a>,
    xml: Xml,
    /// Pose of each link in the base frame (m).
    poses: Vec<Pose>,
    /// Names of actuated joints.
    driven: Vec<String>,
    /// Joints that got another name, because a link or frame has theirs.
    renamed: Vec<(String, String)>,
    /// A link in place of the world where that is the child of joints, or has frames.
    fixed_to_world: Option<String>,
    mimics: Mimics,
    lost: Vec<String>,
}

/// The couplings of a mechanism; joints of the model are at zero in the configuration.
fn mimics(skeleton: &Skeleton<'_>) -> Result<Mimics, Error> {
    let mut mimics = Mimics::new(skeleton, |_| true);
    if let Some((coupling, reason)) = mimics.impossible.first() {
        return Err(Error::Coupling { coupling: coupling.name.clone(), reason, format: "SDF" });
    }
    let at = &skeleton.coordinates;
    for mimic in &mut mimics.all {
        mimic.offset += mimic.ratio * at[mimic.leader] - at[mimic.follower];
    }
    let implied = mimics.implied.iter();
    mimics.lost.extend(implied.map(|one| format!("coupling {:?}: the others imply it", one.name)));
    Ok(mimics)
}

/// An axis of a joint, in the frame of the joint.
struct Axis {
    direction: Vector3<f64>,
    coordinate: usize,
}

impl Writer<'_, '_> {
    fn pose(&mut self, pose: &Pose, relative_to: Option<&str>) {
        let attributes: Vec<_> =
            relative_to.map(|name| ("relative_to", name.to_owned())).into_iter().collect();
        let text =
            format!("{} {}", vector(&pose.translation.vector), roll_pitch_yaw(&pose.rotation));
        self.xml.with_text("pose", &attributes, &text);
    }

    /// Name of a link as the child of a joint, or as that of a frame.
    fn child_name(&self, link: usize) -> String {
        let in_place = self.fixed_to_world.as_ref().filter(|_| link == 0);
        in_place.unwrap_or(&self.skeleton.mechanism.links()[link]).clone()
    }

    /// A fixed joint between the world and a link.
    fn fix_to_world(&mut self, link: &str) {
        let name = self.skeleton.fresh(format!("{link} fixed to the world"));
        self.xml.open("joint", &[("name", name), ("type", "fixed".into())]);
        self.xml.with_text("parent", &[], WORLD);
        self.xml.with_text("child", &[], link);
        self.xml.close();
    }

    fn link(&mut self, name: &str, pose: &Pose) {
        self.xml.open("link", &[("name", name.into())]);
        self.pose(pose, None);
        let length = self.skeleton.length;
        let mass = DEFAULT_STIFFNESS * 1e-4;
        self.xml.open("inertial", &[]);
        self.xml.with_text("mass", &[], &number(mass));
        self.xml.open("inertia", &[]);
        for (key, value) in
            [("ixx", 1.0), ("iyy", 1.0), ("izz", 1.0), ("ixy", 0.0), ("ixz", 0.0), ("iyz", 0.0)]
        {
            self.xml.with_text(key, &[], &number(value * mass * length * length));
        }
        self.xml.close();
        self.xml.close();
        self.xml.close();
    }

    /// A joint: one element where the format has its kind, or one for each of its motions.
    fn joint(&mut self, j: usize, kinematics: &Kinematics<'_>) {
        let mechanism = self.skeleton.mechanism;
        let joint = &mechanism.joints()[j];
        let first = mechanism.links()[joint.links[0]].clone();
        let second = self.child_name(joint.links[1]);
        let chain = kinematics.elementary_chain(j);
        for motion in &chain.motions {
            let follows = self.mimics.of(motion.coordinate).is_some();
            if follows || !self.skeleton.is_actuated(j, motion.coordinate) {
                continue;
            }
            let name = self.skeleton.motion_name(motion.coordinate);
            if matches!(motion.factor, Factor::Ball) {
                self.lost.push(format!("actuator of {name:?}: it is a ball"));
            } else {
                self.driven.push(name);
            }
        }
        if joint.kind == JointKind::Spherical && !joint.limits.is_empty() {
            self.lost.push(format!("limits of {:?}: balls of SDF have none", joint.name));
        }
        let at = &self.skeleton.coordinates.clone();
        if self.is_universal(j) {
            let first_turn = &chain.motions[0];
            let behind = first_turn.before * first_turn.transform(at);
            let child_from_joint = chain.transform(at).inverse() * behind;
            let axes = [Vector3::z(), Vector3::x()];
            let axes = axes
                .into_iter()
                .zip(&chain.motions)
                .map(|(direction, motion)| Axis { direction, coordinate: motion.coordinate });
            let axes: Vec<Axis> = axes.collect();
            let name = joint.name.clone();
            self.element((j, &name, "universal"), [&first, &second], &child_from_joint, &axes);
            return;
        }
        if chain.motions.is_empty() {
            let name = joint.name.clone();
            let child_from_joint = joint.frames[1];
            self.element((j, &name, "fixed"), [&first, &second], &child_from_joint, &[]);
            return;
        }
        let mut parent = first;
        let mut base_from = self.poses[joint.links[0]];
        let last = chain.motions.len() - 1;
        let names: Vec<String> =
            chain.motions.iter().map(|one| self.skeleton.motion_name(one.coordinate)).collect();
        for (k, motion) in chain.motions.iter().enumerate() {
            base_from *= motion.before * motion.transform(at);
            let (child, child_from_motion) = if k == last {
                (second.clone(), chain.end.inverse())
            } else {
                let name = self.skeleton.fresh(format!("{}, part {}", joint.name, k + 1));
                self.link(&name, &base_from);
                (name, Pose::identity())
            };
            let sign = if motion.reversed { -1.0 } else { 1.0 };
            let coordinate = motion.coordinate;
            let (kind, point, axes) = match motion.factor {
                Factor::Turn { axis, point } => {
                    let direction = axis.into_inner() * sign;
                    ("revolute", point, vec![Axis { direction, coordinate }])
                }
                Factor::Slide { axis } => {
                    let direction = axis.into_inner() * sign;
                    ("prismatic", Vector3::zeros(), vec![Axis { direction, coordinate }])
                }
                // A screw is the same along its axis and against it.
                Factor::Screw { .. } => {
                    let direction = Vector3::z() * sign;
                    ("screw", Vector3::zeros(), vec![Axis { direction, coordinate }])
                }
                Factor::Ball => ("ball", Vector3::zeros(), Vec::new()),
            };
            let at_point =
                Pose::from_parts(Translation3::from(point), nalgebra::Rotation3::identity());
            let child_from_joint = child_from_motion * at_point;
            self.element((j, &names[k], kind), [&parent, &child], &child_from_joint, &axes);
            parent = child;
        }
    }

    /// Whether a joint is one with two axes in the model.
    fn is_universal(&self, j: usize) -> bool {
        let mechanism = self.skeleton.mechanism;
        let joint = &mechanism.joints()[j];
        let has_virtual = mechanism.virtual_joints().iter().any(|one| one.joint == j);
        joint.kind == JointKind::Universal && !has_virtual && !joint.actuated
    }

    /// Joint and axis of the model for a coordinate.
    fn axis_of(&mut self, coordinate: usize) -> (String, &'static str) {
        let mut first = 0;
        for (j, joint) in self.skeleton.mechanism.joints().iter().enumerate() {
            let freedoms = first..first + joint.kind.freedoms();
            if freedoms.contains(&coordinate) && self.is_universal(j) {
                let name = self.joint_name(&joint.name);
                return (name, if coordinate == first { "axis" } else { "axis2" });
            }
            first = freedoms.end;
        }
        let name = self.skeleton.motion_name(coordinate);
        (self.joint_name(&name), "axis")
    }

    fn mimic(&mut self, mimic: Mimic) {
        let (joint, axis) = self.axis_of(mimic.leader);
        let mut attributes = vec![("joint", joint)];
        if axis != "axis" {
            attributes.push(("axis", axis.to_owned()));
        }
        self.xml.open("mimic", &attributes);
        for (name, value) in
            [("multiplier", mimic.ratio), ("offset", mimic.offset), ("reference", 0.0)]
        {
            self.xml.with_text(name, &[], &number(value));
        }
        self.xml.close();
    }

    /// The name of a joint in the model, where links, frames and joints share one list of names.
    fn joint_name(&mut self, name: &str) -> String {
        if let Some((_, new)) = self.renamed.iter().find(|(old, _)| old == name) {
            return new.clone();
        }
        let mechanism = self.skeleton.mechanism;
        let mut others =
            mechanism.links().iter().chain(mechanism.frames().iter().map(|frame| &frame.name));
        if others.all(|other| other != name) {
            return name.to_owned();
        }
        let new = self.skeleton.fresh(format!("{name} joint"));
        self.lost.push(format!("joint {name:?} is named {new:?}: a link or frame has its name"));
        self.renamed.push((name.to_owned(), new.clone()));
        new
    }

    fn element(
        &mut self,
        (j, name, kind): (usize, &str, &str),
        [parent, child]: [&str; 2],
        child_from_joint: &Pose,
        axes: &[Axis],
    ) {
        let skeleton = self.skeleton;
        let name = &self.joint_name(name);
        self.xml.open("joint", &[("name", name.into()), ("type", kind.into())]);
        self.pose(child_from_joint, Some(child));
        self.xml.with_text("parent", &[], parent);
        self.xml.with_text("child", &[], child);
        if let (JointKind::Helical { lead }, "screw") = (skeleton.mechanism.joints()[j].kind, kind)
        {
            let pitch = lead * std::f64::consts::TAU;
            self.xml.with_text("screw_thread_pitch", &[], &number(pitch));
        }
        for (axis, tag) in axes.iter().zip(["axis", "axis2"]) {
            self.xml.open(tag, &[]);
            self.xml.with_text("xyz", &[], &vector(&axis.direction));
            if let Some(mimic) = self.mimics.of(axis.coordinate) {
                self.mimic(mimic);
            }
            if let Some(limits) = skeleton.limits(j, axis.coordinate) {
                let zero = skeleton.coordinates[axis.coordinate];
                self.xml.open("limit", &[]);
                for (tag, end) in ["lower", "upper"].into_iter().zip(limits) {
                    if end.is_finite() {
                        self.xml.with_text(tag, &[], &number(end - zero));
                    }
                }
                self.xml.close();
            }
            if let Some(m) = skeleton.virtual_joint(axis.coordinate) {
                self.xml.open("dynamics", &[]);
                let zero = skeleton.coordinates[axis.coordinate];
                self.xml.with_text("spring_reference", &[], &number(-zero));
                self.xml.with_text("spring_stiffness", &[], &number(skeleton.stiffness[m]));
                self.xml.close();
            }
            self.xml.close();
        }
        self.xml.close();
    }

    /// Controllers of actuated joints.
    fn controllers(&mut self) {
        for name in std::mem::take(&mut self.driven) {
            let name = self.joint_name(&name);
            let attributes = [
                ("filename", "gz-sim-joint-position-controller-system".to_owned()),
                ("name", super::POSITION_CONTROLLER.to_owned()),
            ];
            self.xml.open("plugin", &attributes);
            self.xml.with_text("joint_name", &[], &name);
            self.xml.with_text("use_velocity_commands", &[], "true");
            self.xml.close();
        }
    }
}
