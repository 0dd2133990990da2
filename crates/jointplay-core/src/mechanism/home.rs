//! Closed configurations for commanded coordinates, and the one that displacements of virtual joints are counted from.

use nalgebra::DVector;

use super::assembly::{assemble, assemble_within, guess};
use super::closure::Closure;
use super::coupling_conflicts::contradicted;
use super::description::Mechanism;
use super::nearest::nearest_closure;
use super::relief::{CommandedJoints, Relief, ReliefSolver, relieve};
use super::second_order_closing::near_miss_at;
use super::sparse::SparseSystem;
use super::system::MechanismSystem;
use super::unassembled::{NEARLY_CLOSED, Unassembled};
use crate::Error;
use crate::constraint::{CLOSURE_TOLERANCE, System as _, units};
use crate::mobility::check_tolerance;

/// Number of other starts, if the guess does not close.
const STARTS: usize = 30;
/// Actuators that move by more than this multiple of the root of the mismatch at their guesses lead to another configuration: near a singular one, a closure is as far as that root.
const FAR: f64 = 4.0;
/// Largest number of corrections for a mechanism with many loops, which is closed from its guess only.
const CORRECTIONS: usize = 200;

/// The user's guess with commanded coordinates at their values.
///
/// # Arguments
/// * `commands` – indices of joint coordinates with their values (m, rad)
#[must_use]
pub fn commanded_guess(mechanism: &Mechanism, commands: &[(usize, f64)]) -> DVector<f64> {
    let mut start = guess(mechanism);
    commands.iter().for_each(|&(k, value)| start[k] = value);
    start
}

/// The closed configuration nearest to the guess, with commanded coordinates held and virtual joints at rest.
///
/// Where corrections from the guess do not close the loops, it is the one that [`Unassembled::accepted`] chooses; where they end beyond limits, it is the nearest found within, if any: with commands on the same branch only.
/// With a tolerance and no commands, actuators stay at their guesses where the loops close there within the tolerance and the limits, and exactly only far from there.
///
/// # Arguments
/// * `commands` – indices of joint coordinates with their values (m, rad)
/// * `tolerance` – largest mismatch that counts as closed, in radians and characteristic lengths; `None` for loops that close exactly
///
/// # Errors
/// [`Error::NotAssembled`]; [`Error::NotReached`] for a mechanism that is too large for dense algebra.
pub fn close_commanded(
    mechanism: &Mechanism,
    commands: &[(usize, f64)],
    tolerance: Option<f64>,
) -> Result<Closure, Error> {
    let accepted = |found: &Unassembled, tolerance: Option<f64>| found.accepted(tolerance).cloned();
    let closed = close(mechanism, commands, tolerance, accepted)?;
    if let Some(tolerance) = tolerance.filter(|_| commands.is_empty())
        && let Some(near) = near_miss_at_guess(mechanism, &closed)?
        && near.residual <= tolerance
        && mechanism.beyond_limits(&near.coordinates).is_empty()
    {
        return Ok(near);
    }
    let is_held = |k: usize| commands.iter().any(|&(held, _)| held == k);
    let beyond = mechanism.beyond_limits(&closed.coordinates);
    let is_within = beyond.iter().all(|one| is_held(one.coordinate));
    if is_within || closed.is_searched || !closed.is_closed() || !MechanismSystem::fits(mechanism) {
        return Ok(closed);
    }
    let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
    let starts = if commands.is_empty() { STARTS } else { 0 };
    let guess = commanded_guess(mechanism, commands);
    Ok(nearest_closure(mechanism, &guess, &held, starts)?.unwrap_or(closed))
}

/// The configuration that displacements of virtual joints are counted from, the same for all commands: closed, or with loops that the virtual joints close.
///
/// It is that of the rigid links, whatever the virtual joints are, see [`close_nearly`].
/// Where these miss by more than a rounding of the dimensions, it is the one of least displacement with the actuators at their guesses, with the virtual joints back at rest, so that the loops miss there by the play that they need.
///
/// # Arguments
/// * `tolerance` – as for [`close_commanded`]
///
/// # Errors
/// Those of [`close_commanded`].
pub fn close_at_rest(mechanism: &Mechanism, tolerance: Option<f64>) -> Result<Closure, Error> {
    if mechanism.virtual_joints().is_empty() || !MechanismSystem::fits(mechanism) {
        return close_commanded(mechanism, &[], tolerance);
    }
    match close_rigid_nearly(mechanism, tolerance) {
        Ok(home) => {
            let count = home.coordinates.len() + mechanism.virtual_joints().len();
            let coordinates = home.coordinates.resize_vertically(count, 0.0);
            Ok(Closure { coordinates, ..home })
        }
        Err(Error::NotAssembled(found)) => {
            at_rest_by_play(mechanism).map_err(|_| Error::NotAssembled(found))
        }
        Err(error) => Err(error),
    }
}

