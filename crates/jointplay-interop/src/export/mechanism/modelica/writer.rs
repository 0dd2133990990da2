//! Components and connections of a model in Modelica.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use jointplay_core::mechanism::joint::Factor;
use jointplay_core::mechanism::{Coupling, ElementaryMotion, FrameId, JointKind};
use jointplay_core::spatial::Pose;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::super::error::Error;
use super::super::skeleton::{Body, Skeleton};
use super::super::xml::number;
use super::names::{Identifiers, quoted};

/// Components of the models, in Modelica.
const COMPONENTS: &str = include_str!("components.mo");
/// Ratio of the stiffness of closures and couplings to that of the stiffest virtual joint: closures yield a millionth of a displacement.
const CLOSURE: f64 = 1e6;
/// Time in which a coordinate with the stiffest spring settles (s); coordinates lag behind drives by it.
const TIME: f64 = 1e-6;

/// A model in progress.
pub(super) struct Writer<'s, 'a> {
    skeleton: &'s Skeleton<'a>,
    names: Identifiers,
    components: String,
    connections: String,
    /// Names of inputs, and their values in the reference configuration (m, rad).
    inputs: Vec<(String, f64)>,
    /// Frame of each body.
    frames: Vec<String>,
    /// Components of motions of one coordinate by their names, and whether they turn.
    motions: BTreeMap<String, (String, bool)>,
    /// Stiffness of closures against displacements (N/m).
    stiffness: f64,
    lost: Vec<String>,
}

impl<'s, 'a> Writer<'s, 'a> {
    pub(super) fn new(skeleton: &'s Skeleton<'a>) -> Self {
        Self {
            skeleton,
            names: Identifiers::default(),
            components: String::new(),
            connections: String::new(),
            inputs: Vec::new(),
            frames: Vec::new(),
            motions: BTreeMap::new(),
            stiffness: CLOSURE * skeleton.stiffest(),
            lost: Vec::new(),
        }
    }

    /// Links and parts of joints, each with the joint that moves it.
    pub(super) fn bodies(&mut self) {
        for body in &self.skeleton.bodies {
            let kind = if body.link.is_some() { "link" } else { "part" };
            let name = self.names.fresh(kind, &body.name);
            let class = if body.parent.is_some() { "Link" } else { "Base" };
            self.component(class, &name, &[], &body.name);
            self.frames.push(format!("{name}.frame"));
            if let Some(parent) = body.parent {
                self.joint(body, parent, &format!("{name}.frame"));
            }
        }
    }

    /// The motions of a body in series.
    fn joint(&mut self, body: &Body, parent: usize, frame: &str) {
        let mut before = self.frames[parent].clone();
        let Some(last) = body.chain.motions.len().checked_sub(1) else {
            let joint = body.joint.expect("bodies with a parent have a joint");
            let described = &self.skeleton.mechanism.joints()[joint].name;
            let name = self.names.fresh("joint", described);
            self.component("Rigid", &name, &pose(&body.chain.end, ""), described);
            self.connect(&before, &format!("{name}.a"));
            self.connect(&format!("{name}.b"), frame);
            return;
        };
        for (k, motion) in body.chain.motions.iter().enumerate() {
            let after = if k == last { body.chain.end } else { Pose::identity() };
            let name = self.motion(body, k, motion, &after);
            self.connect(&before, &format!("{name}.a"));
            before = format!("{name}.b");
        }
        self.connect(&before, frame);
    }

