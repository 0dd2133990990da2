//! Kinematics of a mechanism: spanning tree, loops, link poses, screws.

use nalgebra::{DVector, Matrix3, Translation3, Vector3};

use super::attached_frame::FrameId;
use super::ball::BallChange;
use super::description::{Carrier, Mechanism, VirtualMotion};
use super::joint::{Coordinate, Factor, Twist};
use super::tree::{Branch, link_poses, spanning_tree};
use crate::Error;
use crate::constraint::Dimension;
use crate::spatial::Pose;

/// Joints of a mechanism as chains of elementary motions, and the tree and the loops that they form.
///
/// Coordinates are stacked: first those of the joints (f), then those of the virtual joints (M).
#[derive(Debug, Clone)]
pub struct Kinematics<'a> {
    mechanism: &'a Mechanism,
    chains: Vec<Chain>,
    /// Joints in the order in which they reach new links; `true` where walked from the second link to the first.
    tree: Vec<Branch>,
    /// For each link the joint over which it was reached, and whether against its sense.
    reached_by: Vec<Option<Branch>>,
    /// The joint that closes each loop.
    cuts: Vec<usize>,
    /// First coordinate of each joint.
    offsets: Vec<usize>,
    dimensions: Vec<Dimension>,
}

/// A joint from its first link to its second.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    pub(super) elements: Vec<Element>,
    pub(super) end: Pose,
}

/// A fixed displacement, then an elementary motion.
#[derive(Debug, Clone)]
pub(super) struct Element {
    pub(super) before: Pose,
    pub(super) factor: Factor,
    /// First of its coordinates among all.
    pub(super) coordinate: usize,
    /// −1 for what is walked against its sense.
    pub(super) sign: f64,
    /// Of a ball, how displacements change it.
    pub(super) change: BallChange,
}

/// Link poses and joint screws at a configuration.
#[derive(Debug, Clone)]
pub(crate) struct KinematicState {
    /// Pose of each link in the base frame.
    pub(crate) links: Vec<Pose>,
    /// Twist of each coordinate in the base frame, linear part at the reference point.
    pub(crate) screws: Vec<Twist>,
    /// For each loop: D = what its closing joint makes of the second link's pose, against where the tree has that link; identity when closed.
    pub(crate) mismatches: Vec<Pose>,
    /// Rate of change of the twist of each element along the direction asked for, if one was.
    rates: Vec<Vec<Vector3<f64>>>,
}

impl<'a> Kinematics<'a> {
    /// Derives tree, loops and chains.
    ///
    /// The tree is taken breadth first in the order of the joints; results do not depend on it.
    #[must_use]
    pub fn new(mechanism: &'a Mechanism) -> Self {
        let joints = mechanism.joints();
        let tree = spanning_tree(mechanism, |_| 0);
        let mut reached_by = vec![None; mechanism.links().len()];
        let mut in_tree = vec![false; joints.len()];
        for &(j, against) in &tree {
            reached_by[joints[j].links[usize::from(!against)]] = Some((j, against));
            in_tree[j] = true;
        }
        let cuts = (0..joints.len()).filter(|&j| !in_tree[j]).collect();
        let mut kinematics = Self {
            mechanism,
            chains: Vec::with_capacity(joints.len()),
            tree,
            reached_by,
            cuts,
            offsets: Vec::with_capacity(joints.len()),
            dimensions: Vec::new(),
        };
        kinematics.build_chains();
        kinematics
    }

