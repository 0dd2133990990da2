//! Near mobility: motions that are possible if dimensions are true only to a tolerance.

use std::ops::RangeInclusive;

use nalgebra::{DMatrix, DVector};

use super::FiniteMobility;
use crate::Error;
use crate::constraint::{Configuration, Dimension, ScaledSystem, System, backtrack};
use crate::linalg::svd;
use crate::random::Random;

/// Tolerances that are taken: round-off of closures along a motion stays below the least, and dimensions off by more than a hundredth describe another mechanism.
pub const TOLERANCES: RangeInclusive<f64> = 1e-11..=1e-2;
/// Distance for which a motion is followed, in radians and characteristic lengths: 17°, or a third of the mechanism's size.
///
/// It defines what a finite motion within a tolerance is, and therefore the result: over a distance t, a constraint of singular value σ is missed by about σ t.
const RADIUS: f64 = 0.3;
/// Steps out to there: the prediction of the fitted coordinates, which is linear, misses by half the square of a step, 5e-4 times their curvature, and corrections remove that.
const STEPS: u32 = 10;
/// A motion whose residual changes direction on the path may start with a singular value larger by this factor than one along which it does not.
const TURNING_RESIDUAL: f64 = 3.0;
/// Directions with singular values up to this are followed: those that may stay within the largest tolerance, see [`largest_value_within`].
const CANDIDATES: f64 = largest_value_within(*TOLERANCES.end());
/// Singular values up to this belong to motions that are tried first, all together: those of exact dimensions.
///
/// It decides no result, only the order: the motions are taken together only if all of them stay within the least tolerance, and one by one otherwise.
const EXACT: f64 = 1e-9;
/// Random subspaces of the candidates that are followed for each number of motions, next to the one of least singular values and the enlarged one of the number before.
///
/// The least tolerance counts, so that further ones cost time, and too few may overestimate the tolerance.
const MIXTURES: usize = 2;
/// A subspace that needs no more than this many times what first order asks of the best one is taken without trying others: within the factor by which first order itself is uncertain.
const NEAR_LEAST: f64 = TURNING_RESIDUAL;
/// How often a subspace is rotated to the ends of its motions: the first rotation starts from an arbitrary mixture, the second from ends that have converged to the motions.
const REFINED: usize = 2;
/// Directions that mix those of a subspace: motions on two branches are possible one by one, but not mixed. One may by chance be on a third branch.
const MIXED: usize = 2;
/// Corrections at one step: where each only halves the residual, they take it from the largest tolerance to the least one.
const MAX_CORRECTIONS: usize = 30;
/// Longest correction, in radians and characteristic lengths: some three steps; a longer one may lead to another branch.
const LONGEST_CORRECTION: f64 = 0.1;
/// Least damping of a correction, a tenth of the least tolerance: smaller singular values move nothing, however small the residual is.
const LEAST_DAMPING: f64 = 1e-12;
/// Halvings of a correction that gains nothing: to a sixty-fourth, below which the next linearization is no other.
const MAX_HALVINGS: usize = 6;
/// A correction that leaves more than this share of the residual is the last: it is at the best fit, where the residual is orthogonal to all motions.
const STALLED: f64 = 0.99;
/// Distance at which configurations on a branch are searched for, if branches may cross at the given one: a third of [`RADIUS`], so that the motions from there pass the given configuration's neighbourhood and leave it.
const BRANCH_RADIUS: f64 = 0.1;
/// Nearer than this share of it is the given configuration found again.
const SAME_POINT: f64 = 0.3;
/// Such configurations whose motions are followed; each costs as much as the given one.
const BRANCHES: usize = 3;
/// A near miss is worth a hint up to this tolerance: about the digits that dimensions are printed with.
const HINTED: f64 = 1e-4;
/// Near misses are searched for by default up to this many coordinates: every correction of every direction decomposes a matrix with so many columns.
const DEFAULT_SEARCH_COORDINATES: usize = 64;

/// Largest singular value of a motion that may stay within a tolerance for [`RADIUS`].
///
/// In linear approximation, a motion with singular value σ misses by σ t after a distance t.
const fn largest_value_within(tolerance: f64) -> f64 {
    TURNING_RESIDUAL * tolerance / RADIUS
}

