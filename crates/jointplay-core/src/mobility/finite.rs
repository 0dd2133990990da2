//! Finite mobility: dimension of the set of configurations around a given one.

use super::nearby::{NearbyConfigurations, find_nearby};
use super::second_order::{SecondOrder, second_order};
use super::tracking::{ConfigurationTracker, Continuation, KEPT_RADIUS};
use super::{InstantaneousMobility, instantaneous_mobility};
use crate::Error;
use crate::constraint::{ACCEPTED_RESIDUAL, Configuration, System, scaled_residual, units};

/// Dimension of the set of configurations near one, between two bounds of different origin.
///
/// The upper bound follows from first and second derivatives, to the rank threshold, and from a residual that no correction removes; the lower bound is the dimension of configurations that were found nearby and certified numerically.
/// Where they meet, the dimension is decided.
#[derive(Debug, Clone, PartialEq)]
pub struct FiniteMobility {
    /// The dimension, or `None` where the bounds do not meet: undecided.
    pub mobility: Option<usize>,
    /// Dimension of the configurations found nearby.
    pub lower_bound: usize,
    /// Dimension that first and second order, and what was seen to break, leave room for.
    pub upper_bound: usize,
    /// The first-order analysis.
    pub instantaneous: InstantaneousMobility,
    /// The second-order analysis; `None` where it is not needed: all constraints are independent, or every instantaneous motion was found to be finite.
    pub second_order: Option<SecondOrder>,
    /// The search for configurations nearby; `None` where first order decides.
    pub nearby: Option<NearbyConfigurations>,
}

/// Finite mobility of the mechanism with its virtual joints held.
///
/// 1. Where all constraints are independent, the implicit function theorem makes every first-order motion finite.
/// 2. Where every instantaneous motion, in random directions, can be followed for a finite distance, all are finite.
/// 3. Otherwise a motion v is the start of a finite one only if sᵀ Φ''[v, v] = 0 for every self-stress s: these quadrics bound the dimension from above.
/// 4. Where a direction of step 2 breaks a constraint, at whatever order, the motions have one dimension less at least: a single one is stopped.
/// 5. Configurations near the given one are searched for from many directions; the dimension of what is found is the lower bound.
///
/// # Arguments
/// * `at` – a configuration that satisfies the constraints
/// * `relative_threshold` – as for [`instantaneous_mobility`]
///
/// # Errors
/// [`Error::NotClosed`] if Φ is not zero there, and those of [`instantaneous_mobility`].
///
/// # Numerics
/// Second order is not always enough: of several motions that are stopped at third order and beyond, step 4 takes away one dimension only; what is left is undecided, with both bounds reported.
/// The search sees a branch only where it ends on it and can follow it for a tenth of the characteristic length, so that a lower bound can be too small.
/// It is too large for a motion that is stopped at so high an order that its residual stays below the closure tolerance for the whole distance followed.
/// Deterministic: the directions are the same at every call.
///
/// # Source
/// \[ConnellyWhiteley\] for the second-order condition; the bounds are own derivation, `docs/explanation/mobility.md`
pub fn finite_mobility<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    relative_threshold: f64,
) -> Result<FiniteMobility, Error> {
    let instantaneous = instantaneous_mobility(system, at, relative_threshold)?;
    let rows = units(&system.constraint_dimensions(), instantaneous.characteristic_length);
    let residual = scaled_residual(&system.residual(at), &rows).amax();
    if residual.is_nan() || residual > ACCEPTED_RESIDUAL {
        return Err(Error::NotClosed { residual, allowed: ACCEPTED_RESIDUAL });
    }
    let by_first_order = |instantaneous: InstantaneousMobility, nearby| FiniteMobility {
        mobility: Some(instantaneous.mobility),
        lower_bound: instantaneous.mobility,
        upper_bound: instantaneous.mobility,
        instantaneous,
        second_order: None,
        nearby,
    };
    if instantaneous.redundancy == 0 || instantaneous.mobility == 0 {
        return Ok(by_first_order(instantaneous, None));
    }
    let tracker = ConfigurationTracker::new(system, at, instantaneous.characteristic_length);
    let all_finite = |tried, mobility| {
        Some(NearbyConfigurations { tried, found: tried, dimensions: vec![mobility] })
    };
    let mobility = instantaneous.mobility;
    let room = match tracker.followed(at, &instantaneous, &instantaneous.null_space, KEPT_RADIUS) {
        Continuation::Finite(tried) => {
            return Ok(by_first_order(instantaneous, all_finite(tried, mobility)));
        }
        Continuation::Obstructed => mobility - 1,
        Continuation::Unresolved => {
            match tracker.continued(at, &instantaneous, instantaneous.threshold)? {
                Some(tried) => {
                    return Ok(by_first_order(instantaneous, all_finite(tried, mobility)));
                }
                None => mobility,
            }
        }
    };
    let second_order = second_order(system, at, &instantaneous)?;
    let upper_bound = second_order.upper_bound.min(room);
    let mut nearby = find_nearby(&tracker, at, &instantaneous, &second_order, upper_bound)?;
    nearby.dimensions.retain(|&dimension| dimension <= upper_bound);
    let lower_bound = nearby.dimension();
    Ok(FiniteMobility {
        mobility: (lower_bound == upper_bound).then_some(lower_bound),
        lower_bound,
        upper_bound,
        instantaneous,
        second_order: Some(second_order),
        nearby: Some(nearby),
    })
}
