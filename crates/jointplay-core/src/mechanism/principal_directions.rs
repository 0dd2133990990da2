//! Directions in which commands ask for play.

use nalgebra::{DMatrix, DVector, Unit, Vector3};

use super::virtual_candidates::{
    Candidate, SAME_DIRECTION, Seen, along, already_free, carrier, legs, seen,
};
use super::{Joint, MechanismSystem, VirtualJoint, VirtualMotion};
use crate::Error;
use crate::constraint::System;
use crate::linalg::svd;
use crate::spatial::Pose;

/// Principal displacements below this share of the largest, in the metric, are no candidates.
const SMALL: f64 = 1e-3;
/// Principal displacements whose sizes are closer than this share have no directions of their own.
const EQUAL: f64 = 0.05;

/// Principal directions of the displacements that commands ask for, as candidates.
///
/// The least displacement with all candidates gives a displacement of each leg, the sum of its slides, and a rotation at each joint, the sum of its turns.
/// Their principal directions over the commands are the left singular vectors of the matrix with a column for each command.
/// Directions of a candidate that is there already are omitted, and so are those that are not unique.
///
/// # Arguments
/// * `all` – candidates, merged
/// * `displacements` – least displacement of all candidates for each command (m, rad)
pub(super) fn principal(
    system: &MechanismSystem<'_>,
    all: &[Candidate],
    links: &[Pose],
    displacements: &[DVector<f64>],
) -> Result<Vec<Candidate>, Error> {
    let unit = system.characteristic_length();
    let directions: Vec<Seen> = all.iter().map(|one| seen(system, links, &one.joint)).collect();
    // Slides of a leg, and turns of a joint, at the first candidate of each.
    let group = |k: usize| {
        let slides = directions[k].slides;
        (slides, if slides { all[k].leg } else { all[k].joint.joint })
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for k in 0..all.len() {
        match groups.iter_mut().find(|members| group(members[0]) == group(k)) {
            Some(members) => members.push(k),
            None => groups.push(vec![k]),
        }
    }
    let mut found: Vec<(usize, Vector3<f64>, f64)> = Vec::new();
    for members in &groups {
        let scale = if directions[members[0]].slides { 1.0 } else { unit };
        let columns: Vec<DVector<f64>> = displacements
            .iter()
            .map(|x| {
                let sum: Vector3<f64> =
                    members.iter().map(|&k| directions[k].direction * (x[k] * scale)).sum();
                DVector::from_column_slice(sum.as_slice())
            })
            .collect();
        let parts = svd(&DMatrix::from_columns(&columns))?;
        let sizes = &parts.singular_values;
        for n in 0..sizes.len() {
            let unique = [n.checked_sub(1), Some(n + 1)].into_iter().flatten().all(|other| {
                sizes.get(other).is_none_or(|size| (size - sizes[n]).abs() > EQUAL * sizes[n])
            });
            let direction: Vector3<f64> = parts.u.fixed_view::<3, 1>(0, n).into_owned();
            let known = members
                .iter()
                .any(|&k| directions[k].direction.cross(&direction).norm() <= SAME_DIRECTION);
            if unique && !known {
                found.push((members[0], direction, sizes[n]));
            }
        }
    }
    let asked = |k: usize| {
        let scale = if directions[k].slides { 1.0 } else { unit };
        displacements.iter().fold(0.0_f64, |most, x| most.max(x[k].abs() * scale))
    };
    let largest = (0..all.len()).map(asked).fold(0.0, f64::max);
    let mechanism = system.kinematics().mechanism();
    let legs = legs(mechanism);
    let mut labels: Vec<(usize, usize)> = Vec::new();
    let mut candidates = Vec::new();
    for (k, direction, _) in found.into_iter().filter(|(.., size)| *size > SMALL * largest) {
        let count = labels.iter().filter(|label| label.0 == k).count();
        let label = ["principal", "second principal", "third principal"][count.min(2)];
        let slides = directions[k].slides;
        let of_joint = |j: usize| -> Result<Option<VirtualJoint>, Error> {
            let side = carrier(mechanism, j);
            let Joint { links: sides, frames, kind, .. } = &mechanism.joints()[j];
            let local = Unit::new_normalize(links[sides[side]].rotation.inverse() * direction);
            let free = already_free(*kind, &frames[side], local, slides)?;
            Ok((!free).then(|| along(mechanism, j, label, local, slides)))
        };
        let at = all[k].joint.joint;
        let Some(joint) = of_joint(at)? else { continue };
        labels.push((k, count));
        // Slides displace a leg wherever they are.
        let others = (0..legs.len()).filter(|&j| slides && j != at && legs[j] == legs[at]);
        let alternatives =
            others.filter_map(|j| of_joint(j).transpose()).collect::<Result<_, _>>()?;
        candidates.push(Candidate { joint, alternatives, leg: all[k].leg });
    }
    Ok(candidates)
}

/// Whether a principal slide may do with less displacement than the other candidates of its leg together.
///
/// Slides along an orthonormal basis of their span displace the leg by the same amount; those along other directions may not.
pub(super) fn widens(
    system: &MechanismSystem<'_>,
    all: &[Candidate],
    principal: &[Candidate],
    links: &[Pose],
) -> bool {
    let slides = |one: &Candidate| matches!(one.joint.motion, VirtualMotion::Slide(_));
    principal.iter().filter(|one| slides(one)).any(|one| {
        let of_leg: Vec<Vector3<f64>> = all
            .iter()
            .filter(|other| other.leg == one.leg && slides(other))
            .map(|other| seen(system, links, &other.joint).direction)
            .collect();
        // Three slides of one joint are orthogonal.
        let orthogonal = |a: &Vector3<f64>, b: &Vector3<f64>| a.dot(b).abs() <= 1e-9;
        let basis =
            of_leg.iter().filter(|a| of_leg.iter().filter(|b| orthogonal(a, b)).count() >= 2);
        basis.count() < 3
    })
}
