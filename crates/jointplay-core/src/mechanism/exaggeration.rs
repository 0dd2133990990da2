//! Exaggerated play, for pictures.

use nalgebra::{DMatrix, DVector, Rotation3, Translation3, Vector3};

use super::kinematics::{check_coordinates, factor_of};
use super::{Carrier, Kinematics, MAX_DENSE, Mechanism};
use crate::Error;
use crate::error::finite;
use crate::linalg::svd;
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

/// Poses of rigid links that show the play of a relieved configuration exaggerated by a factor: for pictures, not a configuration of the mechanism.
///
/// Every link is displaced as a rigid body so that the displacements in its joints are, by least squares, nearest to the factor times those of the virtual joints, and all joint coordinates stay.
/// Links that a joint without virtual joints connects keep their relative pose; angles are weighed by the characteristic length.
/// With the factor 1 these are the true poses.
///
/// # Arguments
/// * `coordinates` – (f + M) of a relieved configuration (m, rad)
///
/// # Errors
/// [`Error::LengthMismatch`], [`Error::NotFinite`]; [`Error::TooLarge`] beyond [`MAX_DENSE`] displaced groups of links.
///
/// # Source
/// own derivation
pub fn exaggerated_link_poses(
    mechanism: &Mechanism,
    coordinates: &DVector<f64>,
    factor: f64,
) -> Result<Vec<Pose>, Error> {
    let excess = finite("the factor of exaggeration", factor)? - 1.0;
    let kinematics = Kinematics::new(mechanism);
    let mut links = kinematics.link_poses(coordinates)?;
    let virtual_joints = mechanism.virtual_joints();
    if excess == 0.0 || virtual_joints.is_empty() {
        return Ok(links);
    }
    check_coordinates(coordinates, kinematics.dimensions().len())?;
    let groups = rigid_groups(mechanism);
    let count = groups.iter().max().copied().unwrap_or(0);
    if count == 0 {
        return Ok(links);
    }
    if 6 * count > MAX_DENSE {
        let what = "displaced groups of links";
        return Err(Error::TooLarge { what, found: count, allowed: MAX_DENSE / 6 });
    }
    let mut relieved: Vec<usize> = virtual_joints.iter().map(|one| one.joint).collect();
    relieved.sort_unstable();
    relieved.dedup();
    let center = |joint: usize| {
        let joint = &mechanism.joints()[joint];
        (links[joint.links[0]] * joint.frames[0]).translation.vector
    };
    let centers: Vec<Vector3<f64>> = relieved.iter().map(|&joint| center(joint)).collect();
    #[expect(clippy::cast_precision_loss, reason = "few joints")]
    let reference = centers.iter().sum::<Vector3<f64>>() / centers.len() as f64;
    let spread = centers.iter().map(|at| (at - reference).norm()).fold(0.0, f64::max);
    let length = mechanism.characteristic_length().unwrap_or(spread).max(f64::MIN_POSITIVE);
    let zero = DVector::zeros(coordinates.len());
    let state = kinematics.placed(coordinates, &zero, &reference, None);
    let mut matrix = DMatrix::zeros(6 * relieved.len(), 6 * count);
    let mut wanted = DVector::zeros(6 * relieved.len());
    for (k, (&joint, center)) in relieved.iter().zip(&centers).enumerate() {
        let arm = center - reference;
        let (mut turn, mut slide) = (Vector3::zeros(), Vector3::zeros());
        for (m, _) in virtual_joints.iter().enumerate().filter(|(_, one)| one.joint == joint) {
            let column = mechanism.joint_freedoms() + m;
            let (angular, linear) = state.screws[column];
            turn += angular * coordinates[column];
            slide += (linear + angular.cross(&arm)) * coordinates[column];
        }
        wanted.fixed_rows_mut::<3>(6 * k).copy_from(&(slide * excess));
        wanted.fixed_rows_mut::<3>(6 * k + 3).copy_from(&(turn * (excess * length)));
        let sides = mechanism.joints()[joint].links.map(|link| groups[link]);
        for (group, sign) in sides.into_iter().zip([-1.0, 1.0]).filter(|(group, _)| *group > 0) {
            let column = 6 * (group - 1);
            for axis in 0..3 {
                matrix[(6 * k + axis, column + axis)] += sign;
                matrix[(6 * k + 3 + axis, column + 3 + axis)] += sign * length;
                let moved = Vector3::ith(axis, 1.0).cross(&arm) * sign;
                let mut rows = matrix.fixed_view_mut::<3, 1>(6 * k, column + 3 + axis);
                rows += moved;
            }
        }
    }
    let found = svd(&matrix)?;
    let rank = found.rank(1e-12);
    let displacements = found.solve(&wanted, rank);
    for (pose, &group) in links.iter_mut().zip(&groups).filter(|(_, group)| **group > 0) {
        let of_group = displacements.fixed_rows::<6>(6 * (group - 1));
        let rotation = Rotation3::new(of_group.fixed_rows::<3>(3).into_owned());
        let shift = reference + of_group.fixed_rows::<3>(0) - rotation * reference;
        *pose = Pose::from_parts(Translation3::from(shift), rotation) * *pose;
    }
    Ok(links)
}