/// Motions that are possible within a tolerance, and the tolerance that they need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearMobility {
    /// Dimension of the finite motions that violate no constraint by more than the tolerance.
    pub mobility: usize,
    /// The largest mismatch along these motions: the tolerance that they need, in radians and characteristic lengths.
    pub needed: f64,
    /// Approximate tolerance that one more motion would need, in radians and characteristic lengths; `None` where none of the candidates comes near.
    pub next: Option<f64>,
    /// The tolerance, in radians and characteristic lengths.
    pub tolerance: f64,
}

/// Mobility of the mechanism, with its virtual joints held, if its dimensions are true only to a tolerance.
///
/// A motion is included if it can be followed for 0.3 (in radians and characteristic lengths) and the residual of the best fit stays within the tolerance throughout.
///
/// # Arguments
/// * `at` – a configuration that satisfies the constraints to the tolerance
/// * `tolerance` – within [`TOLERANCES`], in radians and characteristic lengths; compared with [`System::mismatch`]
///
/// # Errors
/// [`Error::Tolerance`], [`Error::NotClosed`] if the residual at `at` exceeds the tolerance, [`Error::LengthMismatch`], [`Error::NotFinite`].
///
/// # Numerics
/// The tolerance for each number of motions does not depend on the tolerance, see [`near_tolerances`]; the mobility is how many of these numbers are within it.
///
/// # Source
/// own derivation, `docs/explanation/mechanisms.md`
pub fn near_mobility<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    tolerance: f64,
) -> Result<NearMobility, Error> {
    system.check(at)?;
    check_tolerance(tolerance)?;
    let residual = system.mismatch(at);
    if residual.is_nan() || residual > tolerance {
        return Err(Error::NotClosed { residual, allowed: tolerance });
    }
    let all = near_tolerances(system, at)?;
    let mobility = all.iter().filter(|&&needed| needed <= tolerance).count();
    Ok(NearMobility {
        mobility,
        needed: mobility.checked_sub(1).map_or(residual, |last| all[last]),
        next: all.get(mobility).copied(),
        tolerance,
    })
}

/// Refuses tolerances outside [`TOLERANCES`].
pub(crate) fn check_tolerance(tolerance: f64) -> Result<(), Error> {
    if TOLERANCES.contains(&tolerance) {
        return Ok(());
    }
    let (min, max) = (*TOLERANCES.start(), *TOLERANCES.end());
    Err(Error::Tolerance { found: tolerance, min, max })
}

/// The tolerance that one motion needs, that two need together, and so on, as far as it is within [`TOLERANCES`]; in radians and characteristic lengths, never decreasing.
///
/// # Errors
/// [`Error::LengthMismatch`], [`Error::NotFinite`].
///
/// # Numerics
/// Singular vectors of the scaled Jacobian with values up to 0.1 make candidates.
/// Vectors of nearly equal values are arbitrary mixtures, so that for each number of motions several subspaces of the candidates are followed, each rotated to the ends of its motions; the least tolerance counts.
/// Each followed motion holds its direction among those of the subspace and fits all other coordinates by Gauss–Newton steps with damping in proportion to the residual: singular values below the mismatch have no effect.
/// The same is done at configurations found a tenth away, since branches may cross at the given one; all random directions are the same at every call.
pub fn near_tolerances<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
) -> Result<Vec<f64>, Error> {
    system.check(at)?;
    let follower = Follower { scaled: ScaledSystem::new(system, system.characteristic_length()) };
    let residual = system.mismatch(at);
    let (candidates, values) = follower.candidates(at)?;
    let exact = values.iter().filter(|&&value| value <= EXACT).count();
    let mut all = Vec::new();
    let first = Start { at: at.clone(), candidates };
    // Finite motions are possible within any tolerance, all of them together.
    if exact > 0 {
        let needed = follower.followed(&first.at, &first.least(exact))?;
        if needed <= *TOLERANCES.start() {
            all = vec![needed; exact];
        }
    }
    let mut starts = vec![first];
    let mut random = Random(6);
    let mut best: Option<(usize, DMatrix<f64>)> = None;
    for count in all.len() + 1..=starts[0].candidates.ncols() {
        let before = best.take();
        let mut least = f64::INFINITY;
        // Every subspace has a direction with a singular value no less than this one.
        let enough = NEAR_LEAST * (RADIUS * values[count - 1]).max(residual);
        let enough = enough.max(*TOLERANCES.start());
        let mut n = 0;
        while n < starts.len() && least > enough {
            let seed = before.as_ref().filter(|(start, _)| *start == n).map(|(_, basis)| basis);
            for basis in starts[n].subspaces(count, seed, &mut random) {
                let basis = follower.turned(&starts[n], basis)?;
                let needed = follower.followed(&starts[n].at, &basis)?.max(residual);
                if needed < least {
                    (least, best) = (needed, Some((n, basis)));
                }
                if least <= enough {
                    break;
                }
            }
            n += 1;
            // Configurations on branches are looked for once, where they can make a difference.
            if n == 1 && starts.len() == 1 && least > enough {
                let on_branches = follower.on_branches(&starts[0])?;
                starts.extend(on_branches);
            }
        }
        if least > *TOLERANCES.end() {
            break;
        }
        let last = all.last().copied().unwrap_or(residual);
        all.push(least.max(last));
    }
    Ok(all)
}