    fn build_chains(&mut self) {
        let mechanism = self.mechanism;
        let freedoms = mechanism.joint_freedoms();
        for (j, joint) in mechanism.joints().iter().enumerate() {
            self.offsets.push(self.dimensions.len());
            let (mut elements, mut before) = (Vec::new(), Pose::identity());
            let mut push = |before: &mut Pose, factor, coordinate, sign| {
                let before = std::mem::replace(before, Pose::identity());
                let change = BallChange::Turned;
                elements.push(Element { before, factor, coordinate, sign, change });
            };
            let on = |carrier| {
                let here = mechanism.virtual_joints().iter().enumerate();
                here.filter(move |(_, v)| v.joint == j && v.carrier == carrier)
            };
            for (m, virtual_joint) in on(Carrier::First) {
                push(&mut before, factor_of(virtual_joint.motion), freedoms + m, 1.0);
            }
            before *= joint.frames[0];
            for factor in joint.kind.factors() {
                push(&mut before, factor, self.dimensions.len(), 1.0);
                self.dimensions.extend(factor.coordinates().iter().map(dimension));
            }
            before *= joint.frames[1].inverse();
            // The second link sees its virtual joints from the far end: last first, and backwards.
            for (m, virtual_joint) in on(Carrier::Second).collect::<Vec<_>>().into_iter().rev() {
                push(&mut before, factor_of(virtual_joint.motion), freedoms + m, -1.0);
            }
            self.chains.push(Chain { elements, end: before });
        }
        self.dimensions.extend(mechanism.virtual_joints().iter().map(|v| match v.motion {
            VirtualMotion::Slide(_) => Dimension::Length,
            VirtualMotion::Turn { .. } => Dimension::Angle,
        }));
    }

