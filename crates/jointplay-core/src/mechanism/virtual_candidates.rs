//! Places and directions at which a mechanism could have virtual joints.

use nalgebra::{DMatrix, DVector, Unit, Vector3};

use super::symmetry::{Symmetry, parallel, symmetries};
use super::{Carrier, JointKind, MechanismSystem, VirtualJoint, VirtualMotion};
use crate::Error;
use crate::linalg::svd;
use crate::spatial::Pose;

/// Places and directions, and how the symmetries of the mechanism map them.
pub(super) struct Candidates {
    pub(super) candidates: Vec<Candidate>,
    /// For each symmetry, the candidate that each is mapped onto.
    pub(super) images: Vec<Vec<Option<usize>>>,
}

/// A place and direction, and which others symmetries map it onto.
pub(super) struct Candidate {
    pub(super) joint: VirtualJoint,
    pub(super) orbit: usize,
}

/// The slides and turns that the joints lack.
pub(super) fn candidates(
    system: &MechanismSystem<'_>,
    home: &DVector<f64>,
) -> Result<Candidates, Error> {
    let mechanism = system.kinematics().mechanism();
    let unit = crate::constraint::System::characteristic_length(system);
    let on_link = |link: usize| {
        mechanism.joints().iter().flat_map(move |joint| {
            [0, 1].into_iter().filter(move |&s| joint.links[s] == link).map(|s| &joint.frames[s])
        })
    };
    let mut found: Vec<Candidate> = Vec::new();
    for (j, joint) in mechanism.joints().iter().enumerate() {
        let counts = joint.links.map(|link| on_link(link).count());
        let side = usize::from(counts[1] >= counts[0]);
        let carrier = if side == 0 { Carrier::First } else { Carrier::Second };
        let link = joint.links[side];
        let places: Vec<Vector3<f64>> =
            on_link(link).map(|frame| frame.translation.vector).collect();
        let triad = triad(&places, &joint.frames[side], unit);
        for (label, direction) in ["radial", "tangential", "normal"].into_iter().zip(triad) {
            for slides in [true, false] {
                let point = joint.frames[side].translation.vector;
                let motion = if slides {
                    VirtualMotion::Slide(direction)
                } else {
                    VirtualMotion::Turn { axis: direction, point }
                };
                if already_free(joint.kind, &joint.frames[side], direction, slides)? {
                    continue;
                }
                let what = if slides { "slide" } else { "turn" };
                let name =
                    format!("{label} {what} of {} at {}", mechanism.links()[link], joint.name);
                found.push(Candidate {
                    orbit: found.len(),
                    joint: VirtualJoint {
                        name,
                        joint: j,
                        carrier,
                        motion,
                        clearance: if slides {
                            joint.clearance.linear
                        } else {
                            joint.clearance.angular
                        },
                        stiffness: None,
                    },
                });
            }
        }
    }
    let mut images = Vec::new();
    for symmetry in symmetries(system, home)? {
        images.push(candidate_images(system, home, &found, &symmetry)?);
    }
    // Candidates that are mapped onto each other get the least number among them.
    let mut changed = true;
    while changed {
        changed = false;
        for image in &images {
            for (k, onto) in image.iter().enumerate().filter_map(|(k, onto)| Some((k, (*onto)?))) {
                let least = found[k].orbit.min(found[onto].orbit);
                changed |= found[k].orbit != least || found[onto].orbit != least;
                (found[k].orbit, found[onto].orbit) = (least, least);
            }
        }
    }
    Ok(Candidates { candidates: found, images })
}

/// The candidate that a symmetry maps each onto.
fn candidate_images(
    system: &MechanismSystem<'_>,
    home: &DVector<f64>,
    candidates: &[Candidate],
    symmetry: &Symmetry,
) -> Result<Vec<Option<usize>>, Error> {
    let mechanism = system.kinematics().mechanism();
    let links = system.kinematics().link_poses(home)?;
    let seen = |candidate: &Candidate| {
        let VirtualJoint { joint, carrier, motion, .. } = &candidate.joint;
        let link = mechanism.joints()[*joint].links[usize::from(*carrier == Carrier::Second)];
        let (direction, slides) = match motion {
            VirtualMotion::Slide(direction) => (direction, true),
            VirtualMotion::Turn { axis, .. } => (axis, false),
        };
        (*joint, link, links[link].rotation * direction.into_inner(), slides)
    };
    let image = |candidate: &Candidate| {
        let (joint, link, direction, slides) = seen(candidate);
        let direction = symmetry.turn * direction;
        candidates.iter().position(|other| {
            let other = seen(other);
            (other.0, other.1, other.3) == (symmetry.joints[joint], symmetry.links[link], slides)
                && parallel(&other.2, &direction)
        })
    };
    Ok(candidates.iter().map(image).collect())
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
fn already_free(
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