    fn motion(&mut self, body: &Body, k: usize, motion: &ElementaryMotion, after: &Pose) -> String {
        let skeleton = self.skeleton;
        let joint = body.joint.expect("motions are those of a joint");
        let described = &body.names[k];
        let name = self.names.fresh("joint", described);
        let is_turn = Skeleton::is_turn(&motion.factor);
        let sign = if motion.reversed { -1.0 } else { 1.0 };
        let mut terms = pose(&motion.before, "_before");
        terms.extend(pose(after, "_after"));
        let class = match &motion.factor {
            Factor::Ball => return self.ball(joint, &name, (described, terms), motion),
            Factor::Turn { axis, point } => {
                terms.push(format!("n = {}", vector(axis)));
                if point.norm() > 0.0 {
                    terms.push(format!("p = {}", vector(point)));
                }
                terms.extend(motion.reversed.then(|| "turn = -1".to_owned()));
                "Turn"
            }
            Factor::Slide { axis } => {
                terms.push(format!("n = {}", vector(axis)));
                terms.extend(motion.reversed.then(|| "travel = -1".to_owned()));
                "Slide"
            }
            Factor::Screw { lead } => {
                terms.extend(motion.reversed.then(|| "turn = -1".to_owned()));
                terms.push(format!("travel = {}", number(sign * lead)));
                "Screw"
            }
        };
        let value = skeleton.coordinates[motion.coordinate];
        let mut ends = Vec::new();
        if let Some([least, most]) = skeleton.limits(joint, motion.coordinate) {
            ends.extend(least.is_finite().then(|| format!("min = {}", number(least))));
            ends.extend(most.is_finite().then(|| format!("max = {}", number(most))));
        }
        let start = format!("start = {}", number(value));
        if skeleton.is_actuated(joint, motion.coordinate) {
            let input = self.names.fresh("drive", described);
            ends.push(format!("unit = \"{}\"", if is_turn { "rad" } else { "m" }));
            let attributes = [vec![start], ends].concat();
            self.component("RealInput", &input, &attributes, described);
            self.component(&format!("Driven{class}"), &name, &terms, described);
            self.connect(&input, &format!("{name}.u"));
            self.inputs.push((input, value));
        } else {
            let attributes = [vec![start, "fixed = true".to_owned()], ends].concat();
            terms.insert(0, format!("q({})", attributes.join(", ")));
            terms.push(format!("damping = {}", number(self.damping(is_turn))));
            if let Some(m) = skeleton.virtual_joint(motion.coordinate) {
                terms.push(format!("stiffness = {}", number(skeleton.stiffness[m])));
            }
            self.component(class, &name, &terms, described);
        }
        self.motions.insert(described.clone(), (name.clone(), is_turn));
        name
    }

    fn ball(
        &mut self,
        joint: usize,
        name: &str,
        (described, mut terms): (&str, Vec<String>),
        motion: &ElementaryMotion,
    ) -> String {
        let of_joint = &self.skeleton.mechanism.joints()[joint];
        if !of_joint.limits.is_empty() && of_joint.kind == JointKind::Spherical {
            self.lost.push(format!("limits of {described:?}: it is a ball"));
        }
        if of_joint.actuated {
            self.lost.push(format!("actuator of {described:?}: it is a ball"));
        }
        let turned = motion.transform(&self.skeleton.coordinates).rotation;
        let turned = UnitQuaternion::from_rotation_matrix(&turned);
        let start = list(&[turned.w, turned.i, turned.j, turned.k]);
        terms.insert(0, format!("Q(start = {start}, each fixed = true)"));
        terms.push(format!("damping = {}", number(self.damping(true))));
        self.component("Ball", name, &terms, described);
        name.to_owned()
    }

    /// Damping of a passive coordinate (N s/m, N m s/rad).
    fn damping(&self, is_turn: bool) -> f64 {
        TIME * self.skeleton.stiffest() * self.weight(is_turn)
    }

    /// Ratio of angular to linear stiffness for turns (m²).
    fn weight(&self, is_turn: bool) -> f64 {
        if is_turn { self.skeleton.length * self.skeleton.length } else { 1.0 }
    }

    /// Frames attached to links.
    pub(super) fn frames(&mut self) {
        let mechanism = self.skeleton.mechanism;
        for (k, frame) in mechanism.frames().iter().enumerate() {
            let bodies = self.skeleton.bodies.iter();
            let carrier = bodies.zip(&self.frames).find(|(body, _)| body.link == Some(frame.link));
            let carrier = carrier.expect("each link is a body").1.clone();
            let at = mechanism.link_from_frame(FrameId::Attached(k));
            let name = self.names.fresh("fixed", &frame.name);
            self.component("Rigid", &name, &pose(&at, ""), &frame.name);
            self.connect(&carrier, &format!("{name}.a"));
            let end = self.names.fresh("frame", &frame.name);
            self.component("Link", &end, &[], &frame.name);
            self.connect(&format!("{name}.b"), &format!("{end}.frame"));
        }
    }

    /// Stiff springs that close loops.
    pub(super) fn closures(&mut self) {
        for closure in &self.skeleton.closures {
            let name = self.names.fresh("loop", &closure.name);
            let mut terms = Vec::new();
            for (frame, side) in closure.frames.iter().zip(["_a", "_b"]) {
                let of_side = pose(frame, side);
                let is_kept = |term: &String| !closure.is_ball || term.starts_with('r');
                terms.extend(of_side.into_iter().filter(is_kept));
            }
            terms.push(format!("stiffness = {}", number(self.stiffness)));
            let class = if closure.is_ball {
                "ClosureOfPoints"
            } else {
                let angular = self.stiffness * self.weight(true);
                terms.push(format!("angular_stiffness = {}", number(angular)));
                "ClosureOfFrames"
            };
            self.component(class, &name, &terms, &closure.name);
            for (body, side) in closure.bodies.into_iter().zip(["a", "b"]) {
                let frame = self.frames[body].clone();
                self.connect(&frame, &format!("{name}.{side}"));
            }
        }
    }

