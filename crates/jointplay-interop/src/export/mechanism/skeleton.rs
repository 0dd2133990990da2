//! A mechanism as a tree of bodies with elementary joints, and the closures of its loops.

use std::collections::BTreeSet;

use jointplay_core::mechanism::joint::{Coordinate, Factor};
use jointplay_core::mechanism::{
    Coupling, ElementaryChain, JointCoordinate, JointKind, Kinematics, Mechanism, MechanismSystem,
    VirtualMotion, virtual_weights,
};
use jointplay_core::spatial::Pose;
use nalgebra::DVector;

use super::error::Error;

/// Names of the ground and of the model in MJCF and SDF, which no moving link may have.
const RESERVED: [&str; 2] = ["world", "__model__"];

/// An exported joint of a coupling.
pub(super) struct CoupledJoint<'s> {
    pub(super) name: &'s str,
    /// Its coordinate in the reference configuration (m, rad).
    pub(super) value: f64,
}

/// Bodies, parents before children, and closures.
pub(super) struct Skeleton<'a> {
    pub(super) mechanism: &'a Mechanism,
    pub(super) bodies: Vec<Body>,
    pub(super) closures: Vec<Closure>,
    /// Coordinates of the reference configuration (m, rad).
    pub(super) coordinates: Vec<f64>,
    /// Stiffness of each virtual joint (N/m, N m/rad).
    pub(super) stiffness: Vec<f64>,
    /// Stiffness of a virtual slide where the file states none (N/m).
    default_stiffness: f64,
    /// Size of the mechanism, by which angles are weighed (m).
    pub(super) length: f64,
    /// Joints without virtual joints that close loops as they are, if they are kept whole.
    pub(super) whole_closures: Vec<usize>,
    keeps_closures: bool,
    /// Parts of the mechanism that the tree does not have.
    pub(super) lost: Vec<String>,
}

/// A link, or a part of a joint that closes a loop.
pub(super) struct Body {
    pub(super) name: String,
    /// Index of the link; `None` for a part of a joint.
    pub(super) link: Option<usize>,
    /// Body on which it moves; `None` for the base.
    pub(super) parent: Option<usize>,
    /// Motions against its parent.
    pub(super) chain: ElementaryChain,
    /// A name for each motion.
    pub(super) names: Vec<String>,
    /// The joint of the motions.
    pub(super) joint: Option<usize>,
}

/// A constraint between two bodies that closes a loop.
pub(super) struct Closure {
    pub(super) name: String,
    /// Whether points coincide and rotation is free; otherwise frames coincide.
    pub(super) is_ball: bool,
    pub(super) bodies: [usize; 2],
    /// The frame on each body (m).
    pub(super) frames: [Pose; 2],
}

impl<'a> Skeleton<'a> {
    /// The tree at a closed configuration, which becomes the reference.
    ///
    /// Spherical joints close loops where there is a choice.
    pub(super) fn new(mechanism: &'a Mechanism, coordinates: &DVector<f64>) -> Result<Self, Error> {
        Self::made(mechanism, coordinates, false, DEFAULT_STIFFNESS)
    }

    /// The tree as by [`Skeleton::new`], with another stiffness of virtual slides where the file states none (N/m).
    pub(super) fn with_default_stiffness(
        mechanism: &'a Mechanism,
        coordinates: &DVector<f64>,
        default_stiffness: f64,
    ) -> Result<Self, Error> {
        Self::made(mechanism, coordinates, false, default_stiffness)
    }

    /// The tree as by [`Skeleton::new`], in which joints of all kinds may close loops.
    pub(super) fn with_whole_closures(
        mechanism: &'a Mechanism,
        coordinates: &DVector<f64>,
    ) -> Result<Self, Error> {
        Self::made(mechanism, coordinates, true, DEFAULT_STIFFNESS)
    }

