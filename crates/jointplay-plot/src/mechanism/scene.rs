//! Links and joints in space, in lengths relative to the size of the mechanism.

use jointplay_core::mechanism::{
    Carrier, ExaggeratedPlay, JointKind, JointWrench, Mechanism, VirtualMotion,
};
use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Vector3};

use crate::Error;

/// Joints closer than this coincide, in sizes.
const TOGETHER: f64 = 1e-3;
/// Directions within this angle are parallel (rad).
const PARALLEL: f64 = 1e-3;
/// Displacement of a prismatic joint away from a coincident joint, in sizes.
const ASIDE: f64 = 0.3;
/// Displacement of a hinge along its axis, away from a coincident joint, in sizes.
const ALONG: f64 = 0.14;
/// Radius of the sphere for the hinges of a spherical mechanism, in sizes.
const SPHERE: f64 = 0.5;
/// Largest radius of a joint, in sizes.
const RADIUS: f64 = 0.024;
/// Half length of a rail, in radii of a joint.
pub(super) const RAIL: f64 = 6.0;
/// Length of the arrow of the largest load, in sizes.
const LONGEST_LOAD: f64 = 0.3;
/// Loads below this share of the largest are not drawn.
const SMALL_LOAD: f64 = 0.02;
/// Number of joints above which they are drawn smaller.
const MANY: f64 = 12.0;

/// Everything that is drawn; lengths are in sizes of the mechanism, relative to its centre.
pub(super) struct Scene {
    pub(super) joints: Vec<DrawnJoint>,
    pub(super) links: Vec<Body>,
    pub(super) play: Vec<Play>,
    /// Exaggerated play, from the end of a link to its joint.
    pub(super) gaps: Vec<[Vector3<f64>; 2]>,
    /// Play scale.
    pub(super) exaggeration: Option<f64>,
    /// Forces and moments of joints.
    pub(super) loads: Vec<Load>,
    /// Centre of the mechanism (m).
    middle: Vector3<f64>,
    /// The length of one size (m).
    pub(super) size: f64,
    /// Radius of a joint.
    pub(super) radius: f64,
}

/// A joint with its drawn position.
pub(super) struct DrawnJoint {
    pub(super) name: String,
    pub(super) kind: JointKind,
    pub(super) actuated: bool,
    /// The connected links.
    links: [usize; 2],
    /// Drawn position.
    pub(super) at: Vector3<f64>,
    /// Position before it was moved away from coincident joints.
    pub(super) origin: Vector3<f64>,
    /// Its frame on the first and on the second link.
    pub(super) frames: [Rotation3<f64>; 2],
    /// Whether it is drawn on a sphere about the intersection of axes.
    pub(super) on_sphere: bool,
    /// Whether it shares a pin with others.
    stacked: bool,
    /// Whether it slides between the two ends of a telescope.
    telescope: bool,
}

/// A link.
pub(super) struct Body {
    pub(super) name: String,
    pub(super) base: bool,
    /// Indices of its joints.
    pub(super) joints: Vec<usize>,
    /// Its end at each joint.
    pub(super) ends: Vec<Vector3<f64>>,
}

/// A force or moment of a joint, on its second link.
pub(super) struct Load {
    /// Tail of the arrow.
    pub(super) from: Vector3<f64>,
    /// Tip of the arrow.
    pub(super) to: Vector3<f64>,
    pub(super) moment: bool,
}

/// A virtual joint.
pub(super) struct Play {
    pub(super) name: String,
    pub(super) at: Vector3<f64>,
    pub(super) axis: Vector3<f64>,
    pub(super) turn: bool,
}

impl DrawnJoint {
    /// Direction of its z axis.
    pub(super) fn axis(&self) -> Vector3<f64> {
        self.frames[0] * Vector3::z()
    }

    /// Whether it is drawn with a rail.
    pub(super) fn has_rail(&self) -> bool {
        matches!(self.kind, JointKind::Prismatic | JointKind::Cylindrical)
    }

    /// The end of a link at this joint: at the end of the rail for the link that carries it, else at the block.
    fn end(&self, on_rail: bool, radius: f64) -> Vector3<f64> {
        if self.stacked {
            return self.origin;
        }
        match self.kind {
            JointKind::Prismatic if on_rail && !self.telescope => {
                self.at - self.axis() * (RAIL * radius)
            }
            _ => self.at,
        }
    }

    /// Whether its z axis is a line of interest.
    pub(super) fn has_axis(&self) -> bool {
        matches!(
            self.kind,
            JointKind::Revolute | JointKind::Helical { .. } | JointKind::Cylindrical
        )
    }
}

impl Body {
    /// The mean of its ends.
    pub(super) fn middle(&self) -> Vector3<f64> {
        #[expect(clippy::cast_precision_loss, reason = "a count of joints")]
        let count = self.ends.len().max(1) as f64;
        self.ends.iter().sum::<Vector3<f64>>() / count
    }
}

