//! Branches of configurations that meet at a given one, with their dimensions.

use nalgebra::{DMatrix, DVector};

use super::instantaneous::{InstantaneousMobility, instantaneous_mobility};
use super::second_order::{SecondOrder, common_zero_near, second_order};
use super::tracking::{ConfigurationTracker, Continuation, random_direction};
use crate::Error;
use crate::constraint::{Configuration, System};
use crate::linalg::svd;
use crate::random::Random;

/// Distance from the given configuration at which branches are searched for, in radians and characteristic lengths.
const RADIUS: f64 = 1e-2;
/// Distance at which their dimension is verified: far enough out that a motion stopped at an order below 14 has ended.
const OUTER_RADIUS: f64 = 0.1;
/// Distance at which a branch has to be found again; whether it contains the given configuration is not decided.
const INNER_RADIUS: f64 = 1e-3;
/// Distance for which all directions of a branch are followed from the configuration where its dimension is verified.
const FOLLOWED_RADIUS: f64 = 0.1;
/// Singular values there below this share of the largest count as zero: where a constraint touches, a configuration is known to 10⁻⁷ only.
const NEIGHBOUR_RANK_THRESHOLD: f64 = 1e-6;
/// Displacements longer than this multiple of the distance are discarded.
const FARTHEST: f64 = 3.0;
/// Singular values of displacements below this share of the distance asked for are no motion: one stopped at order p leads to 10^(−14/p), half of the distance only from order 14 on.
const CONTINUED_SHARE: f64 = 0.5;
/// Least cosine of the angle between a direction and the displacement that it leads to.
const STRAIGHT: f64 = 0.9;
/// Starts for each motion of first order, and starts at most.
const STARTS_PER_MOTION: usize = 8;
const MAX_STARTS: usize = 96;
/// Branches of known dimensions found one after another, after which the search ends.
const ENOUGH_ALIKE: usize = 24;

/// Configurations found near a given one, and the dimensions verified there.
#[derive(Debug, Clone, PartialEq)]
pub struct NearbyConfigurations {
    /// How many directions were tried about the given configuration, up to the one that decided.
    pub tried: usize,
    /// How many of them ended on another configuration nearby.
    pub found: usize,
    /// Dimensions of the branches, each verified numerically at a configuration of the branch; different ones, smallest first.
    pub dimensions: Vec<usize>,
}

impl NearbyConfigurations {
    /// The largest verified dimension, 0 if there is none.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.dimensions.last().copied().unwrap_or(0)
    }

    pub(super) fn add(&mut self, dimension: usize) {
        if let Err(place) = self.dimensions.binary_search(&dimension) {
            self.dimensions.insert(place, dimension);
        }
    }
}

/// Continuation of the motions that are in the null space of every quadric, where a combination of the quadrics stops all others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FreeMotions {
    /// There are none, or they cannot all be continued.
    NotFinite,
    /// Random directions of them can be continued; the rank was not compared, as the second-order bound equals their number, or it is larger at the ends.
    Finite,
    /// Random directions of them can be continued, and all self-stresses persist along these motions, so that there are no other configurations nearby.
    FiniteWithPersistentSelfStress,
}

/// Continues the motions that the quadrics leave free, and compares the rank at the ends.
///
/// # Source
/// Self-stresses that persist make the configurations a critical manifold, nondegenerate across it (Morse–Bott), `docs/explanation/mobility.md`
pub(super) fn free_motions<S: System + ?Sized>(
    tracker: &ConfigurationTracker<'_, S>,
    at: &Configuration,
    first: &InstantaneousMobility,
    second: &SecondOrder,
    radius: f64,
) -> Result<FreeMotions, Error> {
    if !second.definite || second.free == 0 {
        return Ok(FreeMotions::NotFinite);
    }
    let free = &first.null_space * &second.free_motions;
    let ends = match tracker.followed(at, first, &free, radius) {
        Continuation::Finite(ends) => Some(ends),
        // The motions may curve into the ones that are stopped.
        Continuation::Obstructed | Continuation::Unresolved => {
            ends_along(tracker, at, &free, radius)?
        }
    };
    let Some(ends) = ends else { return Ok(FreeMotions::NotFinite) };
    if second.upper_bound == second.free {
        return Ok(FreeMotions::Finite);
    }
    // Round-off of an end changes singular values in proportion to the second derivatives.
    let curvature = second.quadrics.iter().map(DMatrix::amax).fold(0.0, f64::max);
    let cut = NEIGHBOUR_RANK_THRESHOLD * curvature.max(first.singular_values[0]);
    for end in &ends {
        // The rank at a random end is the largest along the motions, and near the start it is at least the one there.
        let there = instantaneous_mobility(tracker.system(), &tracker.moved(at, end), 0.0)?;
        if there.singular_values.iter().filter(|&&value| value > cut).count() != first.rank {
            return Ok(FreeMotions::Finite);
        }
    }
    Ok(FreeMotions::FiniteWithPersistentSelfStress)
}

