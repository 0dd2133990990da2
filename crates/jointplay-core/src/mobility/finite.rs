//! Finite mobility: dimension of the set of configurations around a given one.

use super::nearby::{FreeMotions, NearbyConfigurations, find_nearby, free_motions};
use super::second_order::{SecondOrder, second_order};
use super::tracking::{ConfigurationTracker, Continuation, KEPT_RADIUS};
use super::{InstantaneousMobility, instantaneous_mobility};
use crate::Error;
use crate::constraint::{ACCEPTED_RESIDUAL, Configuration, System, scaled_residual, units};

/// Origin of a bound of the finite mobility, from the strongest to the weakest.
///
/// Every origin presumes the rank of the constraint Jacobian, which is decided by [`FiniteMobility::instantaneous`] with a threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum BoundOrigin {
    /// First order: the dimension lies between zero and the instantaneous mobility, and is the latter if all constraints are independent.
    FirstOrder,
    /// Second order: dimension of the common complex zeros of the quadrics, or 0 by prestress stability.
    SecondOrder,
    /// A closure residual that no correction removes, in a random direction.
    Residual,
    /// Motions in random directions from the configuration, followed for a finite distance.
    Continuation,
    /// Continuation of the motions that second order leaves free, with all self-stresses at its ends.
    PersistentSelfStress,
    /// Branch found nearby; whether it contains the configuration is not decided.
    NearbyBranch,
}

impl BoundOrigin {
    /// Whether the bound is proved up to the thresholds of ranks, and does not rest on random directions, residuals or a search.
    #[must_use]
    pub fn is_proof(self) -> bool {
        matches!(self, Self::FirstOrder | Self::SecondOrder)
    }
}

/// Dimension of the set of configurations near one, between two bounds with their origins.
///
/// Where the bounds are equal, the dimension is decided, with the evidence of the weaker of the two origins.
#[derive(Debug, Clone, PartialEq)]
pub struct FiniteMobility {
    /// The dimension, or `None` where the bounds differ: undecided.
    pub mobility: Option<usize>,
    /// Dimension of the finite motions or of the branch that were found.
    pub lower_bound: usize,
    /// Origin of the lower bound.
    pub lower_bound_origin: BoundOrigin,
    /// Largest dimension that first and second order, obstructed directions and persistent self-stresses admit.
    pub upper_bound: usize,
    /// Origin of the upper bound.
    pub upper_bound_origin: BoundOrigin,
    /// The first-order analysis.
    pub instantaneous: InstantaneousMobility,
    /// The second-order analysis; `None` where it is not needed: all constraints are independent, or every instantaneous motion was found to be finite.
    pub second_order: Option<SecondOrder>,
    /// Continuation of the motions that second order leaves free.
    pub free_motions: FreeMotions,
    /// The search for configurations nearby; `None` where first order decides.
    pub nearby: Option<NearbyConfigurations>,
}

impl FiniteMobility {
    /// Whether the finite mobility is decided and both bounds are proved up to the thresholds of ranks; otherwise it rests on numerical evidence.
    #[must_use]
    pub fn is_proved(&self) -> bool {
        self.mobility.is_some()
            && self.lower_bound_origin.is_proof()
            && self.upper_bound_origin.is_proof()
    }

    /// Every instantaneous motion is finite.
    fn all_motions(
        instantaneous: InstantaneousMobility,
        origin: BoundOrigin,
        nearby: Option<NearbyConfigurations>,
    ) -> Self {
        Self {
            mobility: Some(instantaneous.mobility),
            lower_bound: instantaneous.mobility,
            lower_bound_origin: origin,
            upper_bound: instantaneous.mobility,
            upper_bound_origin: BoundOrigin::FirstOrder,
            instantaneous,
            second_order: None,
            free_motions: FreeMotions::NotFinite,
            nearby,
        }
    }
}