impl Scene {
    /// Whether a joint, virtual joint or link has this name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.joints.iter().any(|joint| joint.name == name)
            || self.play.iter().any(|play| play.name == name)
            || self.links.iter().any(|link| link.name == name)
    }

    /// The mechanism with its links at given poses, on the scale of `other` if given.
    pub(super) fn of(
        mechanism: &Mechanism,
        poses: &[Pose],
        other: Option<&Self>,
    ) -> Result<Self, Error> {
        let (mut places, mut low, mut high) =
            (Vec::new(), Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
        for joint in mechanism.joints() {
            let [first, second] = [0, 1].map(|k| poses[joint.links[k]] * joint.frames[k]);
            let at = second.translation.vector;
            if !at.iter().all(|x| x.is_finite()) {
                return Err(Error::Unplaced { joint: joint.name.clone() });
            }
            (low, high) = (low.inf(&at), high.sup(&at));
            places.push((at, [first.rotation, second.rotation]));
        }
        let middle = low * 0.5 + high * 0.5;
        // Half of it first: the whole may be beyond the range of numbers.
        let half = high * 0.5 - low * 0.5;
        let largest = half.amax();
        let point = largest == 0.0;
        let size = match largest {
            0.0 => mechanism.characteristic_length().unwrap_or(1.0),
            _ => (half / largest).norm() * largest * 2.0,
        };
        if !size.is_normal() {
            return Err(Error::Unplaced { joint: mechanism.joints()[0].name.clone() });
        }
        let (middle, size) = other.map_or((middle, size), |other| (other.middle, other.size));
        let mut links: Vec<Body> = Vec::new();
        for (link, name) in mechanism.links().iter().enumerate() {
            let (joints, ends) = (Vec::new(), Vec::new());
            links.push(Body { name: name.clone(), base: link == 0, joints, ends });
        }
        let mut joints = Vec::new();
        for (j, (joint, (at, frames))) in mechanism.joints().iter().zip(places).enumerate() {
            joint.links.iter().for_each(|&link| links[link].joints.push(j));
            let at = (at - middle) / size;
            let (name, kind, actuated) = (joint.name.clone(), joint.kind, joint.actuated);
            let (origin, on_sphere, stacked, telescope) = (at, false, false, false);
            joints.push(DrawnJoint {
                name,
                kind,
                actuated,
                links: joint.links,
                at,
                origin,
                frames,
                on_sphere,
                stacked,
                telescope,
            });
        }
        spread(&mut joints, mechanism, &links, point);
        let play = mechanism
            .virtual_joints()
            .iter()
            .map(|virtual_joint| {
                let joint = &mechanism.joints()[virtual_joint.joint];
                let carrier = match virtual_joint.carrier {
                    Carrier::First => joint.links[0],
                    Carrier::Second => joint.links[1],
                };
                let (axis, turn) = match virtual_joint.motion {
                    VirtualMotion::Slide(axis) => (axis, false),
                    VirtualMotion::Turn { axis, .. } => (axis, true),
                };
                let axis = poses[carrier].rotation * axis.into_inner();
                let at = joints[virtual_joint.joint].at;
                Play { name: virtual_joint.name.clone(), at, axis, turn }
            })
            .collect();
        let radius = radius(&joints);
        for (link, body) in links.iter_mut().enumerate() {
            body.ends = (body.joints.iter())
                .map(|&j| joints[j].end(carries_rail(mechanism, j) == link, radius))
                .collect();
        }
        let (gaps, exaggeration, loads) = (Vec::new(), None, Vec::new());
        Ok(Self { joints, links, play, gaps, exaggeration, loads, middle, size, radius })
    }

    /// Adds loads of joints as arrows.
    ///
    /// Small parts of a load, such as moments that only balance round-off, are omitted.
    pub(super) fn load(&mut self, loads: &[JointWrench]) {
        let norms = |load: &JointWrench| [load.force.norm(), load.moment_at_place.norm()];
        let largest = loads.iter().flat_map(norms).fold(f64::MIN_POSITIVE, f64::max);
        for load in loads {
            for (vector, moment) in [(load.force, false), (load.moment_at_place, true)] {
                let by = vector * (LONGEST_LOAD / largest);
                if let Some(joint) = self.joints.get(load.joint)
                    && by.norm() > SMALL_LOAD * LONGEST_LOAD
                {
                    self.loads.push(Load { from: joint.at, to: joint.at + by, moment });
                }
            }
        }
    }

    /// Moves the ends of links away from their joints by the exaggerated play.
    pub(super) fn exaggerate(&mut self, shown: &ExaggeratedPlay) {
        self.exaggeration = Some(shown.factor);
        for (link, body) in self.links.iter_mut().enumerate() {
            for (&j, end) in body.joints.iter().zip(&mut body.ends) {
                let side = usize::from(self.joints[j].links[1] == link);
                let [seat, joint] =
                    [&shown.seats, &shown.joints].map(|poses| poses[j][side].translation.vector);
                let apart = (seat - joint) / self.size;
                if apart.norm() > TOGETHER {
                    let met = *end;
                    *end += apart;
                    self.gaps.push([*end, met]);
                }
            }
        }
    }
}