    fn made(
        mechanism: &'a Mechanism,
        coordinates: &DVector<f64>,
        keeps_closures: bool,
        default_stiffness: f64,
    ) -> Result<Self, Error> {
        let moving = &mechanism.links()[1..];
        if let Some(link) = moving.iter().find(|link| RESERVED.contains(&link.as_str())) {
            return Err(Error::ReservedName { link: link.clone() });
        }
        let system = MechanismSystem::new(mechanism, coordinates.clone())?;
        let length = jointplay_core::constraint::System::characteristic_length(&system);
        let mut skeleton = Self {
            mechanism,
            bodies: Vec::new(),
            closures: Vec::new(),
            coordinates: coordinates.iter().copied().collect(),
            stiffness: stiffness(mechanism, &virtual_weights(&system), default_stiffness),
            default_stiffness,
            length,
            whole_closures: Vec::new(),
            keeps_closures,
            lost: lost(mechanism, default_stiffness),
        };
        skeleton.build(&Kinematics::new(mechanism));
        Ok(skeleton)
    }

    fn build(&mut self, kinematics: &Kinematics<'_>) {
        let mechanism = self.mechanism;
        let joints = mechanism.joints();
        let cost = |joint: usize| {
            usize::from(joints[joint].kind == JointKind::Spherical && !joints[joint].actuated)
        };
        let mut body_of_link = vec![0; mechanism.links().len()];
        let rigid = || ElementaryChain { motions: Vec::new(), end: Pose::identity() };
        let base = mechanism.links()[0].clone();
        self.push(base, Some(0), None, (None, rigid()));
        let mut in_tree = vec![false; joints.len()];
        for (joint, against) in mechanism.spanning_tree(cost) {
            in_tree[joint] = true;
            let [from, to] = match against {
                false => joints[joint].links,
                true => [joints[joint].links[1], joints[joint].links[0]],
            };
            let chain = kinematics.elementary_chain(joint);
            let chain = if against { chain.inverse() } else { chain };
            let name = mechanism.links()[to].clone();
            let parent = Some(body_of_link[from]);
            body_of_link[to] = self.push(name, Some(to), parent, (Some(joint), chain));
        }
        for (j, joint) in joints.iter().enumerate().filter(|(j, _)| !in_tree[*j]) {
            let is_rigid = mechanism.virtual_joints().iter().all(|one| one.joint != j);
            if self.keeps_closures && is_rigid {
                self.whole_closures.push(j);
                continue;
            }
            let chain = kinematics.elementary_chain(j);
            let bodies = joint.links.map(|link| body_of_link[link]);
            self.close(j, chain, bodies);
        }
    }

    /// Closes a loop by a joint whose motions, except those of a ball, move bodies of their own.
    fn close(&mut self, joint: usize, chain: ElementaryChain, bodies: [usize; 2]) {
        let name = self.mechanism.joints()[joint].name.clone();
        let ball = chain.motions.iter().position(|one| matches!(one.factor, Factor::Ball));
        let described = &self.mechanism.joints()[joint];
        if ball.is_some() && described.actuated {
            self.lost.push(format!("actuator of {name:?}: it is a ball that closes a loop"));
        }
        if ball.is_some() && !described.limits.is_empty() {
            self.lost.push(format!("limits of {name:?}: it is a ball that closes a loop"));
        }
        let part = |motions: &[_], end: Pose| ElementaryChain { motions: motions.to_vec(), end };
        let (is_ball, sides) = match ball {
            None => {
                let end = chain.end;
                let ends = [Pose::identity(), end.inverse()];
                (
                    false,
                    [
                        (part(&chain.motions, Pose::identity()), ends[0]),
                        (part(&[], Pose::identity()), ends[1]),
                    ],
                )
            }
            Some(k) => {
                let center = chain.motions[k].before;
                let first = part(&chain.motions[..k], Pose::identity());
                let second = part(&chain.motions[k + 1..], chain.end).inverse();
                // Both frames coincide at the reference, so that the ball is at zero there.
                let on_second =
                    second.end * chain.motions[k].transform(&self.coordinates).inverse();
                let second = ElementaryChain { end: Pose::identity(), ..second };
                (true, [(first, center), (second, on_second)])
            }
        };
        let mut ends = bodies;
        let mut frames = [Pose::identity(); 2];
        for (side, (chain, frame)) in sides.into_iter().enumerate() {
            frames[side] = frame;
            if !chain.motions.is_empty() {
                let parent = Some(bodies[side]);
                let on = self.bodies[bodies[side]].name.clone();
                let part = self.fresh(format!("{name} on {on}"));
                ends[side] = self.push(part, None, parent, (Some(joint), chain));
            }
        }
        let has_joint =
            matches!(self.mechanism.joints()[joint].kind, JointKind::Spherical | JointKind::Fixed);
        let name = if has_joint { name } else { self.fresh(format!("{name} closed")) };
        self.closures.push(Closure { name, is_ball, bodies: ends, frames });
    }