/// The configuration of the rigid links from which virtual joints are suggested: closed, or where measured dimensions miss a closure by little.
///
/// Where rigid links nearly close with the actuators at their guesses, and exactly only far from there, or not at all, it is the configuration of least mismatch with the actuators at their guesses.
/// The virtual joints of the mechanism have no effect; those that are suggested then close the loops too.
///
/// # Errors
/// Those of [`close_commanded`], where the loops miss by more than a rounding of the dimensions.
pub fn close_nearly(mechanism: &Mechanism) -> Result<Closure, Error> {
    close_rigid_nearly(mechanism, None)
}

/// As [`close_nearly`].
///
/// # Arguments
/// * `tolerance` – as for [`close_commanded`]
fn close_rigid_nearly(mechanism: &Mechanism, tolerance: Option<f64>) -> Result<Closure, Error> {
    let rigid = mechanism.clone().with_virtual_joints(Vec::new());
    let rigid = rigid.expect("a list without virtual joints is valid");
    match close_commanded(&rigid, &[], tolerance) {
        Ok(home) if !MechanismSystem::fits(&rigid) => Ok(home),
        Ok(home) => Ok(near_miss_at_guess(&rigid, &home)?.unwrap_or(home)),
        Err(Error::NotAssembled(found)) => match (found.near_miss(), near_at_guess(&rigid)?) {
            (Some(_), Some(near)) => Ok(near),
            (Some(near), None) => Ok(near.clone()),
            (None, _) => Err(Error::NotAssembled(found)),
        },
        Err(error) => Err(error),
    }
}

/// The near miss with the actuators at their guesses, where the closed configuration is far from it: a correction follows a motion that nearly closes as far as it has to.
///
/// # Arguments
/// * `home` – the closed configuration, see [`close_commanded`]
///
/// # Errors
/// [`Error::LengthMismatch`], [`Error::NotFinite`].
pub fn near_miss_at_guess(mechanism: &Mechanism, home: &Closure) -> Result<Option<Closure>, Error> {
    let system = MechanismSystem::new(mechanism, guess(mechanism))?;
    let units = units(system.kinematics().dimensions(), system.characteristic_length());
    let by = system.kinematics().displacement(system.home(), &home.coordinates);
    let actuated = mechanism.actuated_coordinates().into_iter();
    let moved = actuated.map(|k| (by[k] / units[k]).abs()).fold(0.0, f64::max);
    let is_far = |residual: f64| moved > FAR * residual.sqrt();
    let is_next_to_miss = home.is_searched && is_near_miss(mechanism)?;
    if !home.is_closed() || !(is_next_to_miss || is_far(CLOSURE_TOLERANCE)) {
        return Ok(None);
    }
    let near = near_at_guess(mechanism)?.filter(|near| !near.is_closed());
    Ok(near.filter(|near| is_next_to_miss || is_far(near.residual)))
}

/// Whether the guess is next to a near miss that does not close.
fn is_near_miss(mechanism: &Mechanism) -> Result<bool, Error> {
    let system = MechanismSystem::new(mechanism, guess(mechanism))?;
    let joints: Vec<usize> = (0..mechanism.joint_freedoms()).collect();
    let near = near_miss_at(&system, &joints)?;
    Ok(!near.is_closed() && near.residual <= NEARLY_CLOSED)
}

/// The actuated coordinates with their guesses (m, rad).
pub(super) fn actuators_at_guess(mechanism: &Mechanism) -> Vec<(usize, f64)> {
    let start = guess(mechanism);
    mechanism.actuated_coordinates().into_iter().map(|k| (k, start[k])).collect()
}

/// The near miss with the actuators at their guesses, if there is one: without them held, a least mismatch may be far along a motion that nearly closes.
fn near_at_guess(mechanism: &Mechanism) -> Result<Option<Closure>, Error> {
    let actuated = mechanism.actuated_coordinates();
    match assemble(mechanism, &guess(mechanism), &actuated, 0) {
        Err(Error::NotAssembled(found)) => Ok(found.near_miss().cloned()),
        closed => closed.map(Some),
    }
}