    /// The mechanism.
    #[must_use]
    pub fn mechanism(&self) -> &'a Mechanism {
        self.mechanism
    }

    /// Each joint as a chain of elementary motions.
    pub(super) fn chains(&self) -> &[Chain] {
        &self.chains
    }

    /// Indices of a joint's coordinates.
    #[must_use]
    pub fn coordinates_of(&self, joint: usize) -> std::ops::Range<usize> {
        let first = self.offsets[joint];
        first..first + self.mechanism.joints()[joint].kind.freedoms()
    }

    /// Physical dimension of each coordinate: joints, then virtual joints.
    #[must_use]
    pub fn dimensions(&self) -> &[Dimension] {
        &self.dimensions
    }

    /// The joint that closes each loop of the spanning tree.
    #[must_use]
    pub fn closing_joints(&self) -> &[usize] {
        &self.cuts
    }

    /// From here on, balls with commanded coordinates change by their rotation vectors, so that these coordinates keep the values of their commands.
    pub(super) fn command(&mut self, is_free: impl Fn(usize) -> bool) {
        for element in self.chains.iter_mut().flat_map(|chain| &mut chain.elements) {
            let k = element.coordinate;
            if element.factor == Factor::Ball {
                let is_commanded = !(k..k + 3).all(&is_free);
                element.change = if is_commanded { BallChange::Added } else { BallChange::Turned };
            }
        }
    }

    /// How displacements change each ball, and the first of its coordinates.
    pub(super) fn balls(&self) -> impl Iterator<Item = (BallChange, usize)> + '_ {
        let elements = self.chains.iter().flat_map(|chain| &chain.elements);
        let balls = elements.filter(|element| element.factor == Factor::Ball);
        balls.map(|element| (element.change, element.coordinate))
    }

    /// Coordinates after a small displacement: added, but for balls without commands, which turn on by it in their own frame.
    #[must_use]
    pub fn moved(&self, home: &DVector<f64>, by: &DVector<f64>) -> DVector<f64> {
        let mut moved = home + by;
        for (change, k) in self.balls() {
            let [home, by] = [home, by].map(|all| all.fixed_rows::<3>(k).into_owned());
            moved.fixed_rows_mut::<3>(k).copy_from(&change.displaced(&home, &by));
        }
        moved
    }

    /// (f) how joint coordinates differ between two configurations [m, rad]: for a ball without commands the rotation vector from the first to the second, in the turned frame.
    ///
    /// # Arguments
    /// * `from`, `to` – at least the (f) coordinates of the joints (m, rad)
    pub(super) fn displacement(&self, from: &DVector<f64>, to: &DVector<f64>) -> DVector<f64> {
        let f = self.mechanism.joint_freedoms();
        let mut by = to.rows(0, f) - from.rows(0, f);
        for (change, k) in self.balls().filter(|&(_, k)| k < f) {
            let [from, to] = [from, to].map(|all| all.fixed_rows::<3>(k).into_owned());
            by.fixed_rows_mut::<3>(k).copy_from(&change.difference(&from, &to));
        }
        by
    }

    /// Pose of each link in the base frame at some coordinates.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NotFinite`].
    pub fn link_poses(&self, coordinates: &DVector<f64>) -> Result<Vec<Pose>, Error> {
        check_coordinates(coordinates, self.dimensions.len())?;
        let still = DVector::zeros(coordinates.len());
        Ok(self.links(|j| self.chains[j].transform(coordinates, &still)))
    }

    /// Pose of a frame in the base frame, from the poses of the links (m).
    ///
    /// # Arguments
    /// * `base_from_link` – the result of [`Kinematics::link_poses`]
    ///
    /// # Panics
    /// For a frame that the mechanism does not have.
    #[must_use]
    pub fn frame_pose(&self, frame: FrameId, base_from_link: &[Pose]) -> Pose {
        self.mechanism.frame_pose(frame, base_from_link)
    }

    /// Joints of the tree: index, links, and whether walked from the second to the first.
    pub(super) fn branches(&self) -> impl Iterator<Item = (usize, [usize; 2], bool)> + '_ {
        let joints = self.mechanism.joints();
        self.tree.iter().map(|&(j, against)| (j, joints[j].links, against))
    }

    /// Poses of the links for the displacements of the joints of the tree.
    fn links(&self, transform: impl Fn(usize) -> Pose) -> Vec<Pose> {
        let branches = self.branches().map(|(j, links, against)| (links, against, transform(j)));
        link_poses(self.mechanism.links().len(), branches)
    }

    /// Everything at `home` displaced by `by`; with `along`, also the rates that second derivatives need.
    pub(crate) fn placed(
        &self,
        home: &DVector<f64>,
        by: &DVector<f64>,
        reference: &Vector3<f64>,
        along: Option<&DVector<f64>>,
    ) -> KinematicState {
        let transforms: Vec<Pose> =
            self.chains.iter().map(|chain| chain.transform(home, by)).collect();
        let links = self.links(|j| transforms[j]);
        let mut screws = vec![(Vector3::zeros(), Vector3::zeros()); self.dimensions.len()];
        let mut rates = Vec::with_capacity(self.chains.len());
        for j in 0..self.chains.len() {
            let first = links[self.mechanism.joints()[j].links[0]];
            let mut of_joint = Vec::new();
            self.through_elements(j, first, home, by, |element, before, after| {
                element.screws(before, after, [home, by], reference, &mut screws);
                if let Some(along) = along {
                    of_joint.push(element.rate(after, [home, by], along));
                }
            });
            rates.push(of_joint);
        }
        let mismatches = self
            .cuts
            .iter()
            .map(|&j| {
                let [first, second] = self.mechanism.joints()[j].links;
                links[first] * transforms[j] * links[second].inverse()
            })
            .collect();
        KinematicState { links, screws, mismatches, rates }
    }

    /// Evaluates the elementary motions of a joint from the pose of its first link; returns the pose of its second link.
    ///
    /// `see` gets each element with the poses before and behind it.
    pub(super) fn through_elements(
        &self,
        joint: usize,
        first: Pose,
        home: &DVector<f64>,
        by: &DVector<f64>,
        mut see: impl FnMut(&Element, &Pose, &Pose),
    ) -> Pose {
        let chain = &self.chains[joint];
        let mut pose = first;
        for element in &chain.elements {
            pose *= element.before;
            let after = pose * element.transform(home, by);
            see(element, &pose, &after);
            pose = after;
        }
        pose * chain.end
    }

    /// The joints between the base and a link, each with the sense in which it is walked.
    pub(crate) fn path_to(&self, link: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let mut link = link;
        std::iter::from_fn(move || {
            let (j, against) = self.reached_by[link]?;
            link = self.mechanism.joints()[j].links[usize::from(against)];
            Some((j, if against { -1.0 } else { 1.0 }))
        })
    }

    /// Coordinates that a joint's transform depends on, its virtual joints among them.
    pub(crate) fn columns_of(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        self.chains[joint].elements.iter().flat_map(|element| {
            (0..element.factor.coordinates().len()).map(|k| element.coordinate + k)
        })
    }

    /// Twist and its rate of each link, for coordinates that move at `along`; and of each loop's closing joint beyond its first link.
    pub(crate) fn rates(
        &self,
        placed: &KinematicState,
        along: &DVector<f64>,
    ) -> (Vec<TwistAndRate>, Vec<TwistAndRate>) {
        let through = |j: usize, from: &TwistAndRate| {
            self.through(&placed.screws, &placed.rates[j], j, along, from)
        };
        let still = (Vector3::zeros(), Vector3::zeros());
        let mut links =
            vec![TwistAndRate { velocity: still, acceleration: still }; placed.links.len()];
        for &(j, against) in &self.tree {
            let [first, second] = self.mechanism.joints()[j].links;
            if against {
                let own = self.velocity_of(placed, j, along);
                let velocity = minus(&links[second].velocity, &own);
                let beyond = through(j, &TwistAndRate { velocity, acceleration: still });
                let acceleration = minus(&links[second].acceleration, &beyond.acceleration);
                links[first] = TwistAndRate { velocity, acceleration };
            } else {
                links[second] = through(j, &links[first]);
            }
        }
        let closing =
            self.cuts.iter().map(|&j| through(j, &links[self.mechanism.joints()[j].links[0]]));
        let closing = closing.collect();
        (links, closing)
    }

    fn velocity_of(&self, placed: &KinematicState, joint: usize, along: &DVector<f64>) -> Twist {
        self.columns_of(joint).fold((Vector3::zeros(), Vector3::zeros()), |sum, k| {
            plus(&sum, &scaled(&placed.screws[k], along[k]))
        })
    }

    /// TwistAndRate of a joint's second link, given that of its first.
    pub(super) fn through(
        &self,
        screws: &[Twist],
        rates: &[Vector3<f64>],
        joint: usize,
        along: &DVector<f64>,
        from: &TwistAndRate,
    ) -> TwistAndRate {
        let mut motion = *from;
        for (element, rate) in self.chains[joint].elements.iter().zip(rates) {
            let own = (0..element.factor.coordinates().len())
                .map(|k| element.coordinate + k)
                .fold((Vector3::zeros(), Vector3::zeros()), |sum, k| {
                    plus(&sum, &scaled(&screws[k], along[k]))
                });
            motion.acceleration = plus(&motion.acceleration, &bracket(&motion.velocity, &own));
            // Only balls have a rate of their own: about a center, which need not be the reference point.
            let center = match own.0.norm_squared() {
                0.0 => Vector3::zeros(),
                square => own.0.cross(&own.1) / square,
            };
            let rate = (*rate, center.cross(rate));
            motion.acceleration = plus(&motion.acceleration, &rate);
            motion.velocity = plus(&motion.velocity, &own);
        }
        motion
    }
}

