//! Following motions from a configuration, and correcting configurations onto the constraints.

use nalgebra::{DMatrix, DVector};

use super::InstantaneousMobility;
use crate::Error;
use crate::constraint::{Configuration, NewtonLimits, ScaledSystem, System, newton_at_rank};
use crate::linalg::svd;
use crate::random::Random;

/// Scaled residual of a configuration that counts as closed.
const FOUND: f64 = 1e-14;
/// Round-off of a residual, in units of [`System::round_off`].
const RESIDUAL_ROUND_OFF: f64 = 8.0;
/// Corrections of one configuration: a constraint that touches halves the error at a time, 20 corrections from 10⁻² to 10⁻⁸.
const MAX_CORRECTIONS: usize = 60;
/// Corrections without a new least residual after which a search for a configuration ends.
const MAX_WITHOUT_GAIN: usize = 8;
/// Damping of a correction in units of the residual: the least, and the largest after which nothing is gained.
const LEAST_DAMPING: f64 = 1e-3;
const LARGEST_DAMPING: f64 = 1e8;

/// Distance for which a motion has to be followed to be finite without a search: farther than the radius of a search for branches, since it starts from the given configuration, where a motion stopped at high order violates a constraint least.
pub(super) const KEPT_RADIUS: f64 = 0.3;
/// Mismatch that no correction can remove and from which on a motion is obstructed, well above round-off: of a motion stopped at order p it is about 0.3ᵖ.
const BROKEN: f64 = 1e-12;
/// …and how much larger it has to be than the part that corrections can still reach, and than the residual of the given configuration.
const BROKEN_RATIO: f64 = 1e3;
/// Corrections with the pseudo-inverse of the given configuration, each of which gains about a factor of the radius.
const MAX_CHORDS: usize = 100;

/// Longest and shortest step of a continuation.
const LONGEST_STEP: f64 = 0.1;
const SHORTEST_STEP: f64 = 1e-9;
/// Steps of a continuation at most, the rejected ones among them.
const MAX_STEPS: usize = 200;
/// Length of a continuation that counts as a motion, in units of its first accepted step, unless it reaches [`KEPT_RADIUS`] before.
///
/// A motion stopped at order p is accepted up to the distance where p-th powers are below round-off. Its first step is at least half of that distance, so that it never reaches twice its first step.
const FAR: f64 = 16.0;
/// Corrections of one step, and their length as a share of the step.
const STEP_CORRECTIONS: usize = 8;
const LARGEST_CORRECTION: f64 = 0.3;
/// Least cosine of the angle between the directions of two steps.
const LEAST_COSINE: f64 = 0.5;
/// Effect of the round-off of a configuration on a singular value that is zero, in units of the residual over the least singular value that counts.
const NOISE: f64 = 30.0;
/// Ratio by which singular values that count have to exceed those that do not.
const GAP: f64 = 10.0;

/// Result of following some instantaneous motions in random directions.
pub(super) enum Continuation {
    /// Every direction is a finite motion; the displacements at their ends.
    Finite(Vec<DVector<f64>>),
    /// One violates constraints that no correction can restore: the dimension of the finite motions is lower by at least one.
    Obstructed,
    /// One could not be followed for the whole distance.
    Unresolved,
}

/// A random direction of a space.
pub(super) fn random_direction(random: &mut Random, count: usize) -> DVector<f64> {
    DVector::from_fn(count, |_, _| random.next()).normalize()
}

/// Follows motions from a configuration, and corrects configurations onto the constraints, in dimensionless coordinates.
pub(super) struct ConfigurationTracker<'a, S: ?Sized> {
    scaled: ScaledSystem<'a, S>,
    /// Residual of the given configuration, which counts as closed; its part in redundant constraints cannot be corrected.
    closed: DVector<f64>,
    /// Scaled residual that counts as closed.
    found: f64,
}

/// A displacement, and the tangent of the motion there.
type Stepped = (DVector<f64>, DVector<f64>);

impl<'a, S: System + ?Sized> ConfigurationTracker<'a, S> {
    pub(super) fn new(system: &'a S, at: &Configuration, characteristic_length: f64) -> Self {
        let scaled = ScaledSystem::new(system, characteristic_length);
        let closed = scaled.residual(at);
        let found = FOUND.max(RESIDUAL_ROUND_OFF * system.round_off());
        Self { scaled, closed, found }
    }