/// The configuration of least displacement with the actuators at their guesses, with the virtual joints back at rest.
fn at_rest_by_play(mechanism: &Mechanism) -> Result<Closure, Error> {
    let Relief { mut coordinates, iterations, .. } = relief_at_guess(mechanism)?;
    coordinates.rows_range_mut(mechanism.joint_freedoms()..).fill(0.0);
    let system = MechanismSystem::new(mechanism, coordinates.clone())?;
    let residual = system.mismatch(&system.at_home());
    Ok(Closure { coordinates, residual, iterations, is_searched: false })
}

/// The least displacement of the virtual joints that closes the loops with the actuators at their guesses.
fn relief_at_guess(mechanism: &Mechanism) -> Result<Relief, Error> {
    let (residual, iterations) = (f64::INFINITY, 0);
    let coordinates = guess(mechanism);
    let open = Closure { coordinates, residual, iterations, is_searched: false };
    relieve_from(mechanism, &open, &actuators_at_guess(mechanism))
}

/// The closed configuration from the guess, or one that is accepted in its place.
pub(super) fn close(
    mechanism: &Mechanism,
    commands: &[(usize, f64)],
    tolerance: Option<f64>,
    accepted: impl Fn(&Unassembled, Option<f64>) -> Option<Closure>,
) -> Result<Closure, Error> {
    tolerance.map(check_tolerance).transpose()?;
    // Closures within a tolerance need dense algebra, which refuses mechanisms that are too large.
    if !MechanismSystem::fits(mechanism) && tolerance.is_none() {
        let (system, iterations) = close_sparse(mechanism, commands)?;
        return Ok(system.closure(iterations));
    }
    let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
    match assemble_within(
        mechanism,
        &commanded_guess(mechanism, commands),
        &held,
        STARTS,
        tolerance,
    ) {
        Err(Error::NotAssembled(found)) => match accepted(&found, tolerance) {
            Some(closure) => Ok(closure),
            None => Err(Error::NotAssembled(found)),
        },
        found => found,
    }
}

/// The closed configuration nearest to the guess by sparse algebra, and the number of corrections.
///
/// # Arguments
/// * `commands` – indices of joint coordinates with their values (m, rad)
///
/// # Errors
/// [`Error::NotReached`]; [`Error::NotRelieved`] with the couplings that the commands contradict.
pub fn close_sparse<'a>(
    mechanism: &'a Mechanism,
    commands: &[(usize, f64)],
) -> Result<(SparseSystem<'a>, usize), Error> {
    let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
    let mut system = SparseSystem::new(mechanism, commanded_guess(mechanism, commands))?;
    match system.close(&held, CORRECTIONS) {
        Ok(iterations) => Ok((system, iterations)),
        Err(Error::NotReached { residual, allowed, iterations }) => {
            let start = commanded_guess(mechanism, commands);
            let length = system.characteristic_length();
            let couplings = contradicted(system.kinematics(), length, &start, &held)?;
            Err(if couplings.is_empty() {
                Error::NotReached { residual, allowed, iterations }
            } else {
                Error::NotRelieved { residual, allowed, couplings }
            })
        }
        Err(error) => Err(error),
    }
}

/// The relief from one configuration.
pub(super) fn relieve_from(
    mechanism: &Mechanism,
    home: &Closure,
    commands: &[(usize, f64)],
) -> Result<Relief, Error> {
    let home = home.coordinates.clone();
    let (coordinates, values): (Vec<usize>, Vec<f64>) = commands.iter().copied().unzip();
    let commanded = CommandedJoints::new(&MechanismSystem::new(mechanism, home)?, &coordinates)?;
    commanded.relieve(mechanism, values, ReliefSolver::LeastNorm)
}

impl CommandedJoints {
    /// The displacement of the virtual joints for values of the commanded coordinates, from home.
    ///
    /// # Arguments
    /// * `values` – of the commanded coordinates (m, rad)
    ///
    /// # Errors
    /// Those of [`relieve`].
    pub fn relieve(
        &self,
        mechanism: &Mechanism,
        values: impl IntoIterator<Item = f64>,
        solver: ReliefSolver,
    ) -> Result<Relief, Error> {
        relieve(&self.system(mechanism, values)?, self, solver)
    }
}