/// Dimension of the configurations, if it is that of the motions that second order leaves free: they are finite, and there are no others.
fn decided_by_free_motions(second: &SecondOrder, free_motions: FreeMotions) -> Option<usize> {
    let are_all = match free_motions {
        FreeMotions::NotFinite => false,
        FreeMotions::Finite => second.upper_bound == second.free,
        FreeMotions::FiniteWithPersistentSelfStress => true,
    };
    are_all.then_some(second.free)
}

/// Searches for branches until one of dimension `enough` is found.
///
/// Starts are random motions of first order, and zeros of the second-order conditions near them.
/// A branch counts if it is found at three distances from the given configuration, and if its dimension is verified at the farthest of them.
pub(super) fn find_nearby<S: System + ?Sized>(
    tracker: &ConfigurationTracker<'_, S>,
    at: &Configuration,
    first: &InstantaneousMobility,
    second: &SecondOrder,
    free_motions: FreeMotions,
    enough: usize,
) -> Result<NearbyConfigurations, Error> {
    let mut found = NearbyConfigurations { tried: 0, found: 0, dimensions: Vec::new() };
    if let Some(dimension) = decided_by_free_motions(second, free_motions) {
        found.tried += dimension + 2;
        found.found += dimension + 2;
        found.add(dimension);
    }
    let (mut random, mut nothing_new) = (Random(1), 0);
    for _ in 0..(STARTS_PER_MOTION * first.mobility).min(MAX_STARTS) {
        if found.dimension() >= enough || nothing_new >= ENOUGH_ALIKE {
            break;
        }
        found.tried += 1;
        let direction = random_direction(&mut random, first.mobility);
        let mut reached = false;
        for onto_quadrics in [false, true] {
            let direction = if onto_quadrics {
                common_zero_near(&second.quadrics, direction.clone())?
            } else {
                Some(direction.clone())
            };
            let Some(direction) = direction else { continue };
            let start = &first.null_space * direction;
            let Some(branch) = tracker.at_distance(at, &start, RADIUS)? else { continue };
            reached = true;
            if let Some(dimension) = dimension_of_branch(tracker, at, &branch)? {
                let before = found.dimensions.len();
                found.add(dimension);
                nothing_new = if found.dimensions.len() > before { 0 } else { nothing_new + 1 };
                break;
            }
        }
        found.found += usize::from(reached);
    }
    Ok(found)
}

/// Dimension of the branch that a displacement leads to, if it can be verified.
fn dimension_of_branch<S: System + ?Sized>(
    tracker: &ConfigurationTracker<'_, S>,
    at: &Configuration,
    displacement: &DVector<f64>,
) -> Result<Option<usize>, Error> {
    let Some(outer) = tracker.at_distance(at, displacement, OUTER_RADIUS)? else { return Ok(None) };
    let Some(dimension) = verified_dimension(tracker, &tracker.moved(at, &outer), &outer)? else {
        return Ok(None);
    };
    Ok(tracker.at_distance(at, displacement, INNER_RADIUS)?.map(|_| dimension))
}

