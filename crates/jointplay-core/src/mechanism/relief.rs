//! What virtual joints do when some joints are commanded.

use nalgebra::{DMatrix, DVector};

use super::{CLOSED, MechanismSystem, close};
use crate::Error;
use crate::constraint::{Dimension, System, scaled_jacobian, scaled_residual, units};
use crate::linalg::{Svd, svd};

/// Singular values up to this share of the largest are not used to relieve anything.
const RELIEF_THRESHOLD: f64 = 1e-9;
/// Changes of the virtual joints below this, in their metric, are the end.
const SETTLED: f64 = 1e-14;
/// Steps of the iteration.
const MAX_ITERATIONS: usize = 60;

/// How the virtual joints are chosen among those that close the loops.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ReliefSolver {
    /// The least displacement in the metric.
    #[default]
    LeastNorm,
    /// Steps of least norm from rest, as in the paper: near, not at, the least displacement.
    Newton,
}

/// Virtual joints that let the commanded joints be where they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Relief {
    /// (f + M) coordinates: commanded, passive, virtual [m, rad].
    pub coordinates: DVector<f64>,
    /// (M) displacements of the virtual joints [m, rad].
    pub virtual_joints: DVector<f64>,
    /// √(Σ w x²): in metres, turns being weighed by the characteristic length, or by stiffness where every virtual joint has one [m or √J].
    pub size: f64,
    /// Largest mismatch, in radians and characteristic lengths.
    pub residual: f64,
    /// Iterations done.
    pub iterations: usize,
}

/// Weights of the virtual joints: 1 for a slide and ρ² for a turn, or their stiffness where all have one.
#[must_use]
pub fn virtual_weights(system: &MechanismSystem<'_>) -> DVector<f64> {
    let virtual_joints = system.kinematics().mechanism().virtual_joints();
    let stiff: Option<Vec<f64>> = virtual_joints.iter().map(|joint| joint.stiffness).collect();
    let length = system.characteristic_length();
    match stiff {
        Some(stiffness) if !stiffness.is_empty() => DVector::from_vec(stiffness),
        _ => DVector::from_iterator(
            virtual_joints.len(),
            system.virtual_joint_dimensions().into_iter().map(|dimension| match dimension {
                Dimension::Angle => length * length,
                Dimension::Length | Dimension::SquaredLength => 1.0,
            }),
        ),
    }
}

/// Finds the passive joints and the virtual joints for commanded coordinates.
///
/// # Arguments
/// * `start` – home with the commanded coordinates at their values, passive joints near, virtual joints at rest
/// * `commanded` – indices of the coordinates that keep their values
///
/// # Errors
/// [`Error::NotRelieved`] with what stays open, where these virtual joints cannot make the motion possible.
///
/// # Numerics
/// The passive joints are eliminated at each step; what is left is a least-norm problem in the virtual joints alone.
pub fn relieve(
    start: &MechanismSystem<'_>,
    commanded: &[usize],
    solver: ReliefSolver,
) -> Result<Relief, Error> {
    let f = start.coordinate_dimensions().len();
    let length = start.characteristic_length();
    let mut here = start.clone();
    let mut iterations = 0;
    let mut reached = f64::INFINITY;
    while iterations < MAX_ITERATIONS {
        iterations += 1;
        let Reduced { relieving, open, residual, j_x, passive_part, passive, of_passive, roots } =
            reduced(&here, commanded)?;
        let y = here.at_home().virtual_joints.component_mul(&roots);
        let decomposition = svd(&relieving)?;
        let rank = decomposition.rank(RELIEF_THRESHOLD);
        let step = match solver {
            ReliefSolver::LeastNorm => {
                decomposition.solve(&(&relieving * &y - &open * &residual), rank) - &y
            }
            ReliefSolver::Newton => -decomposition.solve(&(&open * &residual), rank),
        };
        let passive_rank = passive_part.rank(RELIEF_THRESHOLD);
        let follow = -passive_part.solve(&(&residual + &j_x * &step), passive_rank);
        let mut by = DVector::zeros(here.home().len());
        for (&k, value) in passive.iter().zip(follow.component_mul(&of_passive).iter()) {
            by[k] = *value;
        }
        by.rows_mut(f, roots.len()).copy_from(&step.component_div(&roots));
        here = here.moved(&by)?;
        let after = here.mismatch(&here.at_home());
        let settled = step.norm() <= SETTLED * length.max(y.norm());
        let stop = !after.is_finite() || (settled && (after >= reached || after < 1e-15));
        reached = after;
        if stop {
            break;
        }
    }
    if reached.is_nan() || reached > CLOSED {
        let free: Vec<usize> = (0..start.home().len()).filter(|k| !commanded.contains(k)).collect();
        let best = close(start, &free, MAX_ITERATIONS)?;
        return Err(Error::NotRelieved { residual: best.residual.min(reached), allowed: CLOSED });
    }
    let virtual_joints = here.at_home().virtual_joints;
    let size = virtual_joints.component_mul(&virtual_weights(start).map(f64::sqrt)).norm();
    Ok(Relief {
        coordinates: here.home().clone(),
        virtual_joints,
        size,
        residual: reached,
        iterations,
    })
}

/// What passive joints leave open, and what virtual joints can do about it.
pub(super) struct Reduced {
    /// (open, M) what virtual joints in their metric do to what is left open.
    pub(super) relieving: DMatrix<f64>,
    /// (open, c) the combinations of constraints that no passive joint can change.
    open: DMatrix<f64>,
    residual: DVector<f64>,
    j_x: DMatrix<f64>,
    passive_part: Svd,
    passive: Vec<usize>,
    of_passive: DVector<f64>,
    /// (M) y = root · x is in the metric.
    pub(super) roots: DVector<f64>,
}

pub(super) fn reduced(here: &MechanismSystem<'_>, commanded: &[usize]) -> Result<Reduced, Error> {
    let (f, total) = (here.coordinate_dimensions().len(), here.home().len());
    let passive: Vec<usize> = (0..f).filter(|k| !commanded.contains(k)).collect();
    let virtuals: Vec<usize> = (f..total).collect();
    let rows = units(&here.constraint_dimensions(), here.characteristic_length());
    let columns = units(here.kinematics().dimensions(), here.characteristic_length());
    let of_passive = DVector::from_iterator(passive.len(), passive.iter().map(|&k| columns[k]));
    let roots = virtual_weights(here).map(f64::sqrt);
    let at = here.at_home();
    let residual = scaled_residual(&here.residual(&at), &rows);
    let jacobian = here.full_jacobian(&at);
    let j_p = scaled_jacobian(&jacobian.select_columns(&passive), &rows, &of_passive);
    let per_metric = roots.map(|root| 1.0 / root);
    let j_x = scaled_jacobian(&jacobian.select_columns(&virtuals), &rows, &per_metric);
    let passive_part = svd(&j_p)?;
    let open = passive_part.left_null_space(passive_part.rank(RELIEF_THRESHOLD)).transpose();
    let relieving = &open * &j_x;
    Ok(Reduced { relieving, open, residual, j_x, passive_part, passive, of_passive, roots })
}
