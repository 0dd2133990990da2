//! Which configurations there are nearby.

use nalgebra::{DMatrix, DVector};

use super::{FiniteMobility, InstantaneousMobility, SecondOrder, instantaneous_mobility};
use crate::Error;
use crate::constraint::{Configuration, System, scaled_jacobian, scaled_residual, units};
use crate::linalg::svd;
use crate::random::Random;

/// How far away neighbours are looked for, in units of the characteristic length: on a branch, and well off the given point.
const RADIUS: f64 = 1e-2;
/// Neighbours nearer than this share of [`RADIUS`] are the given point found again.
const SAME_POINT: f64 = 0.02;
/// How far away the neighbours of a neighbour are looked for: its branch is flat to this share of it.
const INNER_RADIUS: f64 = 1e-4;
/// Scaled residual of a neighbour that counts as found.
const FOUND: f64 = 1e-14;
/// Displacements that span less than this share of [`INNER_RADIUS`] do not count as a direction.
///
/// A constraint that is touched, not crossed, is met to [`FOUND`] 10⁻⁷ away from where it is met exactly: a share of 10⁻³.
const SPAN_THRESHOLD: f64 = 1e-2;
/// For the same reason singular values at a neighbour are known to 10⁻⁷ only; those below this share of the largest count as zero there.
const NEIGHBOUR_RANK_THRESHOLD: f64 = 1e-6;
/// Corrections of one neighbour: touched constraints halve the error at a time, 20 of them from 10⁻² to 10⁻⁸.
const MAX_CORRECTIONS: usize = 40;
/// Singular values left out of a correction, relative to the largest.
const CORRECTION_THRESHOLD: f64 = 1e-12;
/// Neighbours whose own neighbours are looked for.
const BRANCHES: usize = 3;
/// How often a neighbour of a neighbour is followed on, each time [`STRIDE`] times as far, up to 0.1: a constraint broken by the fifth power of a motion, as by a linkage that draws an almost straight line, is broken by 10⁻²⁰ at [`INNER_RADIUS`], but by 10⁻⁵ there.
const STRIDES: i32 = 3;
/// Lengthening at each stride.
const STRIDE: f64 = 10.0;
/// Directions that lead on to less than this share of the way asked for are no motion: one stopped at order p leads to 10^(−14/p), half the way only from order 11 on.
const LED_ON: f64 = 0.5;

/// How far away a motion has to be kept to count without a search: farther than a search goes, since it starts from the given point, where what is broken at high order is broken least.
const KEPT_RADIUS: f64 = 0.3;
/// Mismatch that no correction can reach, from which on a motion is broken, well above round-off: of a motion stopped at order p it is about 0.3ᵖ.
const BROKEN: f64 = 1e-12;
/// …and how much larger it has to be than what corrections can still reach, and than what is open at the start.
const OPEN_FOR_GOOD: f64 = 1e3;
/// Corrections with the pseudo-inverse of the given configuration, each of which gains about a factor of the radius.
const MAX_CHORDS: usize = 100;

/// Configurations found near a given one, and what they span.
#[derive(Debug, Clone, PartialEq)]
pub struct Neighbours {
    /// How many starts were tried about the given configuration, up to the one that decided.
    pub tried: usize,
    /// How many of them ended on another configuration nearby.
    pub found: usize,
    /// Dimension of the largest branch found: in how many directions one neighbour leads on.
    pub dimension: usize,
    /// How far it leads on in each direction in which it has neighbours, as a share of the way asked for, largest first.
    pub spans: Vec<f64>,
}

/// What becomes of some motions allowed to first order when they are followed in random directions.
pub(super) enum Followed {
    /// Every one leads on.
    Kept(Neighbours),
    /// One breaks constraints that no correction can mend: the motions that lead on are fewer, by a dimension at least.
    Broken,
    /// One could not be followed so far.
    Lost,
}

/// Follows all motions allowed to first order, without a search.
pub(super) fn followed<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    first: &InstantaneousMobility,
) -> Followed {
    Search::new(system, at, first.characteristic_length).followed(at, first, &first.null_space)
}