    /// A stiff relation of coordinates, by the names of their motions.
    ///
    /// # Errors
    /// [`Error::Coupling`] for a coordinate of a ball.
    pub(super) fn coupling(
        &mut self,
        coupling: &Coupling,
        follower: &str,
        others: &[(&str, f64)],
    ) -> Result<(), Error> {
        let motion = |name: &str| {
            self.motions.get(name).cloned().ok_or_else(|| Error::Coupling {
                coupling: coupling.name.clone(),
                reason: "it joins a coordinate of a ball",
                format: "Modelica",
            })
        };
        let (follower, is_turn) = motion(follower)?;
        let joints = others.iter().map(|(name, _)| Ok(motion(name)?.0));
        let joints = joints.collect::<Result<Vec<_>, Error>>()?;
        let name = self.names.fresh("coupling", &coupling.name);
        let ratios: Vec<f64> = others.iter().map(|(_, ratio)| *ratio).collect();
        let mut terms = Vec::new();
        if !ratios.is_empty() {
            terms.push(format!("count = {}", ratios.len()));
            terms.push(format!("ratio = {}", list(&ratios)));
        }
        terms.push(format!("offset = {}", number(coupling.offset)));
        let stiffness = self.stiffness * self.weight(is_turn);
        terms.push(format!("stiffness = {}", number(stiffness)));
        let class = if ratios.is_empty() { "Hold" } else { "Coupling" };
        self.component(class, &name, &terms, &coupling.name);
        self.connect(&format!("{follower}.flange"), &format!("{name}.follower"));
        for (k, joint) in joints.iter().enumerate() {
            self.connect(&format!("{joint}.flange"), &format!("{name}.others[{}]", k + 1));
        }
        Ok(())
    }

    fn component(&mut self, class: &str, name: &str, terms: &[String], described: &str) {
        let terms =
            if terms.is_empty() { String::new() } else { format!("({})", terms.join(", ")) };
        let described = quoted(described);
        let _ = writeln!(self.components, "    {class} {name}{terms} {described};");
    }

    fn connect(&mut self, one: &str, other: &str) {
        let _ = writeln!(self.connections, "    connect({one}, {other});");
    }

    /// The text of the package; adds parts of the mechanism that it does not keep, and changes.
    pub(super) fn finish(self, class: &str, lost: &mut Vec<String>) -> String {
        let name = quoted(self.skeleton.mechanism.name());
        let held = self.inputs.iter().map(|(input, value)| format!("{input} = {}", number(*value)));
        let held: Vec<String> = held.collect();
        let held = if held.is_empty() { String::new() } else { format!("({})", held.join(", ")) };
        let Self { components, connections, .. } = self;
        lost.extend(self.lost);
        if self.names.are_changed {
            lost.push("names with characters other than letters, digits and _ are descriptions; identifiers have _ in their place".to_owned());
        }
        lost.push("masses: links have none, and the motion is quasi-static".to_owned());
        format!(
            "package {class} {name}\n{COMPONENTS}  model Mechanism {name}\n{components}  equation\n{connections}  end Mechanism;\n  model Reference \"The mechanism, with its drives held in the reference configuration\"\n    Mechanism mechanism{held};\n  end Reference;\nend {class};\n"
        )
    }
}

/// Terms of a displacement that are not those of none.
fn pose(pose: &Pose, ending: &str) -> Vec<String> {
    let mut terms = Vec::new();
    if pose.translation.vector != Vector3::zeros() {
        terms.push(format!("r{ending} = {}", vector(&pose.translation.vector)));
    }
    let rotation = pose.rotation.matrix();
    if *rotation != Matrix3::identity() {
        let rows = rotation.row_iter().map(|row| list(&[row[0], row[1], row[2]]));
        let rows: Vec<String> = rows.collect();
        terms.push(format!("R{ending} = {{{}}}", rows.join(", ")));
    }
    terms
}

fn vector(vector: &Vector3<f64>) -> String {
    list(vector.as_slice())
}

fn list(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|&value| number(value)).collect();
    format!("{{{}}}", values.join(", "))
}