/// Twist and its rate of change.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TwistAndRate {
    pub(crate) velocity: Twist,
    pub(crate) acceleration: Twist,
}

impl Chain {
    /// Displacement from the first link to the second.
    pub(super) fn transform(&self, home: &DVector<f64>, by: &DVector<f64>) -> Pose {
        let start = Pose::identity();
        self.elements
            .iter()
            .fold(start, |pose, element| pose * element.before * element.transform(home, by))
            * self.end
    }
}

impl Element {
    fn transform(&self, home: &DVector<f64>, by: &DVector<f64>) -> Pose {
        let k = self.coordinate;
        if self.factor == Factor::Ball {
            let [home, by] = self.own([home, by]);
            return Pose::from_parts(Translation3::identity(), self.change.rotation(&home, &by));
        }
        self.factor.transform(&[self.sign * (home[k] + by[k])])
    }

    /// The three coordinates of a ball in vectors of all.
    fn own<const N: usize>(&self, all: [&DVector<f64>; N]) -> [Vector3<f64>; N] {
        all.map(|all| all.fixed_rows::<3>(self.coordinate).into_owned())
    }

    /// Twists of its coordinates in the base frame, at a displacement from home; the linear part at the reference point.
    pub(super) fn screws(
        &self,
        before: &Pose,
        after: &Pose,
        at: [&DVector<f64>; 2],
        reference: &Vector3<f64>,
        screws: &mut [Twist],
    ) {
        let k = self.coordinate;
        for freedom in 0..self.factor.coordinates().len() {
            let (angular, linear) = if self.factor == Factor::Ball {
                let [home, by] = self.own(at);
                let body = self.change.body_rate(&home, &by, &Vector3::ith(freedom, 1.0));
                (after.rotation * body, Vector3::zeros())
            } else {
                let (angular, linear) = self.factor.screw(freedom);
                (before.rotation * angular, before.rotation * linear)
            };
            let arm = reference - before.translation.vector;
            screws[k + freedom] = (angular * self.sign, (linear + angular.cross(&arm)) * self.sign);
        }
    }