    fn push(
        &mut self,
        name: String,
        link: Option<usize>,
        parent: Option<usize>,
        (joint, chain): (Option<usize>, ElementaryChain),
    ) -> usize {
        let names = chain.motions.iter().map(|one| self.motion_name(one.coordinate)).collect();
        self.bodies.push(Body { name, link, parent, chain, names, joint });
        self.bodies.len() - 1
    }

    /// The name of a coordinate: that of its joint, with an index if the joint has several motions; a name that mechanism files allow, so that it is kept by importers.
    pub(super) fn motion_name(&self, coordinate: usize) -> String {
        let mechanism = self.mechanism;
        let mut first = 0;
        for joint in mechanism.joints() {
            let count = joint.kind.freedoms();
            if coordinate < first + count {
                return match joint.kind.factors().len() {
                    1 => joint.name.clone(),
                    _ => self.free_name(format!("{}({})", joint.name, coordinate - first)),
                };
            }
            first += count;
        }
        mechanism.virtual_joints()[coordinate - first].name.clone()
    }

    /// A generated name, with a number if a joint has it.
    fn free_name(&self, name: String) -> String {
        let joints = self.mechanism.joints().iter().map(|joint| &joint.name);
        let taken: Vec<&String> =
            joints.chain(self.mechanism.virtual_joints().iter().map(|one| &one.name)).collect();
        let numbered = (2..).map(|number| format!("{name} ({number})"));
        let mut names = std::iter::once(name.clone()).chain(numbered);
        names.find(|name| !taken.contains(&name)).expect("joints are finitely many")
    }

    /// Index of a coordinate of a joint.
    pub(super) fn coordinate(&self, one: JointCoordinate) -> usize {
        let joints = &self.mechanism.joints()[..one.joint];
        joints.iter().map(|joint| joint.kind.freedoms()).sum::<usize>() + one.freedom
    }

    /// The exported joints of a coupling: the follower, and the others with their ratios.
    ///
    /// # Errors
    /// [`Error::Coupling`] for a coordinate of a joint that is not in the tree.
    pub(super) fn coupled<'s>(
        &'s self,
        coupling: &Coupling,
        format: &'static str,
    ) -> Result<(CoupledJoint<'s>, Vec<(CoupledJoint<'s>, f64)>), Error> {
        let joint = |one: JointCoordinate| {
            let coordinate = self.coordinate(one);
            let motions = |body: &'s Body| body.chain.motions.iter().zip(&body.names);
            let mut all = self.bodies.iter().flat_map(motions);
            let found = all.find(|(motion, _)| motion.coordinate == coordinate);
            let (_, name) = found.ok_or_else(|| Error::Coupling {
                coupling: coupling.name.clone(),
                reason: "a joint of it closes a loop",
                format,
            })?;
            Ok::<_, Error>(CoupledJoint { name, value: self.coordinates[coordinate] })
        };
        let others = coupling.terms.iter().map(|&(one, ratio)| Ok((joint(one)?, ratio)));
        let others = others.collect::<Result<_, Error>>()?;
        Ok((joint(coupling.follower)?, others))
    }

    /// A name that no link and joint has.
    pub(super) fn fresh(&self, name: String) -> String {
        let bodies = self.bodies.iter().map(|body| &body.name);
        let taken: BTreeSet<&String> = names(self.mechanism).chain(bodies).collect();
        unused(name, |name| taken.contains(name))
    }

    /// Index of the virtual joint of a coordinate.
    pub(super) fn virtual_joint(&self, coordinate: usize) -> Option<usize> {
        coordinate.checked_sub(self.mechanism.joint_freedoms())
    }

    /// Least and greatest value of a coordinate, infinite where there is none (m, rad): limits of a joint, or the clearance of a virtual joint.
    pub(super) fn limits(&self, joint: usize, coordinate: usize) -> Option<[f64; 2]> {
        if let Some(m) = self.virtual_joint(coordinate) {
            return self.mechanism.virtual_joints()[m].clearance.map(|most| [-most, most]);
        }
        let first: usize =
            self.mechanism.joints()[..joint].iter().map(|one| one.kind.freedoms()).sum();
        let limits = self.mechanism.joints()[joint].limits.get(coordinate - first).copied();
        limits.filter(|ends| ends.iter().any(|end| end.is_finite()))
    }

    /// Whether a motor drives a coordinate.
    pub(super) fn is_actuated(&self, joint: usize, coordinate: usize) -> bool {
        self.virtual_joint(coordinate).is_none() && self.mechanism.joints()[joint].actuated
    }

    /// Stiffness of the stiffest virtual joint, of turns that of a slide at the size of the mechanism, or what it would be (N/m).
    pub(super) fn stiffest(&self) -> f64 {
        let virtual_joints = self.mechanism.virtual_joints().iter();
        let linear =
            virtual_joints.zip(&self.stiffness).map(|(joint, &stiffness)| match joint.motion {
                VirtualMotion::Slide(_) => stiffness,
                VirtualMotion::Turn { .. } => stiffness / (self.length * self.length),
            });
        linear.reduce(f64::max).unwrap_or(self.default_stiffness)
    }

    /// Whether a coordinate is an angle.
    pub(super) fn is_turn(factor: &Factor) -> bool {
        factor.coordinates() == [Coordinate::Turn]
    }
}

