//! Closing loops from a configuration nearby.

use nalgebra::DVector;

use super::closure::Closure;
use super::system::MechanismSystem;
use crate::Error;
use crate::constraint::{CLOSURE_TOLERANCE, System, scaled_jacobian, scaled_residual, units};
use crate::linalg::svd;

/// Below this residual a step that gains nothing is the end.
const ROUND_OFF: f64 = 1e-14;
/// Longest step of a correction, in radians and characteristic lengths.
const LONGEST_STEP: f64 = 0.5;
/// Where loops are closed, corrections that leave more than this share of the residual…
const STILL_CONVERGING: f64 = 0.5;
/// …by steps longer than this, and any that are longer than [`FAR`], are damped more: they drift along motions that loops do not determine, in radians and characteristic lengths.
const DRIFT: f64 = 1e-7;
const FAR: f64 = 1e-4;
/// Damping below which a longer step is no better.
const LEAST_DAMPING: f64 = 1e-14;
/// Share of the largest singular value below which singular values are round-off: their directions are arbitrary, and divided by the least damping they would move coordinates that the loops leave free.
const ROUND_OFF_OF_RANK: f64 = 1e-14;

/// Corrects the free coordinates until all loops are closed, by damped Gauss–Newton steps of least norm.
///
/// Neither redundant constraints nor singular configurations stop it: no step is taken along directions that the constraints leave open.
///
/// # Arguments
/// * `start` – where to begin; its reference point and lengths are used throughout
/// * `free` – indices of the coordinates that may move
///
/// # Errors
/// [`Error::NoSuchQuantity`] for an index of no coordinate; [`Error::Linalg`] (never seen). A closure that was not reached is not an error here: see [`Closure::is_closed`].
///
/// # Numerics
/// The damping is in proportion to the residual, so that convergence is quadratic where the loops can be closed, and near linear where they only touch.
///
/// # Source
/// \[YamashitaFukushima\]
pub fn close(
    start: &MechanismSystem<'_>,
    free: &[usize],
    max_iterations: usize,
) -> Result<Closure, Error> {
    crate::error::indices("coordinate", free, start.home().len())?;
    let length = start.characteristic_length();
    let rows = units(&start.constraint_dimensions(), length);
    let columns = units(start.kinematics().dimensions(), length);
    let free_units = DVector::from_iterator(free.len(), free.iter().map(|&k| columns[k]));
    let mut here = start.clone().with_free(free);
    let mut residual = scaled_residual(&here.residual(&here.at_home()), &rows);
    let mut damping_factor = 1.0;
    let mut iterations = 0;
    while iterations < max_iterations && residual.amax() > 1e-16 && !free.is_empty() {
        let jacobian = here.full_jacobian(&here.at_home()).select_columns(free);
        let decomposition = svd(&scaled_jacobian(&jacobian, &rows, &free_units))?;
        let rank = decomposition.rank(ROUND_OFF_OF_RANK);
        let before = residual.norm();
        let mut accepted = false;
        while !accepted && iterations < max_iterations {
            iterations += 1;
            let damping = (damping_factor * before.min(1.0)).max(LEAST_DAMPING);
            let step = -decomposition.solve_damped_within(&residual, damping, rank);
            let shorten = (LONGEST_STEP / step.norm()).min(1.0);
            let mut by = DVector::zeros(here.home().len());
            for (&k, value) in free.iter().zip(step.component_mul(&free_units).iter()) {
                by[k] = value * shorten;
            }
            let there = here.moved(&by)?;
            let reached = scaled_residual(&there.residual(&there.at_home()), &rows);
            let slow = reached.norm() > STILL_CONVERGING * before;
            let drifts =
                before <= CLOSURE_TOLERANCE && step.norm() > if slow { DRIFT } else { FAR };
            if reached.norm() < before && !drifts {
                (here, residual, accepted) = (there, reached, true);
                damping_factor *= 0.1;
            } else {
                damping_factor = damping_factor.max(1e-3) * 10.0;
                if before <= ROUND_OFF || step.norm() <= 1e-15 || damping_factor > 1e6 {
                    break;
                }
            }
        }
        // A step that hardly lowers the residual is at round-off or at a local minimum.
        if !accepted || (residual.norm() > 0.999 * before && iterations > 20) {
            break;
        }
        if residual.amax() < 1e-15 {
            break;
        }
    }
    let residual = here.mismatch(&here.at_home());
    Ok(Closure { coordinates: here.home().clone(), residual, iterations, is_searched: false })
}