/// Dimension of the configurations about one off the given, if it can be verified there: all constraints are independent, or random directions of all instantaneous motions can be followed, or of all that second order leaves free.
fn verified_dimension<S: System + ?Sized>(
    tracker: &ConfigurationTracker<'_, S>,
    there: &Configuration,
    outward: &DVector<f64>,
) -> Result<Option<usize>, Error> {
    let first = instantaneous_mobility(tracker.system(), there, NEIGHBOUR_RANK_THRESHOLD)?;
    if first.mobility == 0 {
        return Ok(None);
    }
    if first.redundancy == 0 {
        return Ok(Some(first.mobility));
    }
    let broken = match tracker.followed(there, &first, &first.null_space, FOLLOWED_RADIUS) {
        Continuation::Finite(_) => return Ok(Some(first.mobility)),
        Continuation::Obstructed => true,
        Continuation::Unresolved
            if tracker.continued(there, &first, first.threshold)?.is_some() =>
        {
            return Ok(Some(first.mobility));
        }
        Continuation::Unresolved => false,
    };
    let second = second_order(tracker.system(), there, &first)?;
    let free_motions = free_motions(tracker, there, &first, &second, FOLLOWED_RADIUS)?;
    if let Some(dimension) = decided_by_free_motions(&second, free_motions) {
        return Ok(Some(dimension));
    }
    // A direction that is obstructed leaves one dimension less at most.
    let upper_bound = second.upper_bound.min(first.mobility - usize::from(broken));
    let dimension = spanned(tracker, there, outward, &first)?;
    Ok((dimension > 0 && dimension == upper_bound).then_some(dimension))
}

/// Dimension of the finite motions from a configuration: that of the displacements at the ends of random instantaneous motions, if mixtures of these displacements are finite motions too; 0 otherwise.
fn spanned<S: System + ?Sized>(
    tracker: &ConfigurationTracker<'_, S>,
    there: &Configuration,
    outward: &DVector<f64>,
    first: &InstantaneousMobility,
) -> Result<usize, Error> {
    let led = |direction: &DVector<f64>| {
        tracker.corrected(there, direction * FOLLOWED_RADIUS, FARTHEST * FOLLOWED_RADIUS)
    };
    let mut random = Random(8);
    let mixed = DMatrix::from_fn(first.mobility, first.mobility, |_, _| random.next());
    // Corrections of least norm project orthonormal directions onto the motions: singular values of one and zero.
    let mut ends = &first.null_space * svd(&mixed)?.u;
    for mut end in ends.column_iter_mut() {
        let direction = &end * 1.0_f64.copysign(end.dot(outward));
        match led(&direction)? {
            // A motion that reverses is at the end of its range.
            Some(found) if found.dot(&direction) > 0.0 => end.copy_from(&(found / FOLLOWED_RADIUS)),
            _ => end.fill(0.0),
        }
    }
    let spans = svd(&ends)?;
    let dimension = spans.singular_values.iter().filter(|&&span| span > CONTINUED_SHARE).count();
    let mut directions = spans.u.columns(0, dimension).into_owned();
    for mut direction in directions.column_iter_mut() {
        direction *= 1.0_f64.copysign(direction.dot(outward));
    }
    let led = ends_along(tracker, there, &directions, FOLLOWED_RADIUS)?;
    Ok(if led.is_some() { dimension } else { 0 })
}

/// Displacements to which random mixtures of orthonormal directions lead at some distance; `None` unless each is in about its own direction.
fn ends_along<S: System + ?Sized>(
    tracker: &ConfigurationTracker<'_, S>,
    from: &Configuration,
    directions: &DMatrix<f64>,
    radius: f64,
) -> Result<Option<Vec<DVector<f64>>>, Error> {
    let mut random = Random(9);
    let mut ends = Vec::with_capacity(directions.ncols() + 2);
    for _ in 0..directions.ncols() + 2 {
        let direction = directions * random_direction(&mut random, directions.ncols());
        let end = tracker.corrected(from, &direction * radius, FARTHEST * radius)?;
        let straight = |end: &DVector<f64>| end.dot(&direction) / end.norm() >= STRAIGHT;
        let Some(end) = end.filter(straight) else { return Ok(None) };
        ends.push(end);
    }
    Ok(Some(ends))
}