/// Names of the links, joints, virtual joints and frames of a mechanism.
pub(super) fn names(mechanism: &Mechanism) -> impl Iterator<Item = &String> {
    let joints = mechanism.joints().iter().map(|joint| &joint.name);
    let virtual_joints = mechanism.virtual_joints().iter().map(|joint| &joint.name);
    let frames = mechanism.frames().iter().map(|frame| &frame.name);
    mechanism.links().iter().chain(joints).chain(virtual_joints).chain(frames)
}

/// A name, with a number if it is taken.
pub(super) fn unused(name: String, is_taken: impl Fn(&String) -> bool) -> String {
    let numbered = (2..).map(|number| format!("{name} ({number})"));
    let mut names = std::iter::once(name.clone()).chain(numbered);
    names.find(|name| !is_taken(name)).expect("names are finitely many")
}

/// Stiffness of each virtual joint: that of the file where all state it, and otherwise one in the proportions of their weights.
fn stiffness(mechanism: &Mechanism, weights: &DVector<f64>, default: f64) -> Vec<f64> {
    let stated = mechanism.virtual_joints().iter().all(|one| one.stiffness.is_some());
    let factor = if stated { 1.0 } else { default };
    weights.iter().map(|weight| factor * weight).collect()
}

/// Stiffness of a virtual slide where the file states none (N/m).
pub(super) const DEFAULT_STIFFNESS: f64 = 1e4;

/// Properties that no format of simulators keeps.
fn lost(mechanism: &Mechanism, default_stiffness: f64) -> Vec<String> {
    let mut lost = Vec::new();
    let count = |is: fn(&jointplay_core::mechanism::Joint) -> bool| {
        mechanism.joints().iter().filter(|joint| is(joint)).count()
    };
    let clearances = count(|joint| joint.clearance.linear.or(joint.clearance.angular).is_some());
    if clearances > 0 {
        lost.push(format!(
            "{clearances} × clearance of a joint; that of virtual joints is kept as limits"
        ));
    }
    let stiff = count(|joint| joint.stiffness.linear.or(joint.stiffness.angular).is_some());
    if stiff > 0 {
        lost.push(format!("{stiff} × stiffness of a joint; that of virtual joints is kept"));
    }
    if mechanism.characteristic_length().is_some() {
        lost.push("characteristic length".to_owned());
    }
    let stated = mechanism.virtual_joints().iter().all(|one| one.stiffness.is_some());
    if !stated {
        lost.push(format!(
            "virtual joints without a stiffness in the file have one of {default_stiffness} N/m, or the same for an angle times the squared characteristic length in N m/rad"
        ));
    }
    lost
}
