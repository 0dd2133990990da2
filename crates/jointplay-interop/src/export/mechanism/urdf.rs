//! Mechanisms as robots of ROS.

use jointplay_core::mechanism::joint::Factor;
use jointplay_core::mechanism::{
    Coupling, ElementaryMotion, FrameId, Joint, JointCoordinate, JointKind, LinearAndAngular,
    Mechanism,
};
use jointplay_core::spatial::Pose;
use jointplay_format::mechanism::{allowed_joint_name, write_loops};
use nalgebra::{DVector, Rotation3, Translation3, Vector3};

use super::Written;
use super::error::Error;
use super::mimics::Mimics;
use super::skeleton::{Body, Skeleton};
use super::xml::{Xml, number, roll_pitch_yaw, vector};

/// Travel of a slide without limits, for which URDF needs some (m).
const TRAVEL: f64 = 1000.0;
/// An end of a range without limit (m, rad); readers of URDF know no infinity.
const ENDLESS: f64 = 1e16;
/// Mass of each link (kg).
const MASS: f64 = 1.0;

/// A mechanism as a robot of ROS (URDF), with a second file of the joints that close its loops.
///
/// Links have their frames, joints their coordinates and limits; several motions of one joint are joints with links between them, a ball is three turns about x, y and z.
/// Actuated joints have a command interface, all joints an initial value at the closed configuration.
/// Virtual joints are joints; their stiffness has no place.
/// A joint that is coupled to another mimics it: an actuated one leads. Couplings that URDF cannot describe, and those that others imply, are in the second file.
///
/// # Arguments
/// * `coordinates` – (f + M) of a closed configuration (m, rad)
///
/// # Errors
/// [`Error::Core`] for coordinates that are not those of the mechanism; [`Error::Unsupported`] for screw joints that close no loop.
///
/// # Source
/// \[URDF\]
pub fn urdf(mechanism: &Mechanism, coordinates: &DVector<f64>) -> Result<Written, Error> {
    let skeleton = Skeleton::with_whole_closures(mechanism, coordinates)?;
    // Joints that close loops are in the second file, and mimic none.
    let mimics = Mimics::new(&skeleton, |coupling| skeleton.coupled(coupling, "URDF").is_ok());
    let mut lost = skeleton.lost.clone();
    lost.extend(mimics.lost.iter().cloned());
    let couplings = mimics.others();
    let mut writer = Writer {
        skeleton: &skeleton,
        xml: Xml::new(),
        parts: Vec::new(),
        lost,
        controlled: Vec::new(),
        mimics,
    };
    writer.xml.open("robot", &[("name", mechanism.name().into())]);
    writer.link(&mechanism.links()[0], true);
    for body in &skeleton.bodies[1..] {
        writer.body(body)?;
    }
    for (k, frame) in mechanism.frames().iter().enumerate() {
        let at = mechanism.link_from_frame(FrameId::Attached(k));
        let name = skeleton.fresh(format!("{} is fixed", frame.name));
        writer.link(&frame.name, true);
        let link = &mechanism.links()[frame.link];
        writer.joint(&name, "fixed", [link, &frame.name], &at);
        writer.xml.close();
    }
    writer.control();
    writer.xml.close();
    let Writer { xml, mut lost, .. } = writer;
    if !mechanism.virtual_joints().is_empty() {
        lost.push("stiffness of virtual joints".to_owned());
    }
    lost.push("masses are not those of a real robot: each link has the same".to_owned());
    let elsewhere = |coupling: &Coupling| {
        let name = &coupling.name;
        format!("coupling {name:?} is in the file of loops, which other programs do not read")
    };
    lost.extend(couplings.iter().map(elsewhere));
    let loops = loops(&skeleton, &couplings);
    Ok(Written { text: xml.text, loops, lost })
}

struct Writer<'s, 'a> {
    skeleton: &'s Skeleton<'a>,
    xml: Xml,
    /// Names given to links between the motions of a joint.
    parts: Vec<String>,
    lost: Vec<String>,
    /// Joints with a state: name, value, whether a motor drives it.
    controlled: Vec<(String, f64, bool)>,
    mimics: Mimics,
}

/// A motion of one coordinate about or along an axis of the frame before it.
struct Elementary {
    name: String,
    /// Index among all coordinates; `None` for a turn of a ball.
    coordinate: Option<usize>,
    before: Pose,
    axis: Vector3<f64>,
    point: Vector3<f64>,
    is_turn: bool,
    limits: Option<[f64; 2]>,
    value: f64,
    is_driven: bool,
}

impl Writer<'_, '_> {
    fn link(&mut self, name: &str, is_massless: bool) {
        if is_massless {
            self.xml.empty("link", &[("name", name.into())]);
            return;
        }
        let inertia = number(MASS * self.skeleton.length * self.skeleton.length);
        let zero = || "0".to_owned();
        self.xml.open("link", &[("name", name.into())]);
        self.xml.open("inertial", &[]);
        self.xml.empty("mass", &[("value", number(MASS))]);
        let attributes = [
            ("ixx", inertia.clone()),
            ("iyy", inertia.clone()),
            ("izz", inertia),
            ("ixy", zero()),
            ("ixz", zero()),
            ("iyz", zero()),
        ];
        self.xml.empty("inertia", &attributes);
        self.xml.close();
        self.xml.close();
    }

