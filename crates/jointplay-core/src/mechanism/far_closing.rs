//! Closing loops from far away.

use nalgebra::DVector;

use super::closing::close;
use super::closure::Closure;
use super::sparse::SparseSystem;
use super::system::MechanismSystem;
use crate::Error;
use crate::constraint::{CLOSURE_TOLERANCE, System as _};

/// Loops of a mechanism whose links are moved one by one: with more of them, corrections of joint coordinates move far links too far.
const MANY_LOOPS: usize = 6;

/// Whether a mechanism has so many loops that moving links closes it from farther away, and in less time, than moving joints.
pub(super) fn has_many_loops(system: &MechanismSystem<'_>) -> bool {
    system.kinematics().closing_joints().len() > MANY_LOOPS
}

/// Closes the loops from far away: of many loops by moving links, else by moving joints.
///
/// # Arguments
/// * `system` – its reference point and lengths are used throughout
/// * `free` – indices of the coordinates that may move
/// * `from` – (f + M) coordinates to begin from (m, rad)
///
/// # Errors
/// Those of [`close`] and [`SparseSystem::new`]. A closure that was not reached is not an error here.
pub(super) fn close_from_far(
    system: &MechanismSystem<'_>,
    free: &[usize],
    from: DVector<f64>,
    max_iterations: usize,
) -> Result<Closure, Error> {
    if has_many_loops(system) {
        close_by_links(system, free, from, max_iterations)
    } else {
        close(&system.moved_to(from)?, free, max_iterations)
    }
}

/// Closes the loops by moving each link, which closes many loops from farther away than moving joints does, since far links do not move with near joints.
///
/// # Arguments
/// As [`close_from_far`].
///
/// # Errors
/// Those of [`close_from_far`].
pub(super) fn close_by_links(
    system: &MechanismSystem<'_>,
    free: &[usize],
    from: DVector<f64>,
    max_iterations: usize,
) -> Result<Closure, Error> {
    let held: Vec<usize> = (0..from.len()).filter(|k| !free.contains(k)).collect();
    let mut links = SparseSystem::new(system.kinematics().mechanism(), from)?;
    let closed = links.close(&held, max_iterations);
    let there = system.moved_to(links.coordinates().clone())?;
    let residual = there.mismatch(&there.at_home());
    let iterations = match closed {
        // Round-off of each joint adds up along a loop.
        Ok(_) if residual > CLOSURE_TOLERANCE => return close(&there, free, max_iterations),
        Ok(iterations) | Err(Error::NotReached { iterations, .. }) => iterations,
        Err(error) => return Err(error),
    };
    let coordinates = there.home().clone();
    Ok(Closure { coordinates, residual, iterations, is_searched: false })
}
