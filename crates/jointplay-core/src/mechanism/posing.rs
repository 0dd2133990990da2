//! Configurations for commanded coordinates, with virtual joints displaced where rigid links do not close.

use super::closure::Closure;
use super::description::Mechanism;
use super::home::{actuators_at_guess, close, close_at_rest, close_commanded, relieve_from};
use super::relief::Relief;
use super::relieved_branch::RelievedBranch;
use super::system::MechanismSystem;
use super::unassembled::Unassembled;
use crate::Error;
use crate::constraint::{System as _, units};

/// The farthest command that is reached in steps, in radians and characteristic lengths.
const FARTHEST: f64 = 20.0;
/// Displacements of joint coordinates that are farther apart are on different branches, in radians and characteristic lengths.
const NEAR: f64 = 0.5;
/// Sizes of displacements that differ by less are equal.
const ROUND_OFF: f64 = 1e-9;

/// A closed configuration, with the displacement of the virtual joints if it needs one.
#[derive(Debug, Clone, PartialEq)]
pub struct Posed {
    /// (f + M) coordinates with the residual of the loops (m, rad).
    pub closed: Closure,
    /// The least displacement, where rigid links do not close.
    pub relief: Option<Relief>,
}

/// The closed configuration with commanded coordinates held, with virtual joints displaced if rigid links do not close.
///
/// # Arguments
/// As [`close_commanded`].
///
/// # Errors
/// Those of [`close_commanded`] and [`relieve_commanded`].
pub fn pose_commanded(
    mechanism: &Mechanism,
    commands: &[(usize, f64)],
    tolerance: Option<f64>,
) -> Result<Posed, Error> {
    if mechanism.virtual_joints().is_empty() || !MechanismSystem::fits(mechanism) {
        let closed = close_commanded(mechanism, commands, tolerance)?;
        return Ok(Posed { closed, relief: None });
    }
    if commands.is_empty() {
        return pose_at_rest(mechanism, tolerance);
    }
    // Play near the guess, rather than another configuration far from it.
    let near = |found: &Unassembled, tolerance: Option<f64>| found.within(tolerance?).cloned();
    match close(mechanism, commands, tolerance, near) {
        Err(Error::NotAssembled(_)) => {
            let home = close_at_rest(mechanism, tolerance)?;
            Ok(Posed::relieved(relieve_near(mechanism, &home, commands)?, home.is_searched))
        }
        closed => Ok(Posed { closed: closed?, relief: None }),
    }
}

/// The configuration that displacements are counted from, with the virtual joints displaced with the actuators at their guesses if rigid links do not close there.
fn pose_at_rest(mechanism: &Mechanism, tolerance: Option<f64>) -> Result<Posed, Error> {
    let home = close_at_rest(mechanism, tolerance)?;
    if home.is_closed() || tolerance.is_some_and(|tolerance| home.residual <= tolerance) {
        return Ok(Posed { closed: home, relief: None });
    }
    match relieve_near(mechanism, &home, &actuators_at_guess(mechanism)) {
        Ok(relief) => Ok(Posed::relieved(relief, false)),
        // Play does not close the near miss.
        Err(_) => {
            let closed = close_commanded(mechanism, &[], tolerance)?;
            Ok(Posed { closed, relief: None })
        }
    }
}

impl Posed {
    fn relieved(relief: Relief, is_searched: bool) -> Self {
        let closed = Closure {
            coordinates: relief.coordinates.clone(),
            residual: relief.residual,
            iterations: relief.iterations,
            is_searched,
        };
        Self { closed, relief: Some(relief) }
    }
}

/// The least displacement of the virtual joints that makes the commanded coordinates possible.
///
/// # Arguments
/// As [`close_commanded`].
///
/// # Errors
/// Those of [`close_at_rest`], of [`super::CommandedJoints::new`] and of [`super::relieve`].
pub fn relieve_commanded(
    mechanism: &Mechanism,
    commands: &[(usize, f64)],
    tolerance: Option<f64>,
) -> Result<Relief, Error> {
    relieve_near(mechanism, &close_at_rest(mechanism, tolerance)?, commands)
}

/// The relief for commands, on the branch of a configuration without commands; the least of several displacements that are least nearby, which rigid links that do not close have.
fn relieve_near(
    mechanism: &Mechanism,
    home: &Closure,
    commands: &[(usize, f64)],
) -> Result<Relief, Error> {
    let system = MechanismSystem::new(mechanism, home.coordinates.clone())?;
    let units = units(system.kinematics().dimensions(), system.characteristic_length());
    let by = |&(k, to): &(usize, f64)| ((to - home.coordinates[k]) / units[k]).abs();
    let distance = commands.iter().map(by).fold(0.0, f64::max);
    let at_once = relieve_from(mechanism, home, commands);
    if distance > FARTHEST {
        return at_once;
    }
    let (coordinates, values): (Vec<usize>, Vec<f64>) = commands.iter().copied().unzip();
    let mut branch = RelievedBranch::new(&system, &system, &coordinates)?;
    let Ok(first) = branch.first() else { return at_once };
    let Some(followed) = branch.follow(&first.coordinates, &values)? else { return at_once };
    let is_near =
        |other: &Relief| branch.distance(&followed.coordinates, &other.coordinates) < NEAR;
    let is_less = |other: &Relief| other.size < followed.size * (1.0 - ROUND_OFF);
    match at_once {
        Ok(other) if is_less(&other) && is_near(&other) => Ok(other),
        _ => Ok(followed),
    }
}