/// Looks for neighbours, then for the neighbours of a few of them.
///
/// The second look is what counts: where branches cross, as they may at the given point, the neighbours of the crossing span more than any branch has.
/// What it finds is followed a good way on, since near enough every constraint seems to be kept by a motion that breaks it only at high order.
pub(super) fn neighbours<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    first: &InstantaneousMobility,
    second: &SecondOrder,
    upper_bound: usize,
) -> Result<Neighbours, Error> {
    let search = Search::new(system, at, first.characteristic_length);
    // Where second order stops all other motions, what it leaves free is all that is asked for.
    if second.definite && second.free > 0 {
        let free = &first.null_space * &second.free_motions;
        if let Followed::Kept(all) = search.followed(at, first, &free) {
            return Ok(all);
        }
    }
    let mut random = Random(1);
    let mut best = Neighbours { tried: 0, found: 0, dimension: 0, spans: Vec::new() };
    for _ in 0..first.mobility + 2 {
        best.tried += 1;
        let direction = random_direction(&mut random, first.mobility);
        let start = &first.null_space * direction * RADIUS;
        let Some(displacement) = search.corrected(at, start, RADIUS)? else { continue };
        if displacement.norm() <= SAME_POINT * RADIUS {
            continue;
        }
        best.found += 1;
        if best.found > BRANCHES {
            continue;
        }
        let Some(spans) = search.branch(at, &displacement)? else { continue };
        let dimension = spans.iter().filter(|&&span| span > LED_ON).count();
        if dimension > best.dimension || best.spans.is_empty() {
            best = Neighbours { dimension, spans, ..best };
        }
        if best.dimension >= upper_bound {
            break;
        }
    }
    Ok(best)
}

/// Starts from which branches of other dimensions are looked for, for each motion to first order.
const STARTS_PER_MOTION: usize = 8;

/// Dimensions of the branches that meet at a configuration, as far as a search finds them: different ones, smallest first.
///
/// More than one make it a kinematotropic candidate: a mechanism that can change there how many freedoms it has.
///
/// # Arguments
/// * `at`, `found` – a configuration, and what [`finite_mobility`](super::finite_mobility) says of it
///
/// # Errors
/// Those of [`instantaneous_mobility`].
///
/// # Numerics
/// Many starts, each followed as [`finite_mobility`](super::finite_mobility) follows a few: for configurations that are singular, not for every one of a motion.
/// A single dimension where all motions to first order are motions for real, without a search.
/// Empty where no start ended on a branch.
/// Deterministic.
pub fn branch_dimensions<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    found: &FiniteMobility,
) -> Result<Vec<usize>, Error> {
    let first = &found.instantaneous;
    if found.mobility == Some(first.mobility) {
        return Ok(vec![first.mobility]);
    }
    let search = Search::new(system, at, first.characteristic_length);
    let mut random = Random(4);
    let mut dimensions = Vec::new();
    for _ in 0..STARTS_PER_MOTION * first.mobility {
        let start = &first.null_space * random_direction(&mut random, first.mobility) * RADIUS;
        let Some(displacement) = search.corrected(at, start, RADIUS)? else { continue };
        if displacement.norm() <= SAME_POINT * RADIUS {
            continue;
        }
        let Some(spans) = search.branch(at, &displacement)? else { continue };
        let dimension = spans.iter().filter(|&&span| span > LED_ON).count();
        if dimension > 0 && !dimensions.contains(&dimension) {
            dimensions.push(dimension);
        }
    }
    dimensions.sort_unstable();
    Ok(dimensions)
}

fn random_direction(random: &mut Random, count: usize) -> DVector<f64> {
    DVector::from_fn(count, |_, _| random.next()).normalize()
}

/// A search for configurations, in dimensionless coordinates.
struct Search<'a, S: ?Sized> {
    system: &'a S,
    rows: DVector<f64>,
    columns: DVector<f64>,
    /// Residual of the given configuration, which counts as closed; what is redundant in it could not be corrected away.
    closed: DVector<f64>,
}

impl<'a, S: System + ?Sized> Search<'a, S> {
    fn new(system: &'a S, at: &Configuration, characteristic_length: f64) -> Self {
        let rows = units(&system.constraint_dimensions(), characteristic_length);
        let columns = units(&system.coordinate_dimensions(), characteristic_length);
        let closed = scaled_residual(&system.residual(at), &rows);
        Self { system, rows, columns, closed }
    }

    fn moved(&self, from: &Configuration, displacement: &DVector<f64>) -> Configuration {
        Configuration {
            coordinates: &from.coordinates + displacement.component_mul(&self.columns),
            virtual_joints: from.virtual_joints.clone(),
        }
    }

    /// Whether every one of some motions leads on, without changing direction: the common case, and far cheaper to see than a branch is to find.
    ///
    /// Corrections keep out of the null space, so that each start asks whether its very direction is a motion; random directions fail together where any does.
    /// What corrections leave open is an analytic function of the direction and the way, so that one place where it is not zero shows that motions have fewer dimensions.
    fn followed(
        &self,
        at: &Configuration,
        first: &InstantaneousMobility,
        motions: &DMatrix<f64>,
    ) -> Followed {
        let h = motions.ncols();
        let mut random = Random(2);
        let tried = h + 2;
        // Loops that are closed only so far cannot tell what breaks less.
        let broken = BROKEN.max(OPEN_FOR_GOOD * self.closed.amax());
        for _ in 0..tried {
            let direction = random_direction(&mut random, h);
            let mut displacement = motions * direction * KEPT_RADIUS;
            let mut before = f64::INFINITY;
            let mut kept = false;
            for _ in 0..MAX_CHORDS {
                let there = self.moved(at, &displacement);
                let residual =
                    scaled_residual(&self.system.residual(&there), &self.rows) - &self.closed;
                let round_off =
                    f64::EPSILON * there.coordinates.component_div(&self.columns).amax();
                if residual.amax() <= FOUND.max(round_off) {
                    kept = true;
                    break;
                }
                let open = first.self_stress.tr_mul(&residual);
                let closable = (&residual - &first.self_stress * &open).norm();
                if open.norm() > broken.max(OPEN_FOR_GOOD * closable) {
                    return Followed::Broken;
                }
                if closable.is_nan() || closable > 0.9 * before {
                    break;
                }
                before = closable;
                displacement -= first.decomposition.solve(&residual, first.rank);
            }
            if !kept {
                return Followed::Lost;
            }
        }
        Followed::Kept(Neighbours { tried, found: tried, dimension: h, spans: vec![1.0; h] })
    }

