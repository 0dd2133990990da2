//! Dimensions of the branches of configurations that meet at a given one.

use super::finite::FiniteMobility;
use super::nearby::find_nearby;
use super::tracking::ConfigurationTracker;
use crate::Error;
use crate::constraint::{Configuration, System};

/// Dimensions of the branches near a configuration, as far as a search finds them: different ones, smallest first.
///
/// More than one dimension makes it a kinematotropic candidate: the mechanism may change its number of freedoms there, if the branches meet in the configuration itself.
/// Each dimension is verified numerically at a configuration of the branch, see `docs/explanation/mobility.md`.
///
/// # Arguments
/// * `at`, `found` – a configuration, and the result of [`finite_mobility`](super::finite_mobility) for it
///
/// # Errors
/// Those of [`instantaneous_mobility`](super::instantaneous_mobility).
///
/// # Numerics
/// A single dimension, without a search, where all motions of first order are finite; none where no finite motion is possible.
/// Branches on which no start ends are missing; where the finite mobility is undecided, the largest dimension bounds it from below only if its branch contains the configuration.
/// Deterministic.
pub fn branch_dimensions<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    found: &FiniteMobility,
) -> Result<Vec<usize>, Error> {
    let first = &found.instantaneous;
    let (Some(mobility), Some(second)) = (found.mobility, &found.second_order) else {
        // Undecided: the search has been made with all its starts.
        let searched = found.nearby.as_ref().map(|searched| searched.dimensions.clone());
        return Ok(searched.unwrap_or_else(|| found.mobility.into_iter().collect()));
    };
    if mobility == 0 {
        return Ok(Vec::new());
    }
    let tracker = ConfigurationTracker::new(system, at, first.characteristic_length);
    let mut all = find_nearby(&tracker, at, first, second, found.free_motions, usize::MAX)?;
    all.add(mobility);
    all.dimensions.retain(|&dimension| dimension <= mobility);
    Ok(all.dimensions)
}
