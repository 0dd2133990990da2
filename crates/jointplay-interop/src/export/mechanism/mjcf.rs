//! Mechanisms as models of MuJoCo.

use jointplay_core::mechanism::joint::Factor;
use jointplay_core::mechanism::{FrameId, Mechanism};
use jointplay_core::spatial::Pose;
use nalgebra::{DVector, Point3, Vector3};

use super::Written;
use super::error::Error;
use super::skeleton::{Body, Skeleton};
use super::xml::{Xml, number, numbers, quaternion, vector};
use crate::export::joint_points::{BAR, bars, drawn_points, joint_points, size};

/// Step of the simulation (s).
const TIME_STEP: f64 = 1e-3;
/// Time constant of closures, the least that MuJoCo allows for its step (s).
const CLOSURE_TIME: f64 = 2.0 * TIME_STEP;
/// Impedance of closures, the largest that MuJoCo has: the closer to 1, the less a closure yields.
const IMPEDANCE: f64 = 0.9999;
/// Length by which angles of closures are weighed (m): MuJoCo has no resistance for it, so that closures yield by angles in proportion to its inverse square; from mechanisms of micrometres to those of kilometres, less than 1e-10 rad to springs.
const TORQUE_SCALE: f64 = 100.0;
/// Angular frequency at which a body oscillates on the stiffest spring; with it closures yield less than a nanometre to springs (rad/s).
const FREQUENCY: f64 = 100.0;
/// Ratio of the gain of an actuator to the stiffest spring.
const GAIN: f64 = 1e5;

