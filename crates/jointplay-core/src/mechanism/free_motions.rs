//! Motions that held coordinates leave free, such as the spins of bars between two balls.

use nalgebra::{DMatrix, DVector};

use super::{JointKind, Mechanism, MechanismSystem};
use crate::Error;
use crate::constraint::System as _;
use crate::linalg::svd;
use crate::mobility::RANK_THRESHOLD;

/// Share of a free motion above which a joint takes part in it.
const PART: f64 = 1e-6;
/// Displacement along a free motion at which the poses of links are compared, in radians and characteristic lengths.
const STEP: f64 = 1e-6;

/// Independent motions of the same joints that remain where other coordinates are held.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FreeMotion {
    /// Number of the motions.
    pub count: usize,
    /// Indices of the links that move.
    pub links: Vec<usize>,
    /// Indices of the joints that move.
    pub joints: Vec<usize>,
    /// Whether it is the turn of a link between two balls about the line through them.
    pub is_spin: bool,
}

/// The instantaneous motions that remain free where coordinates are held, in groups that share no joint.
///
/// ```text
///    J_p  ·  N  =  0        J_p: loops by the passive joints;   N: (p, u) orthonormal
///    P = N · Nᵀ             projector, block-diagonal by groups; the trace of a block counts its motions
/// ```
///
/// # Arguments
/// * `coordinates` – (f + M) of a closed configuration (m, rad)
/// * `held` – indices of joint coordinates; virtual joints are held too
///
/// # Errors
/// Those of [`MechanismSystem::new`]; [`Error::Linalg`] (never seen).
///
/// # Numerics
/// One dense singular value decomposition.
pub fn free_motions(
    mechanism: &Mechanism,
    coordinates: &DVector<f64>,
    held: &[usize],
) -> Result<Vec<FreeMotion>, Error> {
    let system = MechanismSystem::new(mechanism, coordinates.clone())?;
    let length = system.characteristic_length();
    let mut jacobian = system.constraint_jacobian(&system.at_home());
    for (mut row, unit) in jacobian.row_iter_mut().zip(system.constraint_dimensions()) {
        row /= unit.unit(length);
    }
    let units: Vec<f64> =
        system.kinematics().dimensions().iter().map(|unit| unit.unit(length)).collect();
    let passive: Vec<usize> =
        (0..mechanism.joint_freedoms()).filter(|k| !held.contains(k)).collect();
    let mut loops = jacobian.select_columns(&passive);
    for (mut column, &k) in loops.column_iter_mut().zip(&passive) {
        column *= units[k];
    }
    let free = if loops.is_empty() {
        DMatrix::identity(passive.len(), passive.len())
    } else {
        let decomposition = svd(&loops)?;
        decomposition.null_space(decomposition.rank(RANK_THRESHOLD))
    };
    let projector = &free * free.transpose();
    let mut motions = Vec::new();
    for group in groups(&projector) {
        motions.push(described(&system, &passive, &units, &projector, &group)?);
    }
    Ok(motions)
}

/// Coordinates that move together, by their indices among the passive ones.
fn groups(projector: &DMatrix<f64>) -> Vec<Vec<usize>> {
    let count = projector.nrows();
    let moves = |k: usize| projector[(k, k)] > PART * PART;
    let mut is_reached = vec![false; count];
    let mut groups = Vec::new();
    for first in (0..count).filter(|&k| moves(k)) {
        if is_reached[first] {
            continue;
        }
        is_reached[first] = true;
        let (mut group, mut open) = (Vec::new(), vec![first]);
        while let Some(k) = open.pop() {
            group.push(k);
            let near = (0..count).filter(|&other| projector[(k, other)].abs() > PART);
            for other in near {
                if !std::mem::replace(&mut is_reached[other], true) {
                    open.push(other);
                }
            }
        }
        group.sort_unstable();
        groups.push(group);
    }
    groups
}

fn described(
    system: &MechanismSystem<'_>,
    passive: &[usize],
    units: &[f64],
    projector: &DMatrix<f64>,
    group: &[usize],
) -> Result<FreeMotion, Error> {
    let kinematics = system.kinematics();
    let mechanism = kinematics.mechanism();
    let (home, length) = (system.home(), system.characteristic_length());
    let trace: f64 = group.iter().map(|&k| projector[(k, k)]).sum();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the trace of a projector is a small count"
    )]
    let count = trace.round() as usize;
    let coordinates: Vec<usize> = group.iter().map(|&k| passive[k]).collect();
    let moving = (0..mechanism.joints().len()).filter(|&joint| {
        kinematics.coordinates_of(joint).any(|coordinate| coordinates.contains(&coordinate))
    });
    let moving: Vec<usize> = moving.collect();
    // Each column of the block is a motion of the group, and together they span it.
    let at_rest = kinematics.link_poses(home)?;
    let mut is_moved = vec![false; at_rest.len()];
    for &column in group {
        let mut by = DVector::zeros(home.len());
        for &k in group {
            by[passive[k]] = STEP * projector[(k, column)] * units[passive[k]];
        }
        let poses = kinematics.link_poses(&kinematics.moved(home, &by))?;
        for (link, (pose, rest)) in poses.iter().zip(&at_rest).enumerate() {
            let turned = (pose.rotation.matrix() - rest.rotation.matrix()).amax();
            let shifted = (pose.translation.vector - rest.translation.vector).amax() / length;
            is_moved[link] |= turned.max(shifted) > 1e-3 * STEP;
        }
    }
    let links: Vec<usize> = (0..at_rest.len()).filter(|&link| is_moved[link]).collect();
    let is_ball = |&joint: &usize| mechanism.joints()[joint].kind == JointKind::Spherical;
    let is_spin = count == 1 && links.len() == 1 && moving.len() == 2 && moving.iter().all(is_ball);
    Ok(FreeMotion { count, links, joints: moving, is_spin })
}