/// The link on which the rail of a slide lies: the base, or else the first.
fn carries_rail(mechanism: &Mechanism, joint: usize) -> usize {
    let [first, second] = mechanism.joints()[joint].links;
    if second == 0 { second } else { first }
}

/// Radius of joints that leaves room between them.
fn radius(joints: &[DrawnJoint]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a count of joints")]
    let crowd = (MANY / joints.len() as f64).sqrt().clamp(0.4, 1.0);
    let mut nearest = f64::MAX;
    for (i, a) in joints.iter().enumerate() {
        for b in &joints[i + 1..] {
            let apart = (a.at - b.at).norm();
            if apart > TOGETHER {
                nearest = nearest.min(apart);
            }
        }
    }
    (RADIUS * crowd).min(0.3 * nearest).max(0.3 * RADIUS)
}

/// Moves coincident joints apart along their axes.
fn spread(joints: &mut [DrawnJoint], mechanism: &Mechanism, links: &[Body], point: bool) {
    telescopes(joints, mechanism, links);
    let mut done = vec![false; joints.len()];
    for first in 0..joints.len() {
        if done[first] {
            continue;
        }
        let here = joints[first].at;
        let group: Vec<usize> = (first..joints.len())
            .filter(|&j| !done[j] && (joints[j].at - here).norm() < TOGETHER)
            .collect();
        group.iter().for_each(|&j| done[j] = true);
        if group.len() > 1 {
            part(joints, &group, point);
        }
    }
}

/// Centres the prismatic joint of a telescope between its ends.
fn telescopes(joints: &mut [DrawnJoint], mechanism: &Mechanism, links: &[Body]) {
    for (j, joint) in mechanism.joints().iter().enumerate() {
        if !matches!(joint.kind, JointKind::Prismatic) {
            continue;
        }
        let other = |link: usize| match links[link].joints[..] {
            [a, b] if link != 0 => Some(joints[if a == j { b } else { a }].at),
            _ => None,
        };
        if let (Some(a), Some(b)) = (other(joint.links[0]), other(joint.links[1])) {
            let (here, axis) = (joints[j].at, joints[j].axis());
            joints[j].at = here + axis * ((a + b) * 0.5 - here).dot(&axis);
            joints[j].telescope = true;
        }
    }
}

/// Separates joints at one position.
fn part(joints: &mut [DrawnJoint], group: &[usize], point: bool) {
    let parallel = |a: &DrawnJoint, b: &DrawnJoint| a.axis().cross(&b.axis()).norm() < PARALLEL;
    let hinges: Vec<usize> = group.iter().copied().filter(|&j| joints[j].has_axis()).collect();
    // A prismatic joint is moved, unless a hinge crosses it: that is a pin in a block.
    for &j in group {
        if joints[j].kind == JointKind::Prismatic {
            let across = |k: &usize| joints[*k].axis().dot(&joints[j].axis()).abs() < PARALLEL;
            let pinned = group.len() == 2
                && group.iter().any(|k| *k != j && joints[*k].has_axis() && across(k));
            if !pinned {
                let axis = joints[j].axis();
                // Away from the centre, in the same sense for all joints of one direction.
                let sign = if height(joints, &axis) > TOGETHER { 1.0 } else { -1.0 };
                joints[j].at += axis * (sign * ASIDE);
            }
        }
    }
    if hinges.is_empty() || (hinges.len() == 1 && group.len() == 2 && !others_stay(joints, group)) {
        return;
    }
    let same = hinges.iter().all(|&j| parallel(&joints[j], &joints[hinges[0]]));
    if same && hinges.len() > 1 {
        // Hinges on one axis are stacked; links end at the pin's middle.
        let axis = joints[hinges[0]].axis();
        #[expect(clippy::cast_precision_loss, reason = "a count of joints")]
        for (place, &j) in hinges.iter().enumerate() {
            let shift = place as f64 - 0.5 * (hinges.len() - 1) as f64;
            joints[j].at += axis * (shift * 2.6 * RADIUS);
            joints[j].stacked = true;
        }
        return;
    }
    let along = if point { SPHERE } else { ALONG };
    for j in hinges {
        let axis = joints[j].axis();
        joints[j].at += axis * along;
        joints[j].on_sphere = true;
    }
}

/// Mean position along an axis of the prismatic joints parallel to it.
fn height(joints: &[DrawnJoint], axis: &Vector3<f64>) -> f64 {
    let along = |joint: &&DrawnJoint| {
        joint.kind == JointKind::Prismatic && joint.axis().dot(axis) > 1.0 - PARALLEL
    };
    let heights: Vec<f64> = joints.iter().filter(along).map(|joint| joint.at.dot(axis)).collect();
    #[expect(clippy::cast_precision_loss, reason = "a count of joints")]
    let count = heights.len().max(1) as f64;
    heights.iter().sum::<f64>() / count
}

/// Whether the group contains a joint that cannot be moved.
fn others_stay(joints: &[DrawnJoint], group: &[usize]) -> bool {
    group.iter().any(|&j| {
        matches!(
            joints[j].kind,
            JointKind::Spherical | JointKind::Universal | JointKind::Planar | JointKind::Floating
        )
    })
}