/// Attributes of constraints that yield as little as possible.
fn stiff() -> [(&'static str, String); 2] {
    let impedance = numbers(&[IMPEDANCE, IMPEDANCE, 1e-3, 0.5, 2.0]);
    [("solref", numbers(&[CLOSURE_TIME, 1.0])), ("solimp", impedance)]
}

/// Masses, springs and gains of a model.
struct Scale {
    /// Mass of each body (kg).
    mass: f64,
    /// Stiffness of the stiffest slide, or what it would be (N/m).
    stiffness: f64,
    /// Size by which angles are weighed (m).
    length: f64,
}

/// A mechanism at a closed configuration as a model of MuJoCo (MJCF).
///
/// Links are bodies with their frames; joints are hinges, slides and balls with the coordinates and limits of the mechanism.
/// Virtual joints are slides and hinges with a spring; actuated joints have position actuators.
/// Loops are closed by `connect` at spherical joints and by `weld` otherwise; couplings are equalities of joints, or of a fixed tendon where there are more than two; attached frames are sites.
///
/// # Arguments
/// * `coordinates` – (f + M) of a closed configuration, which becomes the model's reference (m, rad)
///
/// # Errors
/// [`Error::Core`] for coordinates that are not those of the mechanism; [`Error::Unsupported`] for screw joints, [`Error::Coupling`] for couplings of joints that close loops.
///
/// # Source
/// \[MJCF\]
pub fn mjcf(mechanism: &Mechanism, coordinates: &DVector<f64>) -> Result<Written, Error> {
    let skeleton = Skeleton::new(mechanism, coordinates)?;
    let is_screw = |body: &&Body| {
        body.chain.motions.iter().any(|one| matches!(one.factor, Factor::Screw { .. }))
    };
    if let Some(joint) = skeleton.bodies.iter().find(is_screw).and_then(|body| body.joint) {
        let joint = &mechanism.joints()[joint];
        return Err(Error::Unsupported {
            joint: joint.name.clone(),
            kind: joint.kind.name(),
            format: "MJCF",
            advice: "; SDF describes it",
        });
    }
    let coupled = |coupling| skeleton.coupled(coupling, "MJCF").map(|joints| (coupling, joints));
    let couplings = mechanism.couplings().iter().map(coupled).collect::<Result<Vec<_>, _>>()?;
    let mut writer = Writer::new(&skeleton);
    writer.couplings = couplings
        .into_iter()
        .map(|(coupling, (follower, others))| {
            // MuJoCo counts from the reference.
            let by_others: f64 = others.iter().map(|(joint, ratio)| ratio * joint.value).sum();
            let constant = coupling.offset + by_others - follower.value;
            let terms = others.iter().map(|(joint, ratio)| (joint.name.to_owned(), *ratio));
            let terms = terms.collect();
            let follower = follower.name.to_owned();
            CoupledSum { name: coupling.name.clone(), follower, terms, constant }
        })
        .collect();
    writer.model();
    let Writer { xml, lost: of_model, .. } = writer;
    let mut lost = skeleton.lost.clone();
    lost.extend(of_model);
    lost.push("masses are not those of a real robot: each body has the same".to_owned());
    Ok(Written { text: xml.text, loops: None, lost })
}

/// An end of a range without limit: positions beyond are invalid in MuJoCo (mjMAXVAL).
const ENDLESS: f64 = 1e10;

struct Writer<'s, 'a> {
    skeleton: &'s Skeleton<'a>,
    scale: Scale,
    xml: Xml,
    children: Vec<Vec<usize>>,
    /// Positions of the reference configuration, in MuJoCo's order.
    positions: Vec<f64>,
    /// Actuated hinges and slides: name, position, limits, whether it is an angle.
    actuators: Vec<(String, f64, Option<[f64; 2]>, bool)>,
    couplings: Vec<CoupledSum>,
    lost: Vec<String>,
}

/// A coupling, counted from the reference: `follower = constant + Σ ratio · joint`.
struct CoupledSum {
    name: String,
    follower: String,
    terms: Vec<(String, f64)>,
    constant: f64,
}

impl<'s, 'a> Writer<'s, 'a> {
    fn new(skeleton: &'s Skeleton<'a>) -> Self {
        let length = skeleton.length;
        let stiffness = skeleton.stiffest();
        let mut children = vec![Vec::new(); skeleton.bodies.len()];
        for (k, body) in skeleton.bodies.iter().enumerate() {
            if let Some(parent) = body.parent {
                children[parent].push(k);
            }
        }
        let mass = stiffness / (FREQUENCY * FREQUENCY);
        let scale = Scale { mass, stiffness, length };
        let (positions, actuators, lost) = (Vec::new(), Vec::new(), Vec::new());
        let (xml, couplings) = (Xml::new(), Vec::new());
        Self { skeleton, scale, xml, children, positions, actuators, couplings, lost }
    }

    fn model(&mut self) {
        let name = self.skeleton.mechanism.name().to_owned();
        self.xml.open("mujoco", &[("model", name)]);
        self.xml.empty("compiler", &[("angle", "radian".into()), ("autolimits", "true".into())]);
        let option = [
            ("timestep", number(TIME_STEP)),
            ("integrator", "implicitfast".into()),
            ("iterations", "200".into()),
            ("tolerance", "0".into()),
        ];
        self.xml.open("option", &option);
        self.xml.empty("flag", &[("gravity", "disable".into()), ("contact", "disable".into())]);
        self.xml.close();
        self.xml.open("default", &[]);
        let unseen = [("contype", "0".into()), ("conaffinity", "0".into()), ("mass", "0".into())];
        self.xml.empty("geom", &unseen);
        self.xml.close();
        self.xml.open("worldbody", &[]);
        self.tree();
        self.xml.close();
        self.tendons();
        self.closures();
        self.actuators();
        self.keyframe();
        self.xml.close();
    }

    /// Bodies and their contents, without recursion: a chain can be as long as a file.
    fn tree(&mut self) {
        let points = joint_points(self.skeleton.mechanism);
        let poses = vec![Pose::identity(); points.len()];
        let size = size(&points, &poses);
        let points = drawn_points(self.skeleton.mechanism, points, size);
        let mut stack = vec![Some(0)];
        while let Some(next) = stack.pop() {
            let Some(k) = next else {
                self.xml.close();
                continue;
            };
            let is_world = k == 0 && self.skeleton.bodies[0].name == "world";
            if !is_world {
                self.body(k);
                stack.push(None);
            }
            if let Some(link) = self.skeleton.bodies[k].link {
                self.geoms(&points[link], size);
                self.sites(link);
            }
            stack.extend(self.children[k].iter().rev().map(|&child| Some(child)));
        }
    }

    fn body(&mut self, k: usize) {
        let skeleton = self.skeleton;
        let body = &skeleton.bodies[k];
        let at = body.chain.transform(&skeleton.coordinates);
        let attributes = [
            ("name", body.name.clone()),
            ("pos", vector(&at.translation.vector)),
            ("quat", quaternion(&at.rotation)),
        ];
        self.xml.open("body", &attributes);
        let (mass, length) = (self.scale.mass, self.scale.length);
        let inertia = mass * length * length;
        let inertial = [
            ("pos", numbers(&[0.0; 3])),
            ("mass", number(mass)),
            ("diaginertia", numbers(&[inertia; 3])),
        ];
        self.xml.empty("inertial", &inertial);
        // The frame behind each motion, in the frame of the body at the reference.
        let mut body_from = body.chain.end.inverse();
        let mut frames = vec![Pose::identity(); body.chain.motions.len()];
        for (frame, motion) in frames.iter_mut().zip(&body.chain.motions).rev() {
            *frame = body_from;
            let through = motion.before * motion.transform(&skeleton.coordinates);
            body_from *= through.inverse();
        }
        for (i, frame) in frames.iter().enumerate() {
            self.joint(k, i, frame);
        }
    }

    fn joint(&mut self, k: usize, i: usize, body_from_motion: &Pose) {
        let skeleton = self.skeleton;
        let body = &skeleton.bodies[k];
        let (motion, name) = (&body.chain.motions[i], &body.names[i]);
        let joint = body.joint.expect("motions are those of a joint");
        let sign = if motion.reversed { -1.0 } else { 1.0 };
        let at = |point: &Vector3<f64>| (body_from_motion * Point3::from(*point)).coords;
        let mut attributes = vec![("name", name.clone())];
        let Scale { mass, stiffness, length } = self.scale;
        let weight = if Skeleton::is_turn(&motion.factor) { length * length } else { 1.0 };
        match &motion.factor {
            Factor::Turn { axis, point } => {
                attributes.push(("type", "hinge".into()));
                attributes.push(("pos", vector(&at(point))));
                let axis = body_from_motion.rotation * axis.into_inner() * sign;
                attributes.push(("axis", vector(&axis)));
            }
            Factor::Slide { axis } => {
                attributes.push(("type", "slide".into()));
                let axis = body_from_motion.rotation * axis.into_inner() * sign;
                attributes.push(("axis", vector(&axis)));
            }
            Factor::Ball => {
                attributes.push(("type", "ball".into()));
                attributes.push(("pos", vector(&at(&Vector3::zeros()))));
                let damping = mass * length * length * FREQUENCY * 0.1;
                attributes.push(("damping", number(damping)));
                self.xml.empty("joint", &attributes);
                self.positions.extend([1.0, 0.0, 0.0, 0.0]);
                let described = &skeleton.mechanism.joints()[joint];
                if !described.limits.is_empty() {
                    self.lost.push(format!("limits of {name:?}: balls of MJCF have a cone only"));
                }
                if described.actuated {
                    self.lost.push(format!("actuator of {name:?}: it is a ball"));
                }
                return;
            }
            Factor::Screw { .. } => unreachable!("screws are refused"),
        }
        let value = skeleton.coordinates[motion.coordinate];
        self.positions.push(value);
        if value != 0.0 {
            attributes.push(("ref", number(value)));
        }
        let limits = skeleton.limits(joint, motion.coordinate);
        let limits = limits.map(|ends| ends.map(|end| end.clamp(-ENDLESS, ENDLESS)));
        if let Some(limits) = limits {
            attributes.push(("range", numbers(&limits)));
        }
        let damping = if let Some(m) = skeleton.virtual_joint(motion.coordinate) {
            attributes.push(("stiffness", number(skeleton.stiffness[m])));
            2.0 * (skeleton.stiffness[m] * mass * weight).sqrt()
        } else if skeleton.is_actuated(joint, motion.coordinate) {
            let turn = Skeleton::is_turn(&motion.factor);
            self.actuators.push((name.clone(), value, limits, turn));
            // The inertia of a drive, with which a stiff actuator is as slow as the springs.
            let armature = GAIN * stiffness * weight / (FREQUENCY * FREQUENCY);
            attributes.push(("armature", number(armature)));
            0.0
        } else {
            (stiffness * mass).sqrt() * weight * 0.1
        };
        attributes.push(("damping", number(damping)));
        self.xml.empty("joint", &attributes);
    }

    /// Bars between the joints of a link; a ball at its only one.
    fn geoms(&mut self, points: &[Vector3<f64>], size: f64) {
        let radius = BAR * size;
        for [from, to] in bars(points, radius) {
            let attributes = [
                ("type", "capsule".into()),
                ("size", number(radius)),
                ("fromto", numbers(&[from.as_slice(), to.as_slice()].concat())),
            ];
            self.xml.empty("geom", &attributes);
        }
        if let [only] = points {
            let attributes =
                [("type", "sphere".into()), ("size", number(radius)), ("pos", vector(only))];
            self.xml.empty("geom", &attributes);
        }
    }

    /// Sites of the frames attached to a link.
    fn sites(&mut self, link: usize) {
        let mechanism = self.skeleton.mechanism;
        for (k, frame) in mechanism.frames().iter().enumerate().filter(|(_, one)| one.link == link)
        {
            let at = mechanism.link_from_frame(FrameId::Attached(k));
            let attributes = [
                ("name", frame.name.clone()),
                ("pos", vector(&at.translation.vector)),
                ("quat", quaternion(&at.rotation)),
            ];
            self.xml.empty("site", &attributes);
        }
    }

    fn closures(&mut self) {
        let skeleton = self.skeleton;
        if skeleton.closures.is_empty() && self.couplings.is_empty() {
            return;
        }
        self.xml.open("equality", &[]);
        for closure in &skeleton.closures {
            let body = |side: usize| skeleton.bodies[closure.bodies[side]].name.clone();
            let mut attributes =
                vec![("name", closure.name.clone()), ("body1", body(0)), ("body2", body(1))];
            if closure.is_ball {
                attributes.push(("anchor", vector(&closure.frames[0].translation.vector)));
            } else {
                attributes.push(("anchor", vector(&closure.frames[1].translation.vector)));
                attributes.push(("torquescale", number(TORQUE_SCALE)));
            }
            attributes.extend(stiff());
            self.xml.empty(if closure.is_ball { "connect" } else { "weld" }, &attributes);
        }
        for coupling in &self.couplings {
            let mut attributes = vec![("name", coupling.name.clone())];
            let tag = match &coupling.terms[..] {
                [] | [_] => {
                    attributes.push(("joint1", coupling.follower.clone()));
                    let other = coupling.terms.first();
                    attributes.extend(other.map(|(joint, _)| ("joint2", joint.clone())));
                    let ratio = other.map_or(0.0, |(_, ratio)| *ratio);
                    let polynomial = [coupling.constant, ratio, 0.0, 0.0, 0.0];
                    attributes.push(("polycoef", numbers(&polynomial)));
                    "joint"
                }
                _ => {
                    attributes.push(("tendon1", coupling.name.clone()));
                    attributes
                        .push(("polycoef", numbers(&[coupling.constant, 0.0, 0.0, 0.0, 0.0])));
                    "tendon"
                }
            };
            attributes.extend(stiff());
            self.xml.empty(tag, &attributes);
        }
        self.xml.close();
    }

    /// Sums of more than two coordinates, which couplings hold at a value.
    fn tendons(&mut self) {
        let sums: Vec<&CoupledSum> =
            self.couplings.iter().filter(|coupling| coupling.terms.len() > 1).collect();
        if sums.is_empty() {
            return;
        }
        self.xml.open("tendon", &[]);
        for CoupledSum { name, follower, terms, .. } in sums {
            self.xml.open("fixed", &[("name", name.clone())]);
            let others = terms.iter().map(|(joint, ratio)| (joint, -ratio));
            for (joint, coefficient) in std::iter::once((follower, 1.0)).chain(others) {
                let attributes = [("joint", joint.clone()), ("coef", number(coefficient))];
                self.xml.empty("joint", &attributes);
            }
            self.xml.close();
        }
        self.xml.close();
    }

    fn actuators(&mut self) {
        if self.actuators.is_empty() {
            return;
        }
        self.xml.open("actuator", &[]);
        for (name, _, limits, is_turn) in &self.actuators {
            let weight = if *is_turn { self.scale.length * self.scale.length } else { 1.0 };
            let gain = GAIN * self.scale.stiffness * weight;
            let mut attributes = vec![
                ("name", name.clone()),
                ("joint", name.clone()),
                ("kp", number(gain)),
                ("kv", number(2.0 * gain / FREQUENCY)),
            ];
            if let Some(limits) = limits {
                attributes.push(("ctrlrange", numbers(limits)));
            }
            self.xml.empty("position", &attributes);
        }
        self.xml.close();
    }

    /// The reference configuration, at which actuators hold it.
    fn keyframe(&mut self) {
        if self.positions.is_empty() {
            return;
        }
        let commands: Vec<f64> = self.actuators.iter().map(|(_, value, ..)| *value).collect();
        let mut attributes =
            vec![("name", "reference".to_owned()), ("qpos", numbers(&self.positions))];
        if !commands.is_empty() {
            attributes.push(("ctrl", numbers(&commands)));
        }
        self.xml.open("keyframe", &[]);
        self.xml.empty("key", &attributes);
        self.xml.close();
    }
}