    /// Opens a joint, with its links and its place.
    fn joint(&mut self, name: &str, kind: &str, [parent, child]: [&str; 2], at: &Pose) {
        self.xml.open("joint", &[("name", name.into()), ("type", kind.into())]);
        let place =
            [("xyz", vector(&at.translation.vector)), ("rpy", roll_pitch_yaw(&at.rotation))];
        self.xml.empty("origin", &place);
        self.xml.empty("parent", &[("link", parent.into())]);
        self.xml.empty("child", &[("link", child.into())]);
    }

    /// A body with its joint to the parent; between several motions there are links.
    fn body(&mut self, body: &Body) -> Result<(), Error> {
        let skeleton = self.skeleton;
        let parent = body.parent.map_or("", |parent| &skeleton.bodies[parent].name);
        let joint = body.joint.expect("every body but the base has a joint");
        let described = &skeleton.mechanism.joints()[joint];
        let mut all = Vec::new();
        for (motion, name) in body.chain.motions.iter().zip(&body.names) {
            self.elementary(joint, motion, name, &mut all)?;
        }
        let mut from = parent.to_owned();
        let Some(last) = all.len().checked_sub(1) else {
            self.link(&body.name, false);
            self.joint(&described.name, "fixed", [&from, &body.name], &body.chain.end);
            self.xml.close();
            return Ok(());
        };
        // The frame of the parent link, in the frame behind the previous motion.
        let mut from_link = Pose::identity();
        for (k, one) in all.iter().enumerate() {
            let end = body.chain.end;
            // A turn is about an axis through the origin of the child: a slide may have the child's frame anywhere.
            let is_through = !one.is_turn || {
                let off = end.translation.vector - one.point;
                off.cross(&one.axis).norm() == 0.0
            };
            let is_end = k == last && is_through;
            let before = from_link * one.before;
            let (child, child_from, at) = if is_end {
                (body.name.clone(), end.rotation.inverse(), before * end)
            } else {
                let at =
                    before * Pose::from_parts(Translation3::from(one.point), Rotation3::identity());
                (self.part(&described.name), Rotation3::identity(), at)
            };
            self.link(&child, false);
            let kind = match (one.is_turn, one.limits) {
                (true, None) => "continuous",
                (true, Some(_)) => "revolute",
                (false, _) => "prismatic",
            };
            self.joint(&one.name, kind, [&from, &child], &at);
            self.xml.empty("axis", &[("xyz", vector(&(child_from * one.axis)))]);
            let limits = one.limits.or((!one.is_turn).then_some([-TRAVEL, TRAVEL]));
            if let Some([least, most]) = limits {
                if one.limits.is_none() {
                    let name = &one.name;
                    self.lost.push(format!("{name:?} has no limits; URDF needs some: ±{TRAVEL} m"));
                }
                let bound = |end: f64| number(end.clamp(-ENDLESS, ENDLESS));
                let limit = [
                    ("lower", bound(least)),
                    ("upper", bound(most)),
                    ("effort", "1e6".to_owned()),
                    ("velocity", "1e3".to_owned()),
                ];
                self.xml.empty("limit", &limit);
            }
            let mimic = one.coordinate.and_then(|coordinate| self.mimics.of(coordinate));
            if let Some(mimic) = mimic {
                let attributes = [
                    ("joint", skeleton.motion_name(mimic.leader)),
                    ("multiplier", number(mimic.ratio)),
                    ("offset", number(mimic.offset)),
                ];
                self.xml.empty("mimic", &attributes);
            }
            self.xml.close();
            // A joint that mimics another must not have a command interface.
            self.controlled.push((one.name.clone(), one.value, one.is_driven && mimic.is_none()));
            from_link = Pose::from_parts(Translation3::from(-one.point), Rotation3::identity());
            from = child;
        }
        if from != body.name {
            self.link(&body.name, false);
            let name = format!("{} on {}", body.name, from);
            let name = skeleton.fresh(allowed_joint_name(&name).into_owned());
            self.joint(&name, "fixed", [&from, &body.name], &(from_link * body.chain.end));
            self.xml.close();
        }
        Ok(())
    }