/// Start of motions, and the candidate directions.
struct Start {
    at: Configuration,
    /// (n, candidates) orthonormal directions with small singular values, those of the largest first.
    candidates: DMatrix<f64>,
}

impl Start {
    /// (n, count) the directions of the smallest singular values.
    fn least(&self, count: usize) -> DMatrix<f64> {
        self.candidates.columns(self.candidates.ncols() - count, count).into_owned()
    }

    /// Orthonormal bases of subspaces to follow, each (n, count).
    fn subspaces(
        &self,
        count: usize,
        before: Option<&DMatrix<f64>>,
        random: &mut Random,
    ) -> Vec<DMatrix<f64>> {
        let all = self.candidates.ncols();
        if count > all {
            return Vec::new();
        }
        let mut found = vec![self.least(count)];
        if count == all {
            return found;
        }
        if let Some(before) = before {
            let other = &self.candidates * DVector::from_fn(all, |_, _| random.next());
            let mut columns: Vec<DVector<f64>> =
                before.column_iter().map(|column| column.into_owned()).collect();
            columns.push(other);
            found.push(DMatrix::from_columns(&columns).qr().q());
        }
        for _ in 0..MIXTURES {
            let mixture = DMatrix::from_fn(all, count, |_, _| random.next()).qr().q();
            found.push(&self.candidates * mixture);
        }
        found
    }
}

/// Follows motions in dimensionless coordinates.
struct Follower<'a, S: ?Sized> {
    scaled: ScaledSystem<'a, S>,
}