    /// How far a branch leads on in each direction that it has, as a share of the way asked for; `None` where it ends at once.
    fn branch(
        &self,
        at: &Configuration,
        displacement: &DVector<f64>,
    ) -> Result<Option<Vec<f64>>, Error> {
        // Out to where the given point, which may be singular, is as far away as what is looked for.
        let Some(outward) = self.corrected(at, displacement * STRIDE, RADIUS * STRIDE)? else {
            return Ok(None);
        };
        let neighbour = self.moved(at, &outward);
        let there = instantaneous_mobility(self.system, &neighbour, NEIGHBOUR_RANK_THRESHOLD)?;
        // Independent constraints leave a manifold, all of whose directions lead on.
        if there.redundancy == 0 {
            return Ok(Some(vec![1.0; there.mobility]));
        }
        let close = self.around(&neighbour, &there.null_space, INNER_RADIUS)?;
        if close.is_empty() {
            return Ok(None);
        }
        let near = svd(&(DMatrix::from_columns(&close) / INNER_RADIUS))?;
        let directions = near.singular_values.iter().filter(|&&span| span > SPAN_THRESHOLD).count();
        let mut directions = near.u.columns(0, directions).into_owned();
        for mut direction in directions.column_iter_mut() {
            direction *= 1.0_f64.copysign(direction.dot(&outward));
        }
        self.led_on(&neighbour, &directions).map(Some)
    }

    /// Displacements to configurations at about `radius`, from more starts than there are motions to first order.
    fn around(
        &self,
        from: &Configuration,
        null_space: &DMatrix<f64>,
        radius: f64,
    ) -> Result<Vec<DVector<f64>>, Error> {
        let mut random = Random(1);
        let starts = (0..null_space.ncols() + 2).filter_map(|_| {
            let direction = random_direction(&mut random, null_space.ncols());
            self.corrected(from, null_space * direction * radius, radius).transpose()
        });
        starts.collect()
    }

    /// How far some orthonormal directions lead on, as shares of the way asked for: singular values, so that a combination of directions counts once.
    fn led_on(&self, from: &Configuration, directions: &DMatrix<f64>) -> Result<Vec<f64>, Error> {
        let count = directions.ncols();
        let mut ways = DMatrix::zeros(count, count);
        for (j, direction) in directions.column_iter().enumerate() {
            let mut radius = INNER_RADIUS;
            let mut displacement = Some(direction * radius);
            for _ in 0..STRIDES {
                let Some(before) = displacement else { break };
                radius *= STRIDE;
                // What turns back has come to the end of its way.
                displacement = self
                    .corrected(from, before * STRIDE, radius)?
                    .filter(|displacement| displacement.dot(&direction) > 0.0);
            }
            if let Some(displacement) = displacement {
                ways.set_column(j, &(directions.transpose() * displacement / radius));
            }
        }
        Ok(svd(&ways)?.singular_values.iter().copied().collect())
    }

    /// Brings a displacement onto the constraints by Gauss–Newton steps of least norm.
    fn corrected(
        &self,
        from: &Configuration,
        mut displacement: DVector<f64>,
        radius: f64,
    ) -> Result<Option<DVector<f64>>, Error> {
        for _ in 0..MAX_CORRECTIONS {
            let at = self.moved(from, &displacement);
            let residual = scaled_residual(&self.system.residual(&at), &self.rows) - &self.closed;
            // The share of the largest coordinate by which rounding it moves a constraint.
            let round_off = f64::EPSILON * at.coordinates.component_div(&self.columns).amax();
            if residual.amax() <= FOUND.max(round_off) {
                return Ok((displacement.norm() <= 3.0 * radius).then_some(displacement));
            }
            let jacobian =
                scaled_jacobian(&self.system.constraint_jacobian(&at), &self.rows, &self.columns);
            let decomposition = svd(&jacobian)?;
            displacement -=
                decomposition.solve(&residual, decomposition.rank(CORRECTION_THRESHOLD));
            if !displacement.norm().is_finite() {
                break;
            }
        }
        Ok(None)
    }
}