    /// The motions about single axes that make up a motion.
    fn elementary(
        &mut self,
        joint: usize,
        motion: &ElementaryMotion,
        name: &str,
        all: &mut Vec<Elementary>,
    ) -> Result<(), Error> {
        let skeleton = self.skeleton;
        let described = &skeleton.mechanism.joints()[joint];
        let sign = if motion.reversed { -1.0 } else { 1.0 };
        let (axis, point, is_turn) = match motion.factor {
            Factor::Turn { axis, point } => (axis.into_inner() * sign, point, true),
            Factor::Slide { axis } => (axis.into_inner() * sign, Vector3::zeros(), false),
            Factor::Screw { .. } => {
                return Err(Error::Unsupported {
                    joint: described.name.clone(),
                    kind: described.kind.name(),
                    format: "URDF",
                    advice: "; SDF describes it",
                });
            }
            Factor::Ball => {
                // The turns are at zero in the closed configuration, far from where two axes coincide.
                let home = motion.transform(&skeleton.coordinates);
                let mut before = motion.before * home;
                for (k, axis) in [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().enumerate()
                {
                    all.push(Elementary {
                        name: skeleton.fresh(format!("{name} about {}", ["x", "y", "z"][k])),
                        coordinate: None,
                        before: std::mem::replace(&mut before, Pose::identity()),
                        axis,
                        point: Vector3::zeros(),
                        is_turn: true,
                        limits: None,
                        value: 0.0,
                        is_driven: false,
                    });
                }
                self.lost.push(format!(
                    "{name:?} is a ball: it is three turns, which are at zero in the closed configuration"
                ));
                if !described.limits.is_empty() && described.kind == JointKind::Spherical {
                    self.lost.push(format!("limits of {name:?}"));
                }
                if described.actuated {
                    self.lost.push(format!("actuator of {name:?}: it is a ball"));
                }
                return Ok(());
            }
        };
        let coordinate = motion.coordinate;
        all.push(Elementary {
            name: name.to_owned(),
            coordinate: Some(coordinate),
            before: motion.before,
            axis,
            point,
            is_turn,
            limits: skeleton.limits(joint, coordinate),
            value: skeleton.coordinates[coordinate],
            is_driven: skeleton.is_actuated(joint, coordinate),
        });
        Ok(())
    }

    /// A name for a link between the motions of a joint.
    fn part(&mut self, joint: &str) -> String {
        let number = 1 + self.parts.iter().filter(|one| *one == joint).count();
        self.parts.push(joint.to_owned());
        self.skeleton.fresh(format!("{joint} part {number}"))
    }

    /// Interfaces of the joints, as `ros2_control` has them.
    fn control(&mut self) {
        let name = self.skeleton.mechanism.name().to_owned();
        self.xml.open("ros2_control", &[("name", name), ("type", "system".into())]);
        self.xml.open("hardware", &[]);
        self.xml.with_text("plugin", &[], "mock_components/GenericSystem");
        self.xml.close();
        for (name, value, is_driven) in std::mem::take(&mut self.controlled) {
            self.xml.open("joint", &[("name", name)]);
            if is_driven {
                self.xml.empty("command_interface", &[("name", "position".into())]);
            }
            self.xml.open("state_interface", &[("name", "position".into())]);
            self.xml.with_text("param", &[("name", "initial_value".into())], &number(value));
            self.xml.close();
            self.xml.close();
        }
        self.xml.close();
    }
}

/// The file of joints that close loops, and of couplings; `None` if there are none.
fn loops(skeleton: &Skeleton<'_>, couplings: &[Coupling]) -> Option<String> {
    let mut names: Vec<String> = skeleton.bodies.iter().map(|body| body.name.clone()).collect();
    let link = |names: &mut Vec<String>, name: &String| {
        names.iter().position(|one| one == name).unwrap_or_else(|| {
            names.push(name.clone());
            names.len() - 1
        })
    };
    let mut joints: Vec<Joint> = Vec::new();
    let mut first = 0;
    for (j, joint) in skeleton.mechanism.joints().iter().enumerate() {
        let values = &skeleton.coordinates[first..][..joint.kind.freedoms()];
        first += values.len();
        if skeleton.whole_closures.contains(&j) {
            let links = joint.links.map(|at| link(&mut names, &skeleton.mechanism.links()[at]));
            joints.push(Joint { links, guess: values.to_vec(), ..joint.clone() });
        }
    }
    for closure in &skeleton.closures {
        joints.push(Joint {
            name: closure.name.clone(),
            kind: if closure.is_ball { JointKind::Spherical } else { JointKind::Fixed },
            links: closure.bodies,
            frames: closure.frames,
            actuated: false,
            guess: Vec::new(),
            limits: Vec::new(),
            clearance: LinearAndAngular::default(),
            stiffness: LinearAndAngular::default(),
        });
    }
    let is_needed = !joints.is_empty() || !couplings.is_empty();
    // A joint that is not split has its coordinates in the file of loops.
    let coordinate = |one: JointCoordinate| {
        let joint = &skeleton.mechanism.joints()[one.joint];
        match skeleton.whole_closures.contains(&one.joint) && joint.kind.freedoms() > 1 {
            true => format!("{}[{}]", joint.name, one.freedom),
            false => skeleton.motion_name(skeleton.coordinate(one)),
        }
    };
    is_needed.then(|| write_loops(&names, &joints, (couplings, &coordinate)))
}
