//! Places and directions at which a mechanism could have virtual joints.

use nalgebra::{DMatrix, DVector, Unit, Vector3};

use super::symmetry::{Symmetry, parallel};
use super::{Carrier, Joint, JointKind, MechanismSystem, VirtualJoint, VirtualMotion};
use crate::Error;
use crate::linalg::svd;
use crate::spatial::Pose;

/// Places that differ by no more than this are the same, in characteristic lengths.
const SAME: f64 = 1e-6;
/// Directions of slides of one leg that differ by no more than this are the same, and are orthogonal up to it (rad).
pub(super) const SAME_DIRECTION: f64 = 0.05;

/// A place and direction at which a mechanism could have play.
#[derive(Clone)]
pub(super) struct Candidate {
    /// The virtual joint.
    pub(super) joint: VirtualJoint,
    /// Others in the same leg that relieve the same motion.
    pub(super) alternatives: Vec<VirtualJoint>,
    pub(super) leg: usize,
}

/// Candidate in the base frame.
pub(super) struct Seen {
    pub(super) direction: Vector3<f64>,
    pub(super) slides: bool,
    /// A point of the axis (m).
    point: Vector3<f64>,
    joint: usize,
    pub(super) link: usize,
}

pub(super) fn seen(system: &MechanismSystem<'_>, links: &[Pose], one: &VirtualJoint) -> Seen {
    let mechanism = system.kinematics().mechanism();
    let VirtualJoint { joint, carrier, motion, .. } = one;
    let side = usize::from(*carrier == Carrier::Second);
    let link = mechanism.joints()[*joint].links[side];
    let (direction, slides, point) = match motion {
        VirtualMotion::Slide(direction) => {
            (direction, true, mechanism.joints()[*joint].frames[side].translation.vector)
        }
        VirtualMotion::Turn { axis, point } => (axis, false, *point),
    };
    Seen {
        direction: links[link].rotation * direction.into_inner(),
        slides,
        point: links[link] * nalgebra::Point3::from(point) - nalgebra::Point3::origin(),
        joint: *joint,
        link,
    }
}

/// For each joint its leg: joints in series, with links between that have no third joint.
pub(super) fn legs(mechanism: &super::Mechanism) -> Vec<usize> {
    let joints = mechanism.joints();
    let mut leg: Vec<usize> = (0..joints.len()).collect();
    for link in 0..mechanism.links().len() {
        let on: Vec<usize> =
            (0..joints.len()).filter(|&j| joints[j].links.contains(&link)).collect();
        if let [a, b] = on[..] {
            let (from, to) = (leg[a].max(leg[b]), leg[a].min(leg[b]));
            leg.iter_mut().filter(|one| **one == from).for_each(|one| *one = to);
        }
    }
    leg
}

/// The link of a joint that carries its virtual joints: the one with more joints, the second if both have the same number.
pub(super) fn carrier(mechanism: &super::Mechanism, joint: usize) -> usize {
    let count =
        |link: usize| mechanism.joints().iter().filter(|other| other.links.contains(&link)).count();
    let [first, second] = mechanism.joints()[joint].links.map(count);
    usize::from(second >= first)
}

/// A virtual joint of a joint along or about a direction in the frame of its carrier.
pub(super) fn along(
    mechanism: &super::Mechanism,
    joint: usize,
    label: &str,
    direction: Unit<Vector3<f64>>,
    slides: bool,
) -> VirtualJoint {
    let side = carrier(mechanism, joint);
    let Joint { name, links, frames, clearance, .. } = &mechanism.joints()[joint];
    let point = frames[side].translation.vector;
    let what = if slides { "slide" } else { "turn" };
    let mut name = format!("{label} {what} of {} at {name}", mechanism.links()[links[side]]);
    while mechanism.joint(&name).is_some() {
        name.push('\'');
    }
    VirtualJoint {
        name,
        joint,
        carrier: if side == 0 { Carrier::First } else { Carrier::Second },
        motion: if slides {
            VirtualMotion::Slide(direction)
        } else {
            VirtualMotion::Turn { axis: direction, point }
        },
        clearance: if slides { clearance.linear } else { clearance.angular },
        stiffness: None,
    }
}