impl<S: System + ?Sized> Follower<'_, S> {
    /// (n, candidates) orthonormal directions with small singular values, those of the largest first, and these values, the least first.
    fn candidates(&self, at: &Configuration) -> Result<(DMatrix<f64>, Vec<f64>), Error> {
        let found = self.scaled.decomposed(at)?;
        let values = &found.singular_values;
        let counted = values.iter().filter(|&&value| value > CANDIDATES).count();
        let n = found.v.ncols();
        let least = (counted..n).rev().map(|k| values.get(k).copied().unwrap_or(0.0)).collect();
        Ok((found.null_space(counted), least))
    }

    /// A subspace rotated to the ends of motions along its directions, so that a motion of 0.3 in it has length 0.3.
    fn turned(&self, start: &Start, mut basis: DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
        if basis.ncols() == start.candidates.ncols() {
            return Ok(basis);
        }
        for _ in 0..REFINED {
            let fitted = complement(&basis)?;
            let mut ends = Vec::with_capacity(basis.ncols());
            for direction in basis.column_iter() {
                let (_, end) = self.follow(&start.at, &direction.into_owned(), &fitted)?;
                ends.push(&start.candidates * start.candidates.tr_mul(&end));
            }
            let next = DMatrix::from_columns(&ends).qr().q();
            if next.iter().all(|value| value.is_finite()) {
                basis = next;
            }
        }
        Ok(basis)
    }

    /// The largest residual along some directions and mixtures of them.
    fn followed(&self, from: &Configuration, directions: &DMatrix<f64>) -> Result<f64, Error> {
        let count = directions.ncols();
        let mut largest = self.scaled.system().mismatch(from);
        let fitted = complement(directions)?;
        let mut random = Random(3);
        let mixed = if count > 1 { MIXED } else { 0 };
        for k in 0..count + mixed {
            let direction = if k < count {
                directions.column(k).into_owned()
            } else {
                directions * DVector::from_fn(count, |_, _| random.next()).normalize()
            };
            // One sense is enough: a motion may start at the end of its range. Where the first violates no constraint, the other cannot do better.
            let (mut size, _) = self.follow(from, &direction, &fitted)?;
            if size > *TOLERANCES.start() {
                size = size.min(self.follow(from, &-direction, &fitted)?.0);
            }
            largest = largest.max(size);
            if largest > *TOLERANCES.end() {
                break;
            }
        }
        Ok(largest)
    }

    /// The largest residual along one direction, and the displacement at its end.
    fn follow(
        &self,
        from: &Configuration,
        direction: &DVector<f64>,
        fitted: &DMatrix<f64>,
    ) -> Result<(f64, DVector<f64>), Error> {
        let mut largest = 0.0_f64;
        let stride = direction * (RADIUS / f64::from(STEPS));
        let mut here = DVector::zeros(direction.len());
        let mut last = stride.clone();
        for _ in 0..STEPS {
            // The previous step predicts the fitted coordinates.
            let (there, size) = self.fit(from, &here + &last, fitted)?;
            largest = largest.max(size);
            if largest > *TOLERANCES.end() {
                here = there;
                break;
            }
            last = &there - here;
            here = there;
        }
        Ok((largest, here))
    }

    /// The displacement of least residual near one, along some directions, and that residual.
    fn fit(
        &self,
        from: &Configuration,
        mut displacement: DVector<f64>,
        fitted: &DMatrix<f64>,
    ) -> Result<(DVector<f64>, f64), Error> {
        let mut at = self.scaled.displaced(from, &displacement);
        let mut residual = self.scaled.residual(&at);
        for _ in 0..MAX_CORRECTIONS {
            let round_off = self.scaled.coordinate_round_off(&at);
            if residual.amax() <= round_off.max(f64::EPSILON) {
                break;
            }
            let decomposition = svd(&(self.scaled.jacobian(&at) * fitted))?;
            let before = residual.norm();
            let damping = before.max(LEAST_DAMPING);
            let mut step = -(fitted * decomposition.solve_damped(&residual, damping));
            step *= (LONGEST_CORRECTION / step.norm()).min(1.0);
            let gain = backtrack(MAX_HALVINGS, before, |share| {
                let there = &displacement + &step * share;
                let moved = self.scaled.displaced(from, &there);
                let reached = self.scaled.residual(&moved);
                let size = reached.norm();
                ((there, moved, reached), size)
            });
            let Some(gain) = gain else { break };
            (displacement, at, residual) = gain.there;
            if gain.residual > STALLED * before {
                break;
            }
        }
        Ok((displacement, self.scaled.system().mismatch(&at)))
    }

    /// Starts off the given one that satisfy the constraints to the largest tolerance.
    fn on_branches(&self, start: &Start) -> Result<Vec<Start>, Error> {
        let candidates = &start.candidates;
        let all = DMatrix::identity(candidates.nrows(), candidates.nrows());
        let mut random = Random(4);
        let mut found = Vec::new();
        for _ in 0..candidates.ncols() + MIXED {
            let direction = DVector::from_fn(candidates.ncols(), |_, _| random.next()).normalize();
            let by = candidates * direction * BRANCH_RADIUS;
            let (displacement, size) = self.fit(&start.at, by, &all)?;
            let far = displacement.norm() / BRANCH_RADIUS;
            if size <= *TOLERANCES.end() && far > SAME_POINT && found.len() < BRANCHES {
                let at = self.scaled.displaced(&start.at, &displacement);
                let (candidates, _) = self.candidates(&at)?;
                found.push(Start { at, candidates });
            }
        }
        Ok(found)
    }
}

/// (n, n − count) orthonormal directions orthogonal to some, which are free to fit.
fn complement(directions: &DMatrix<f64>) -> Result<DMatrix<f64>, Error> {
    let (n, count) = directions.shape();
    Ok(svd(&directions.transpose())?.v.columns(count, n - count).into_owned())
}

/// Effect of a tolerance of the dimensions on the mobility.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NearMiss {
    /// More motions than for exact dimensions, within a small tolerance.
    Found {
        /// Mobility within the tolerance.
        mobility: usize,
        /// The tolerance that this mobility needs, in radians and characteristic lengths.
        needed: f64,
        /// A tolerance to pass to [`near_mobility`]: `needed`, rounded up.
        tolerance: f64,
    },
    /// Not searched for, since the mechanism has too many coordinates.
    NotSearched {
        /// How many it has.
        coordinates: usize,
        /// Largest number of coordinates that is searched.
        most: usize,
    },
}