    /// Angular rate of change of its own twist at constant coordinate rates: not zero only for a displaced ball.
    fn rate(
        &self,
        after: &Pose,
        [home, by]: [&DVector<f64>; 2],
        along: &DVector<f64>,
    ) -> Vector3<f64> {
        if self.factor != Factor::Ball {
            return Vector3::zeros();
        }
        let [home, by, along] = self.own([home, by, along]);
        after.rotation * self.change.body_acceleration(&home, &by, &along)
    }
}

pub(super) fn factor_of(motion: VirtualMotion) -> Factor {
    match motion {
        VirtualMotion::Slide(axis) => Factor::Slide { axis },
        VirtualMotion::Turn { axis, point } => Factor::Turn { axis, point },
    }
}

fn dimension(coordinate: &Coordinate) -> Dimension {
    match coordinate {
        Coordinate::Slide => Dimension::Length,
        Coordinate::Turn => Dimension::Angle,
    }
}

pub(crate) fn plus(a: &Twist, b: &Twist) -> Twist {
    (a.0 + b.0, a.1 + b.1)
}

pub(crate) fn minus(a: &Twist, b: &Twist) -> Twist {
    (a.0 - b.0, a.1 - b.1)
}

pub(crate) fn scaled(a: &Twist, factor: f64) -> Twist {
    (a.0 * factor, a.1 * factor)
}

/// Lie bracket: rate of change of one twist as another moves it.
pub(crate) fn bracket(a: &Twist, b: &Twist) -> Twist {
    (a.0.cross(&b.0), a.0.cross(&b.1) + a.1.cross(&b.0))
}

/// A twist carried by a displacement; both linear parts at `reference`.
pub(crate) fn carried(by: &Pose, twist: &Twist, reference: &Vector3<f64>) -> Twist {
    let angular = by.rotation * twist.0;
    let shifted = by.rotation * reference + by.translation.vector;
    (angular, by.rotation * twist.1 + angular.cross(&(reference - shifted)))
}

/// Whether a coordinate vector has as many numbers as needed, all finite.
pub(super) fn check_coordinates(coordinates: &DVector<f64>, expected: usize) -> Result<(), Error> {
    let what = "the coordinate vector";
    if coordinates.len() != expected {
        return Err(Error::LengthMismatch { what, found: coordinates.len(), expected });
    }
    coordinates.iter().try_for_each(|&value| crate::error::finite(what, value).map(|_| ()))
}

/// The vector of the antisymmetric part: sin θ times the axis for a rotation.
pub(super) fn skew_part(m: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(m[(2, 1)] - m[(1, 2)], m[(0, 2)] - m[(2, 0)], m[(1, 0)] - m[(0, 1)]) * 0.5
}