/// The slides and turns that the joints lack: radial, tangential and normal on the link that carries more joints.
pub(super) fn lacking(system: &MechanismSystem<'_>) -> Result<Vec<VirtualJoint>, Error> {
    let mechanism = system.kinematics().mechanism();
    let unit = crate::constraint::System::characteristic_length(system);
    let on_link = |link: usize| {
        mechanism.joints().iter().flat_map(move |joint| {
            [0, 1].into_iter().filter(move |&s| joint.links[s] == link).map(|s| &joint.frames[s])
        })
    };
    let mut found = Vec::new();
    for (j, joint) in mechanism.joints().iter().enumerate() {
        let side = carrier(mechanism, j);
        let places: Vec<Vector3<f64>> =
            on_link(joint.links[side]).map(|frame| frame.translation.vector).collect();
        let triad = triad(&places, &joint.frames[side], unit);
        for (label, direction) in ["radial", "tangential", "normal"].into_iter().zip(triad) {
            for slides in [true, false] {
                if !already_free(joint.kind, &joint.frames[side], direction, slides)? {
                    found.push(along(mechanism, j, label, direction, slides));
                }
            }
        }
    }
    Ok(found)
}

/// Candidates that relieve the same motion of one leg become one: the one at the joint with the most freedoms, and its alternatives.
///
/// A slide displaces all that follows it in its leg, wherever it is; so do turns about one line.
pub(super) fn merged(
    system: &MechanismSystem<'_>,
    all: Vec<VirtualJoint>,
    links: &[Pose],
) -> Vec<Candidate> {
    let mechanism = system.kinematics().mechanism();
    let unit = crate::constraint::System::characteristic_length(system);
    let legs = legs(mechanism);
    let same = |a: &VirtualJoint, b: &VirtualJoint| {
        let one_leg = legs[a.joint] == legs[b.joint];
        let (a, b) = (seen(system, links, a), seen(system, links, b));
        let one_line = (a.point - b.point).cross(&a.direction).norm() <= SAME * unit;
        one_leg
            && a.slides == b.slides
            && a.direction.cross(&b.direction).norm() <= SAME_DIRECTION
            && (a.slides || one_line)
    };
    let mut order: Vec<usize> = (0..all.len()).collect();
    let freedoms = |k: &usize| mechanism.joints()[all[*k].joint].kind.freedoms();
    order.sort_by_key(|k| (std::cmp::Reverse(freedoms(k)), *k));
    let mut found: Vec<Candidate> = Vec::new();
    for k in order {
        match found.iter_mut().find(|known| same(&known.joint, &all[k])) {
            Some(known) if known.joint.joint == all[k].joint => {}
            Some(known) => known.alternatives.push(all[k].clone()),
            None => found.push(Candidate {
                leg: legs[all[k].joint],
                joint: all[k].clone(),
                alternatives: Vec::new(),
            }),
        }
    }
    found
}

/// Gives candidates the stiffness of their joints, and places each at the joint of its leg where it has the least.
///
/// # Arguments
/// * `default` – stiffness of joints that have none (N/m, N m/rad)
///
/// # Errors
/// [`Error::NoStiffness`]
pub(super) fn stiffen(
    mechanism: &super::Mechanism,
    candidates: &mut [Candidate],
    default: super::LinearAndAngular,
) -> Result<(), Error> {
    let of_joint = |one: &VirtualJoint| {
        let Joint { name, stiffness, .. } = &mechanism.joints()[one.joint];
        let (own, other, direction, unit) = match one.motion {
            VirtualMotion::Slide(_) => (stiffness.linear, default.linear, "linear", "N/m"),
            VirtualMotion::Turn { .. } => {
                (stiffness.angular, default.angular, "angular", "N m/rad")
            }
        };
        own.or(other).ok_or_else(|| Error::NoStiffness { joint: name.clone(), direction, unit })
    };
    for Candidate { joint, alternatives, .. } in candidates {
        let mut least = of_joint(joint)?;
        joint.stiffness = Some(least);
        for other in alternatives {
            let stiffness = of_joint(other)?;
            other.stiffness = Some(stiffness);
            if stiffness < least {
                least = stiffness;
                std::mem::swap(joint, other);
            }
        }
    }
    Ok(())
}

/// (candidates, candidates) whether two may be in one set: slides of one leg have to be orthogonal.
///
/// A slide displaces everything that follows it in its leg, so that the displacement d of the leg is the sum of its slides.
/// For orthogonal slides Σ x² = |d|². Two slides along one direction would have √(x² + x²) = |d|/√2 for the same displacement.
pub(super) fn compatible(
    system: &MechanismSystem<'_>,
    all: &[Candidate],
    links: &[Pose],
) -> Vec<Vec<bool>> {
    let fits = |a: &Candidate, b: &Candidate| {
        let one_leg = a.leg == b.leg;
        let (a, b) = (seen(system, links, &a.joint), seen(system, links, &b.joint));
        let orthogonal = a.direction.dot(&b.direction).abs() <= SAME_DIRECTION;
        !one_leg || !a.slides || !b.slides || orthogonal
    };
    all.iter().map(|a| all.iter().map(|b| fits(a, b)).collect()).collect()
}