    pub(super) fn system(&self) -> &'a S {
        self.scaled.system()
    }

    pub(super) fn moved(&self, from: &Configuration, by: &DVector<f64>) -> Configuration {
        self.scaled.displaced(from, by)
    }

    fn residual(&self, at: &Configuration) -> DVector<f64> {
        self.scaled.residual(at) - &self.closed
    }

    /// Residual that counts as closed at a configuration: large coordinates are rounded more.
    fn closed_below(&self, at: &Configuration) -> f64 {
        let rounded = self.scaled.coordinate_round_off(at);
        self.found.max(rounded)
    }

    /// Follows instantaneous motions in random directions: the common case, and far cheaper than a search for branches.
    ///
    /// Corrections stay out of the null space, so that each start tests whether exactly its direction is a finite motion.
    /// The mismatch that they cannot reach is an analytic function of the start, so that one start where it is not zero shows that the finite motions have fewer dimensions.
    pub(super) fn followed(
        &self,
        at: &Configuration,
        first: &InstantaneousMobility,
        motions: &DMatrix<f64>,
        radius: f64,
    ) -> Continuation {
        let h = motions.ncols();
        let mut random = Random(2);
        let mut ends = Vec::with_capacity(h + 2);
        // Loops that are closed only so far cannot show smaller mismatches.
        let broken = BROKEN.max(100.0 * self.found).max(BROKEN_RATIO * self.closed.amax());
        for _ in 0..h + 2 {
            let direction = random_direction(&mut random, h);
            let mut displacement = motions * direction * radius;
            let mut before = f64::INFINITY;
            let mut kept = false;
            for _ in 0..MAX_CHORDS {
                let there = self.moved(at, &displacement);
                let residual = self.residual(&there);
                if residual.amax() <= self.closed_below(&there) {
                    kept = true;
                    break;
                }
                let open = first.self_stress.tr_mul(&residual);
                let closable = (&residual - &first.self_stress * &open).norm();
                if open.norm() > broken.max(BROKEN_RATIO * closable) {
                    return Continuation::Obstructed;
                }
                if closable.is_nan() || closable > 0.9 * before {
                    break;
                }
                before = closable;
                displacement -= first.decomposition.solve(&residual, first.rank);
            }
            if !kept {
                return Continuation::Unresolved;
            }
            ends.push(displacement);
        }
        Continuation::Finite(ends)
    }

    /// Follows all instantaneous motions by continuation with steps as long as the configurations allow; returns the number of directions if all continue at constant rank.
    ///
    /// For motions of short range or high curvature: the steps shrink to the scale of the motion.
    ///
    /// # Arguments
    /// * `least_cut` – singular values at or below this one count as zero
    pub(super) fn continued(
        &self,
        at: &Configuration,
        first: &InstantaneousMobility,
        least_cut: f64,
    ) -> Result<Option<usize>, Error> {
        let Some(least) = first.smallest_nonzero() else { return Ok(None) };
        let cut = least_cut.max(NOISE * self.found / least);
        if least <= GAP * cut {
            return Ok(None);
        }
        let mut random = Random(7);
        let tried = first.mobility + 2;
        for _ in 0..tried {
            let tangent = &first.null_space * random_direction(&mut random, first.mobility);
            if !self.continued_along(at, tangent, first.rank, cut)? {
                return Ok(None);
            }
        }
        Ok(Some(tried))
    }

    fn continued_along(
        &self,
        at: &Configuration,
        mut tangent: DVector<f64>,
        rank: usize,
        cut: f64,
    ) -> Result<bool, Error> {
        let mut here = DVector::zeros(tangent.len());
        let (mut step, mut first_step, mut arc) = (LONGEST_STEP, None, 0.0);
        for _ in 0..MAX_STEPS {
            let accepted = self.stepped(at, &here, &tangent, step, rank, cut)?;
            let Some((there, next)) = accepted else {
                step *= 0.5;
                if step < SHORTEST_STEP {
                    break;
                }
                continue;
            };
            let first_step = *first_step.get_or_insert(step);
            arc += step;
            (here, tangent) = (there, next);
            if here.norm() >= KEPT_RADIUS || arc >= FAR * first_step {
                return Ok(true);
            }
            step = (2.0 * step).min(LONGEST_STEP);
        }
        Ok(false)
    }

    /// A step along a tangent, corrected: where it ends and the tangent there, if the rank is still the same.
    fn stepped(
        &self,
        at: &Configuration,
        here: &DVector<f64>,
        tangent: &DVector<f64>,
        step: f64,
        rank: usize,
        cut: f64,
    ) -> Result<Option<Stepped>, Error> {
        let predicted = here + tangent * step;
        let found = newton_at_rank(
            &self.scaled,
            at,
            predicted.clone(),
            &NewtonLimits { rank, corrections: STEP_CORRECTIONS },
            |place| self.residual(place),
            |place| self.closed_below(place),
            |there| (there - &predicted).norm() <= LARGEST_CORRECTION * step,
        )?;
        let Some((there, decomposition)) = found else { return Ok(None) };
        let values = &decomposition.singular_values;
        let counted = values.iter().filter(|&&value| value > cut).count();
        if counted != rank || values[rank - 1] <= GAP * cut {
            return Ok(None);
        }
        let motions = decomposition.null_space(rank);
        let next = &motions * motions.tr_mul(tangent);
        let cosine = next.norm();
        Ok((cosine >= LEAST_COSINE).then(|| (there, next / cosine)))
    }

    /// Brings a displacement onto the constraints by damped Gauss–Newton steps of least norm; `None` if it ends farther away than `farthest`.
    ///
    /// Off the constraints redundant ones are independent by as little as the distance; damping in proportion to the residual keeps steps out of these directions.
    pub(super) fn corrected(
        &self,
        from: &Configuration,
        displacement: DVector<f64>,
        farthest: f64,
    ) -> Result<Option<DVector<f64>>, Error> {
        let found = self.descended(from, displacement, None)?;
        Ok(found.filter(|displacement| displacement.norm() <= farthest))
    }

    /// Brings a displacement onto the constraints at a given distance from the configuration.
    ///
    /// Where second order has as many conditions as there are motions, Gauss–Newton steps halve a displacement and end at the given configuration, unless its length is kept.
    pub(super) fn at_distance(
        &self,
        from: &Configuration,
        displacement: &DVector<f64>,
        distance: f64,
    ) -> Result<Option<DVector<f64>>, Error> {
        let start = displacement * (distance / displacement.norm());
        self.descended(from, start, Some(distance))
    }

    /// Damped Gauss–Newton steps, on the sphere of a distance if one is given.
    fn descended(
        &self,
        from: &Configuration,
        mut displacement: DVector<f64>,
        distance: Option<f64>,
    ) -> Result<Option<DVector<f64>>, Error> {
        let mut at = self.moved(from, &displacement);
        let mut residual = self.residual(&at);
        let (mut least, mut without_gain, mut damping_factor) = (f64::INFINITY, 0, 1.0);
        for _ in 0..MAX_CORRECTIONS {
            let size = residual.amax();
            if size <= self.closed_below(&at) {
                return Ok(Some(displacement));
            }
            without_gain = if size < 0.9 * least { 0 } else { without_gain + 1 };
            least = least.min(size);
            if without_gain > MAX_WITHOUT_GAIN || !displacement.norm().is_finite() {
                break;
            }
            let mut jacobian = self.scaled.jacobian(&at);
            if distance.is_some() {
                // Steps stay in the tangent plane of the sphere.
                let outward = displacement.normalize();
                jacobian -= &jacobian * &outward * outward.transpose();
            }
            let decomposition = svd(&jacobian)?;
            let before = residual.norm();
            loop {
                let damping = (damping_factor * before).min(1.0);
                let mut there = &displacement - decomposition.solve_damped(&residual, damping);
                if let Some(distance) = distance {
                    there *= distance / there.norm();
                }
                let place = self.moved(from, &there);
                let reached = self.residual(&place);
                if reached.norm() < before {
                    (displacement, at, residual) = (there, place, reached);
                    damping_factor = (0.1 * damping_factor).max(LEAST_DAMPING);
                    break;
                }
                damping_factor *= 10.0;
                if damping_factor > LARGEST_DAMPING {
                    return Ok(None);
                }
            }
        }
        Ok(None)
    }
}