/// For each link the number of its group of links connected by joints without virtual joints; 0 is that of the base.
fn rigid_groups(mechanism: &Mechanism) -> Vec<usize> {
    let joints = mechanism.joints();
    let mut rigid = vec![true; joints.len()];
    mechanism.virtual_joints().iter().for_each(|one| rigid[one.joint] = false);
    let mut neighbours = vec![Vec::new(); mechanism.links().len()];
    for joint in joints.iter().zip(&rigid).filter_map(|(joint, &rigid)| rigid.then_some(joint)) {
        let [first, second] = joint.links;
        neighbours[first].push(second);
        neighbours[second].push(first);
    }
    let mut groups = vec![usize::MAX; mechanism.links().len()];
    let mut count = 0;
    for link in 0..groups.len() {
        if groups[link] != usize::MAX {
            continue;
        }
        let mut open = vec![link];
        while let Some(link) = open.pop() {
            if std::mem::replace(&mut groups[link], count) == usize::MAX {
                open.extend(neighbours[link].iter().filter(|&&next| groups[next] == usize::MAX));
            }
        }
        count += 1;
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{Joint, JointKind, LinearAndAngular, VirtualJoint, VirtualMotion};

    fn joint(name: &str, kind: JointKind, links: [usize; 2], at: Pose) -> Joint {
        Joint {
            name: name.to_owned(),
            kind,
            links,
            frames: [at, Pose::identity()],
            actuated: false,
            guess: Vec::new(),
            limits: Vec::new(),
            clearance: LinearAndAngular::default(),
            stiffness: LinearAndAngular::default(),
        }
    }

    /// A body on a slide with play across it and about it, and a second body hinged on the first.
    fn slide() -> Mechanism {
        let names = ["base", "body", "arm"].map(str::to_owned).to_vec();
        let joints = vec![
            joint("slide", JointKind::Prismatic, [0, 1], Pose::identity()),
            joint("hinge", JointKind::Revolute, [1, 2], Pose::translation(0.2, 0.0, 0.0)),
        ];
        let play = |name: &str, motion| VirtualJoint {
            name: name.to_owned(),
            joint: 0,
            carrier: Carrier::First,
            motion,
            clearance: None,
            stiffness: None,
        };
        let point = Vector3::zeros();
        let plays = vec![
            play("across", VirtualMotion::Slide(Vector3::x_axis())),
            play("about", VirtualMotion::Turn { axis: Vector3::z_axis(), point }),
        ];
        let mechanism = Mechanism::new("slide", names, joints).unwrap();
        mechanism.with_virtual_joints(plays).unwrap().with_characteristic_length(0.1).unwrap()
    }

    #[test]
    fn one_joint_takes_all_of_its_play_and_carries_the_rest() {
        let mechanism = slide();
        let at = DVector::from_vec(vec![0.1, 0.0, 1e-5, 0.0]);
        let poses = exaggerated_link_poses(&mechanism, &at, 100.0).unwrap();
        assert_eq!(poses[0], Pose::identity());
        let off = poses[1].translation.vector - Vector3::new(1e-3, 0.0, 0.1);
        assert!(off.norm() < 1e-15, "{off}");
        let off = poses[2].translation.vector - Vector3::new(0.201, 0.0, 0.1);
        assert!(off.norm() < 1e-15, "{off}");
        let turned = DVector::from_vec(vec![0.1, 0.0, 0.0, 1e-4]);
        let poses = exaggerated_link_poses(&mechanism, &turned, 100.0).unwrap();
        let angle = poses[1].rotation.angle();
        assert!((angle - 1e-2).abs() < 1e-14, "{angle}");
        let arm = poses[2].translation.vector;
        let expected = Vector3::new(0.2 * 1e-2_f64.cos(), 0.2 * 1e-2_f64.sin(), 0.1);
        assert!((arm - expected).norm() < 1e-14, "{arm}");
    }

    #[test]
    fn true_play_is_the_true_configuration_and_bad_input_is_refused() {
        let mechanism = slide();
        let at = DVector::from_vec(vec![0.1, 0.3, 1e-5, 1e-4]);
        let poses = exaggerated_link_poses(&mechanism, &at, 1.0).unwrap();
        assert_eq!(poses, Kinematics::new(&mechanism).link_poses(&at).unwrap());
        assert!(exaggerated_link_poses(&mechanism, &at, f64::NAN).is_err());
        assert!(exaggerated_link_poses(&mechanism, &DVector::zeros(3), 2.0).is_err());
    }
}