/// For each symmetry the candidate that each is mapped onto.
pub(super) fn images(
    system: &MechanismSystem<'_>,
    links: &[Pose],
    all: &[Candidate],
    symmetries: &[Symmetry],
) -> Vec<Vec<Option<usize>>> {
    let legs = legs(system.kinematics().mechanism());
    let same = |symmetry: &Symmetry, from: &VirtualJoint, to: &VirtualJoint| {
        let (from, to) = (seen(system, links, from), seen(system, links, to));
        symmetry.joints[from.joint] == to.joint
            && from.slides == to.slides
            && (symmetry.links[from.link] == to.link || from.slides)
            && parallel(&to.direction, &(symmetry.turn * from.direction))
    };
    let image = |symmetry: &Symmetry, from: &Candidate| {
        all.iter().position(|to| {
            legs[symmetry.joints[from.joint.joint]] == to.leg
                && std::iter::once(&to.joint)
                    .chain(&to.alternatives)
                    .any(|to| same(symmetry, &from.joint, to))
        })
    };
    symmetries.iter().map(|symmetry| all.iter().map(|one| image(symmetry, one)).collect()).collect()
}

/// Sets of candidates that symmetries map onto each other; candidates without an image are in none.
pub(super) fn orbits(count: usize, images: &[Vec<Option<usize>>]) -> Vec<Vec<usize>> {
    let mut found: Vec<Vec<usize>> = Vec::new();
    for k in 0..count {
        if found.iter().any(|orbit| orbit.contains(&k)) {
            continue;
        }
        let mut orbit = vec![k];
        let mut next = 0;
        let mut whole = true;
        while next < orbit.len() {
            for image in images {
                match image[orbit[next]] {
                    Some(onto) if orbit.contains(&onto) => {}
                    Some(onto) => orbit.push(onto),
                    None => whole = false,
                }
            }
            next += 1;
        }
        if whole {
            orbit.sort_unstable();
            found.push(orbit);
        }
    }
    found
}

/// Radial, tangential and normal direction at a joint's place on a link.
fn triad(places: &[Vector3<f64>], frame: &Pose, unit: f64) -> [Unit<Vector3<f64>>; 3] {
    #[expect(clippy::cast_precision_loss, reason = "a count of joints")]
    let middle = places.iter().sum::<Vector3<f64>>() / places.len() as f64;
    // The plane of the joints, where they have one; else the joint's axis.
    let area = places
        .iter()
        .flat_map(|a| places.iter().map(move |b| (a - middle).cross(&(b - middle))))
        .max_by(|a, b| a.norm().total_cmp(&b.norm()))
        .unwrap_or_default();
    let axis = frame.rotation * Vector3::z();
    let normal = Unit::try_new(area, 1e-9 * unit * unit).unwrap_or(Unit::new_normalize(axis));
    let arm = frame.translation.vector - middle;
    let arm = arm - normal.scale(arm.dot(&normal));
    let own = frame.rotation * Vector3::x();
    let fallback = own - normal.scale(own.dot(&normal));
    let other = frame.rotation * Vector3::y();
    let last = other - normal.scale(other.dot(&normal));
    let radial = Unit::try_new(arm, 1e-9 * unit)
        .or_else(|| Unit::try_new(fallback, 0.5))
        .unwrap_or_else(|| Unit::new_normalize(last));
    let tangential = Unit::new_normalize(normal.cross(&radial));
    [radial, tangential, normal]
}

/// Whether a joint already has a motion, or a combination of its motions that is this one.
pub(super) fn already_free(
    kind: JointKind,
    frame: &Pose,
    direction: Unit<Vector3<f64>>,
    slides: bool,
) -> Result<bool, Error> {
    let local = frame.rotation.inverse() * direction.into_inner();
    let zero = Vector3::zeros();
    let candidate = if slides { (zero, local) } else { (local, zero) };
    let mut columns: Vec<DVector<f64>> = Vec::new();
    let column = |(angular, linear): (Vector3<f64>, Vector3<f64>)| {
        DVector::from_iterator(6, angular.iter().chain(linear.iter()).copied())
    };
    for factor in kind.factors() {
        columns.extend((0..factor.coordinates().len()).map(|k| column(factor.screw(k))));
    }
    if columns.is_empty() {
        return Ok(false);
    }
    let own = svd(&DMatrix::from_columns(&columns))?;
    let rank = own.rank(1e-9);
    let candidate = column(candidate);
    let within = own.u.columns(0, rank).transpose() * &candidate;
    Ok(within.norm() > 1.0 - 1e-9)
}
