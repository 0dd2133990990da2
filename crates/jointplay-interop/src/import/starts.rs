//! Where joints start whose position the model does not state.

use std::collections::{BTreeMap, BTreeSet};

use jointplay_core::mechanism::{Coupling, Joint, JointCoordinate, JointKind};
use jointplay_core::spatial::{Pose, rotation_vector};

/// The coordinates of a joint whose frames are nearest these two (m, rad).
pub(super) fn coordinates_between(kind: JointKind, first_from_second: &Pose) -> Vec<f64> {
    let (rotation, shift) = (first_from_second.rotation, first_from_second.translation.vector);
    let angle = rotation[(1, 0)].atan2(rotation[(0, 0)]);
    match kind {
        JointKind::Revolute => vec![angle],
        JointKind::Prismatic => vec![shift.z],
        JointKind::Cylindrical => vec![shift.z, angle],
        JointKind::Spherical => rotation_vector(&rotation).iter().copied().collect(),
        JointKind::Planar => vec![shift.x, shift.y, angle],
        JointKind::Universal => vec![angle, rotation[(2, 1)].atan2(rotation[(2, 2)])],
        _ => Vec::new(),
    }
}

/// Gives joints without a guess one where zero is beyond their limits, or follows others; returns remarks.
pub(super) fn start(joints: &mut [Joint], couplings: &[Coupling]) -> Vec<String> {
    let mut remarks = Vec::new();
    for (number, joint) in joints.iter_mut().enumerate() {
        if couplings.iter().all(|coupling| coupling.follower.joint != number) {
            remarks.extend(start_within_limits(joint));
        }
    }
    for (JointCoordinate { joint, freedom }, value) in coupled_guesses(joints, couplings) {
        let Joint { kind, guess, .. } = &mut joints[joint];
        if guess.is_empty() && value == 0.0 {
            continue;
        }
        guess.resize(kind.freedoms(), 0.0);
        guess[freedom] = value;
    }
    remarks
}

/// Puts a joint whose start the model does not state within its limits, and remarks on it.
fn start_within_limits(joint: &mut Joint) -> Option<String> {
    let nearest = |&[least, greatest]: &[f64; 2]| {
        if least < greatest { 0.0_f64.clamp(least, greatest) } else { 0.0 }
    };
    let nearest: Vec<f64> = joint.limits.iter().map(nearest).collect();
    let is_beyond = joint.guess.is_empty() && nearest.iter().any(|&value| value != 0.0);
    is_beyond.then(|| {
        joint.guess = nearest;
        format!("joint {:?} starts at its limit: zero is beyond", joint.name)
    })
}

/// Guesses of coordinates that follow others, for joints without one: the values of their couplings at the guesses of the others.
///
/// Where several couplings have the same follower, the first counts; a cycle starts at zero.
fn coupled_guesses(joints: &[Joint], all: &[Coupling]) -> Vec<(JointCoordinate, f64)> {
    let mut couplings: BTreeMap<JointCoordinate, &Coupling> = BTreeMap::new();
    for coupling in all {
        if joints[coupling.follower.joint].guess.is_empty() {
            couplings.entry(coupling.follower).or_insert(coupling);
        }
    }
    let mut values: BTreeMap<JointCoordinate, f64> = BTreeMap::new();
    let mut is_open: BTreeSet<JointCoordinate> = BTreeSet::new();
    for &follower in couplings.keys() {
        if values.contains_key(&follower) {
            continue;
        }
        // An explicit stack, because a chain of followers can be as long as the file.
        let mut open = vec![follower];
        while let Some(&last) = open.last() {
            is_open.insert(last);
            let Coupling { terms, offset, .. } = couplings[&last];
            let is_missing =
                |one: &JointCoordinate| couplings.contains_key(one) && !is_open.contains(one);
            match terms.iter().map(|&(one, _)| one).find(is_missing) {
                Some(next) => open.push(next),
                None => {
                    let value = |one: JointCoordinate| {
                        let stated = joints[one.joint].guess.get(one.freedom);
                        values.get(&one).or(stated).copied().unwrap_or(0.0)
                    };
                    let sum = terms.iter().map(|&(one, ratio)| ratio * value(one)).sum::<f64>();
                    values.insert(last, offset + sum);
                    open.pop();
                }
            }
        }
    }
    values.into_iter().filter(|(_, value)| value.is_finite()).collect()
}