/// Whether a tolerance of up to 1e-4 would allow more motions than exact dimensions do.
///
/// # Arguments
/// * `at`, `finite` – a closed configuration, and its finite mobility
///
/// # Errors
/// Those of [`near_tolerances`].
pub fn near_miss<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    finite: &FiniteMobility,
) -> Result<Option<NearMiss>, Error> {
    let first = &finite.instantaneous;
    // A motion that a small tolerance allows is instantaneous, or nearly so.
    let small = first.smallest_nonzero().is_some_and(|least| least <= largest_value_within(HINTED));
    if !small && finite.mobility == Some(first.mobility) {
        return Ok(None);
    }
    let coordinates = first.null_space.nrows();
    if coordinates > DEFAULT_SEARCH_COORDINATES {
        return Ok(Some(NearMiss::NotSearched { coordinates, most: DEFAULT_SEARCH_COORDINATES }));
    }
    let all = near_tolerances(system, at)?;
    let mobility = all.iter().filter(|&&needed| needed <= HINTED).count();
    // An undecided mobility is no near miss.
    if mobility <= finite.mobility.unwrap_or(finite.upper_bound) {
        return Ok(None);
    }
    let needed = all[mobility - 1];
    let digit = 10.0_f64.powf(needed.max(f64::MIN_POSITIVE).log10().floor());
    let tolerance = ((needed / digit).floor() + 1.0) * digit;
    let tolerance = tolerance.clamp(*TOLERANCES.start(), *TOLERANCES.end());
    Ok(Some(NearMiss::Found { mobility, needed, tolerance }))
}

/// A system with its loops taken as closed where they are: Φ less its value at one configuration.
///
/// This is the mechanism assembled by force, where its dimensions do not allow it to close; every analysis of closed configurations applies to it.
#[derive(Debug, Clone)]
pub struct ForcedClosure<'a, S: ?Sized> {
    system: &'a S,
    open: DVector<f64>,
}

impl<'a, S: System + ?Sized> ForcedClosure<'a, S> {
    /// The system closed at a configuration.
    pub fn new(system: &'a S, at: &Configuration) -> Self {
        Self { system, open: system.residual(at) }
    }
}

