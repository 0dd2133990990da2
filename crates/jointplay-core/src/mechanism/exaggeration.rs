//! Exaggerated play, for pictures.

use nalgebra::DVector;

use super::kinematics::factor_of;
use super::{Carrier, Kinematics, Mechanism};
use crate::Error;
use crate::error::finite;
use crate::spatial::Pose;

/// A configuration with its play exaggerated by a factor: for pictures, not a configuration of the mechanism.
///
/// All joints are where they truly are, and so are the links, but each link ends short of a joint in which it has play, or beyond it, by the factor times what is true.
/// Rigid links that are apart in one joint by more than they are cannot meet in the others, so that links are shown stretched, which none is.
#[derive(Debug, Clone, PartialEq)]
pub struct ExaggeratedPlay {
    /// Factor by which the play is exaggerated; 1 shows the true play.
    pub factor: f64,
    /// For each joint the frame in which it moves, as its first and as its second link carry it through its virtual joints, in the base frame: the truth.
    pub joints: Vec<[Pose; 2]>,
    /// For each joint the seat of that frame in the first and in the second link, before its virtual joints, in the base frame.
    pub seats: Vec<[Pose; 2]>,
}

/// Exaggerates the play of a relieved configuration by a factor.
///
/// ```text
///    seat  =  joint · (V(k X) F)⁻¹ F        F: frame in the link, V(X): its virtual joints, k: factor
/// ```
/// With k = 1 this is the seat in the link's own pose, with k = 0 the joint.
///
/// # Arguments
/// * `coordinates` – (f + M) of a relieved configuration (m, rad)
///
/// # Errors
/// [`Error::LengthMismatch`], [`Error::NotFinite`].
///
/// # Source
/// own derivation, `docs/explanation/mechanisms.md`
pub fn exaggerate_play(
    mechanism: &Mechanism,
    coordinates: &DVector<f64>,
    factor: f64,
) -> Result<ExaggeratedPlay, Error> {
    let factor = finite("the factor of exaggeration", factor)?;
    let links = Kinematics::new(mechanism).link_poses(coordinates)?;
    let displaced = |joint: usize, carrier: Carrier, factor: f64| {
        let first = mechanism.joint_freedoms();
        mechanism
            .virtual_joints()
            .iter()
            .enumerate()
            .filter(|(_, one)| one.joint == joint && one.carrier == carrier)
            .fold(Pose::identity(), |pose, (m, one)| {
                pose * factor_of(one.motion).transform(&[factor * coordinates[first + m]])
            })
    };
    let (mut joints, mut seats) = (Vec::new(), Vec::new());
    for (j, joint) in mechanism.joints().iter().enumerate() {
        let ends = [Carrier::First, Carrier::Second].map(|carrier| {
            let side = usize::from(carrier == Carrier::Second);
            let frame = joint.frames[side];
            let true_place = links[joint.links[side]] * displaced(j, carrier, 1.0) * frame;
            (true_place, true_place * (displaced(j, carrier, factor) * frame).inverse() * frame)
        });
        joints.push(ends.map(|(joint, _)| joint));
        seats.push(ends.map(|(_, seat)| seat));
    }
    Ok(ExaggeratedPlay { factor, joints, seats })
}