/// Finite mobility of the mechanism with its virtual joints held.
///
/// 1. Where all constraints are independent, the implicit function theorem makes every first-order motion finite.
/// 2. Where every instantaneous motion, in random directions, can be followed for a finite distance, all are taken as finite.
/// 3. Otherwise a motion v is the start of a finite one only if sᵀ Φ''[v, v] = 0 for every self-stress s: the complex dimension of these quadrics bounds the dimension from above.
/// 4. If a combination of the quadrics is positive on all motions but a subspace, which can be continued with all self-stresses, the dimension is that of the subspace.
/// 5. Where a direction of step 2 is obstructed, at whatever order, the motions have one dimension less at least: a single one is stopped.
/// 6. Configurations near the given one are searched for from many directions; the dimension of what is found is the lower bound.
///
/// # Arguments
/// * `at` – a configuration that satisfies the constraints
/// * `relative_threshold` – as for [`instantaneous_mobility`]
///
/// # Errors
/// [`Error::NotClosed`] if Φ is not zero there, and those of [`instantaneous_mobility`].
///
/// # Numerics
/// Second order is not always enough: of several motions that are stopped at third order and beyond, step 5 excludes one dimension only; the rest is undecided, with both bounds reported.
/// The search finds a branch only where it ends on it and can follow it for a tenth of the characteristic length, so that a lower bound can be too small.
/// It is too large for a motion that is stopped at so high an order that its residual stays below the closure tolerance for the whole distance followed, and for a branch that comes within 10⁻³ of the configuration without containing it.
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
    if instantaneous.redundancy == 0 || instantaneous.mobility == 0 {
        return Ok(FiniteMobility::all_motions(instantaneous, BoundOrigin::FirstOrder, None));
    }
    let tracker = ConfigurationTracker::new(system, at, instantaneous.characteristic_length);
    let mobility = instantaneous.mobility;
    let all_finite = |instantaneous, tried| {
        let found = NearbyConfigurations { tried, found: tried, dimensions: vec![mobility] };
        FiniteMobility::all_motions(instantaneous, BoundOrigin::Continuation, Some(found))
    };
    let obstructed =
        match tracker.followed(at, &instantaneous, &instantaneous.null_space, KEPT_RADIUS) {
            Continuation::Finite(ends) => return Ok(all_finite(instantaneous, ends.len())),
            Continuation::Obstructed => true,
            Continuation::Unresolved => {
                match tracker.continued(at, &instantaneous, instantaneous.threshold)? {
                    Some(tried) => return Ok(all_finite(instantaneous, tried)),
                    None => false,
                }
            }
        };
    let second_order = second_order(system, at, &instantaneous)?;
    let free_motions = free_motions(&tracker, at, &instantaneous, &second_order, KEPT_RADIUS)?;
    let mut upper = (mobility, BoundOrigin::FirstOrder);
    let mut lower = (0, BoundOrigin::FirstOrder);
    let mut reduce = |bound, origin| {
        if bound < upper.0 {
            upper = (bound, origin);
        }
    };
    reduce(second_order.upper_bound, BoundOrigin::SecondOrder);
    if obstructed {
        reduce(mobility - 1, BoundOrigin::Residual);
    }
    if free_motions == FreeMotions::FiniteWithPersistentSelfStress {
        reduce(second_order.free, BoundOrigin::PersistentSelfStress);
    }
    if free_motions != FreeMotions::NotFinite {
        lower = (second_order.free, BoundOrigin::Continuation);
    }
    let mut nearby =
        find_nearby(&tracker, at, &instantaneous, &second_order, free_motions, upper.0)?;
    nearby.dimensions.retain(|&dimension| dimension <= upper.0);
    if nearby.dimension() > lower.0 {
        lower = (nearby.dimension(), BoundOrigin::NearbyBranch);
    }
    Ok(FiniteMobility {
        mobility: (lower.0 == upper.0).then_some(lower.0),
        lower_bound: lower.0,
        lower_bound_origin: lower.1,
        upper_bound: upper.0,
        upper_bound_origin: upper.1,
        instantaneous,
        second_order: Some(second_order),
        free_motions,
        nearby: Some(nearby),
    })
}