impl<S: System + ?Sized> System for ForcedClosure<'_, S> {
    fn constraint_dimensions(&self) -> Vec<Dimension> {
        self.system.constraint_dimensions()
    }

    fn coordinate_dimensions(&self) -> Vec<Dimension> {
        self.system.coordinate_dimensions()
    }

    fn virtual_joint_dimensions(&self) -> Vec<Dimension> {
        self.system.virtual_joint_dimensions()
    }

    fn characteristic_length(&self) -> f64 {
        self.system.characteristic_length()
    }

    fn round_off(&self) -> f64 {
        self.system.round_off()
    }

    fn residual(&self, at: &Configuration) -> DVector<f64> {
        self.system.residual(at) - &self.open
    }

    fn constraint_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        self.system.constraint_jacobian(at)
    }

    fn virtual_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        self.system.virtual_jacobian(at)
    }

    fn second_derivative(&self, at: &Configuration, direction: &DVector<f64>) -> DVector<f64> {
        self.system.second_derivative(at, direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{Joint, JointKind, LinearAndAngular, Mechanism, MechanismSystem};
    use crate::mobility::{RANK_THRESHOLD, finite_mobility};
    use crate::spatial::Pose;
    use nalgebra::{Rotation3, Vector3};

    /// Points at the distances 1 and 1 + `gap` from the origin, in radians: a circle, if the two are one.
    struct TwoCircles {
        gap: f64,
    }

    impl System for TwoCircles {
        fn constraint_dimensions(&self) -> Vec<Dimension> {
            vec![Dimension::Angle; 2]
        }

        fn coordinate_dimensions(&self) -> Vec<Dimension> {
            vec![Dimension::Angle; 2]
        }

        fn virtual_joint_dimensions(&self) -> Vec<Dimension> {
            Vec::new()
        }

        fn characteristic_length(&self) -> f64 {
            1.0
        }

        fn residual(&self, at: &Configuration) -> DVector<f64> {
            let distance = at.coordinates.norm();
            DVector::from_vec(vec![distance - 1.0, distance - 1.0 - self.gap])
        }

        fn constraint_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
            let radial = at.coordinates.normalize().transpose();
            DMatrix::from_rows(&[radial.clone_owned(), radial])
        }

        fn virtual_jacobian(&self, _: &Configuration) -> DMatrix<f64> {
            DMatrix::zeros(2, 0)
        }

        fn second_derivative(&self, at: &Configuration, along: &DVector<f64>) -> DVector<f64> {
            let across = along.norm_squared() - at.coordinates.normalize().dot(along).powi(2);
            DVector::from_element(2, across / at.coordinates.norm())
        }
    }

    fn at(x: f64, y: f64) -> Configuration {
        Configuration {
            coordinates: DVector::from_vec(vec![x, y]),
            virtual_joints: DVector::zeros(0),
        }
    }

    #[test]
    fn between_two_circles() {
        let gap = 1e-4;
        let near = near_mobility(&TwoCircles { gap }, &at(1.0 + gap / 2.0, 0.0), 6e-5).unwrap();
        assert_eq!((near.mobility, near.next), (1, None));
        // Midway between the circles is the best there is.
        assert!((near.needed - gap / 2.0).abs() < 1e-3 * gap, "{near:?}");
    }

    #[test]
    fn open_configurations_and_invalid_tolerances_are_refused() {
        let refused = |gap, tolerance| near_mobility(&TwoCircles { gap }, &at(1.0, 0.0), tolerance);
        assert_eq!(refused(1e-4, 1e-5), Err(Error::NotClosed { residual: 1e-4, allowed: 1e-5 }));
        for tolerance in [0.0, -1e-3, 0.1, f64::NAN, f64::INFINITY] {
            assert!(matches!(refused(0.0, tolerance), Err(Error::Tolerance { .. })), "{tolerance}");
        }
        let nowhere = near_mobility(&TwoCircles { gap: 0.0 }, &at(f64::NAN, 0.0), 1e-5);
        assert!(matches!(nowhere, Err(Error::NotFinite { .. })));
    }

    /// Four hinges in a plane, one of which tilts out of it; closed where all coordinates are zero.
    fn four_bar(tilt: f64) -> Mechanism {
        let points = [[0.0, 0.0], [0.5, 0.9], [2.6, 1.5], [3.0, 0.0]];
        let joints = points.iter().enumerate().map(|(k, &[x, y])| {
            let turn = Rotation3::new(Vector3::new(if k == 1 { tilt } else { 0.0 }, 0.0, 0.0));
            Joint {
                name: format!("j{k}"),
                kind: JointKind::Revolute,
                links: [k, (k + 1) % 4],
                frames: [Pose::from_parts(Vector3::new(x, y, 0.0).into(), turn); 2],
                actuated: false,
                guess: Vec::new(),
                limits: Vec::new(),
                clearance: LinearAndAngular::default(),
                stiffness: LinearAndAngular::default(),
            }
        });
        let links = (0..4).map(|k| format!("l{k}")).collect();
        Mechanism::new("four-bar", links, joints.collect()).unwrap()
    }

    #[test]
    fn four_bar_with_a_tilted_hinge() {
        for tilt in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
            let mechanism = four_bar(tilt);
            let system = MechanismSystem::new(&mechanism, DVector::zeros(4)).unwrap();
            let home = system.at_home();
            let finite = finite_mobility(&system, &home, RANK_THRESHOLD).unwrap();
            assert_eq!(finite.mobility, Some(0), "{tilt}");

            let near = near_mobility(&system, &home, tilt).unwrap();
            assert_eq!(near.mobility, 1, "{near:?}");
            assert!((0.05 * tilt..0.5 * tilt).contains(&near.needed), "{near:?}");

            // With too small a tolerance, the result states the tolerance needed.
            let less = near_mobility(&system, &home, 0.5 * near.needed).unwrap();
            assert_eq!(less.mobility, 0);
            assert!(less.next.is_some_and(|next| (next / near.needed - 1.0).abs() < 0.1));

            match near_miss(&system, &home, &finite).unwrap() {
                None => assert!(near.needed > HINTED, "{tilt} {near:?}"),
                Some(NearMiss::Found { mobility, needed, tolerance }) => {
                    assert_eq!((mobility, needed), (1, near.needed));
                    let found = near_mobility(&system, &home, tolerance).unwrap();
                    assert_eq!(found.mobility, 1, "{tilt} {tolerance:e}");
                }
                other => panic!("{other:?}"),
            }
        }
        let exact = four_bar(0.0);
        let system = MechanismSystem::new(&exact, DVector::zeros(4)).unwrap();
        let near = near_mobility(&system, &system.at_home(), *TOLERANCES.start()).unwrap();
        assert!(near.mobility == 1 && near.needed < 1e-14, "{near:?}");
    }
}
