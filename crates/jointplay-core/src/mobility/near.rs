//! Near misses: what would move if dimensions were true only to a tolerance.

use std::ops::RangeInclusive;

use nalgebra::{DMatrix, DVector};

use super::InstantaneousMobility;
use crate::Error;
use crate::constraint::{
    Configuration, Dimension, System, scaled_jacobian, scaled_residual, units,
};
use crate::linalg::svd;
use crate::random::Random;

/// Tolerances that are taken: round-off of closures along a motion stays below the least, and dimensions off by more than a hundredth describe another mechanism.
pub const TOLERANCES: RangeInclusive<f64> = 1e-11..=1e-2;
/// How far a motion is followed, in radians and characteristic lengths.
const RADIUS: f64 = 0.3;
/// Steps out to there.
const STEPS: u32 = 10;
/// Singular values up to this many tolerances are followed up.
///
/// To first order a motion with singular value σ leaves a band of ± the tolerance within [`RADIUS`] if σ exceeds 7 tolerances; one whose residual turns on the way may start a little steeper.
const CANDIDATES: f64 = 10.0;
/// Directions that mix the candidates: motions on two branches are kept one by one, but not mixed.
const MIXED: usize = 2;
/// Corrections at one step.
const MAX_CORRECTIONS: usize = 30;
/// Longest correction, in radians and characteristic lengths.
const LONGEST_CORRECTION: f64 = 0.1;
/// Damping of a correction by so much keeps out what singular values of zero would do.
const LEAST_DAMPING: f64 = 1e-12;
/// Halvings of a correction that gains nothing.
const MAX_HALVINGS: usize = 6;
/// A correction that leaves more than this share of the residual is the last.
const STALLED: f64 = 0.99;
/// Where configurations on a branch are looked for, if branches may cross at the given one.
const BRANCH_RADIUS: f64 = 0.1;
/// Nearer than this share of it is the given configuration found again.
const SAME_POINT: f64 = 0.3;
/// Such configurations whose motions are followed.
const BRANCHES: usize = 3;
/// A mechanism whose least singular value that counts is below this share of the largest may be a near miss.
const NEAR_MISS: f64 = 1e-4;

/// Motions that are kept within a tolerance, and how much of it they need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearMobility {
    /// In how many directions the mechanism goes a finite way with no constraint broken by more than the tolerance.
    pub mobility: usize,
    /// The largest mismatch on these ways: the tolerance that they need, in radians and characteristic lengths.
    pub needed: f64,
    /// About what one more motion would need, in radians and characteristic lengths; `None` where none of the candidates comes near.
    pub next: Option<f64>,
    /// The tolerance, in radians and characteristic lengths.
    pub tolerance: f64,
}

/// Mobility of the mechanism, with its virtual joints held, if its dimensions are true only to a tolerance.
///
/// A motion counts if it can be followed for 0.3 (in radians and characteristic lengths) and the residual of the best fit stays within the tolerance all the way.
///
/// # Arguments
/// * `at` – a configuration that satisfies the constraints to the tolerance
/// * `tolerance` – within [`TOLERANCES`], in radians and characteristic lengths; compared with [`System::mismatch`]
///
/// # Errors
/// [`Error::Tolerance`], [`Error::NotClosed`] if the residual at `at` exceeds the tolerance, [`Error::WrongLength`], [`Error::NotFinite`].
///
/// # Numerics
/// Singular values of the scaled Jacobian up to ten tolerances make candidates; what decides is the way.
/// Each way holds its direction among the candidates and fits all other coordinates by Gauss–Newton steps with damping in proportion to the residual: singular values below what the loops miss move nothing.
/// Where not all candidates are kept, those of configurations found a tenth away are tried as well, since branches may cross at the given one.
/// Deterministic: the directions are the same at every call.
///
/// # Source
/// own derivation, `docs/theory.md`
pub fn near_mobility<S: System + ?Sized>(
    system: &S,
    at: &Configuration,
    tolerance: f64,
) -> Result<NearMobility, Error> {
    system.check(at)?;
    if !TOLERANCES.contains(&tolerance) {
        let (min, max) = (*TOLERANCES.start(), *TOLERANCES.end());
        return Err(Error::Tolerance { found: tolerance, min, max });
    }
    let length = system.characteristic_length();
    let follower = Follower {
        system,
        rows: units(&system.constraint_dimensions(), length),
        columns: units(&system.coordinate_dimensions(), length),
        tolerance,
    };
    let residual = system.mismatch(at);
    if residual.is_nan() || residual > tolerance {
        return Err(Error::NotClosed { residual, allowed: tolerance });
    }
    let candidates = follower.candidates(at)?;
    let mut best = follower.kept(at, &candidates)?;
    if best.mobility < candidates.ncols() {
        for on_branch in follower.on_branches(at, &candidates)? {
            let mut found = follower.kept(&on_branch, &follower.candidates(&on_branch)?)?;
            found.needed = found.needed.max(residual);
            if found.mobility > best.mobility {
                best = found;
            }
        }
    }
    Ok(best)
}

/// Follows motions in dimensionless coordinates.
struct Follower<'a, S: ?Sized> {
    system: &'a S,
    rows: DVector<f64>,
    columns: DVector<f64>,
    tolerance: f64,
}

impl<S: System + ?Sized> Follower<'_, S> {
    fn residual(&self, at: &Configuration) -> DVector<f64> {
        scaled_residual(&self.system.residual(at), &self.rows)
    }

    fn jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        scaled_jacobian(&self.system.constraint_jacobian(at), &self.rows, &self.columns)
    }

    fn moved(&self, from: &Configuration, displacement: &DVector<f64>) -> Configuration {
        Configuration {
            coordinates: &from.coordinates + displacement.component_mul(&self.columns),
            virtual_joints: from.virtual_joints.clone(),
        }
    }

    /// (n, candidates) orthonormal directions with small singular values, those of the largest first.
    fn candidates(&self, at: &Configuration) -> Result<DMatrix<f64>, Error> {
        let found = svd(&self.jacobian(at))?;
        let cut = CANDIDATES * self.tolerance;
        let counted = found.singular_values.iter().filter(|&&value| value > cut).count();
        Ok(found.null_space(counted))
    }

    /// The most candidates that are kept together, the ones of smallest singular values first.
    fn kept(&self, from: &Configuration, candidates: &DMatrix<f64>) -> Result<NearMobility, Error> {
        let count = candidates.ncols();
        let found = |mobility, needed, next| NearMobility {
            mobility,
            needed,
            next,
            tolerance: self.tolerance,
        };
        let mut next = None;
        for mobility in (1..=count).rev() {
            let directions = candidates.columns(count - mobility, mobility).into_owned();
            let needed = self.followed(from, &directions)?;
            if needed <= self.tolerance {
                return Ok(found(mobility, needed, next));
            }
            next = (needed <= *TOLERANCES.end()).then_some(needed);
        }
        Ok(found(0, self.system.mismatch(from), next))
    }

    /// The largest residual on the ways along some directions and mixtures of them.
    fn followed(&self, from: &Configuration, directions: &DMatrix<f64>) -> Result<f64, Error> {
        let (n, count) = directions.shape();
        let mut largest = self.system.mismatch(from);
        // What is orthogonal to the directions is free to fit.
        let fitted = svd(&directions.transpose())?.v.columns(count, n - count).into_owned();
        let mut random = Random(3);
        let mixed = if count > 1 { MIXED } else { 0 };
        for k in 0..count + mixed {
            let direction = if k < count {
                directions.column(k).into_owned()
            } else {
                directions * DVector::from_fn(count, |_, _| random.next()).normalize()
            };
            // One sense is enough: a motion may start at the end of its range. Where the first breaks nothing, the other cannot do better.
            let mut size = self.way(from, &direction, &fitted)?;
            if size > *TOLERANCES.start() {
                size = size.min(self.way(from, &-direction, &fitted)?);
            }
            largest = largest.max(size);
            if largest > *TOLERANCES.end() {
                break;
            }
        }
        Ok(largest)
    }

    /// The largest residual on the way in one direction.
    fn way(
        &self,
        from: &Configuration,
        direction: &DVector<f64>,
        fitted: &DMatrix<f64>,
    ) -> Result<f64, Error> {
        let mut largest = 0.0_f64;
        let stride = direction * (RADIUS / f64::from(STEPS));
        let mut here = DVector::zeros(direction.len());
        let mut last = stride.clone();
        for _ in 0..STEPS {
            // The step before shows where the fitted coordinates go.
            let (there, size) = self.fit(from, &here + &last, fitted)?;
            largest = largest.max(size);
            if largest > *TOLERANCES.end() {
                break;
            }
            last = &there - here;
            here = there;
        }
        Ok(largest)
    }

    /// The displacement of least residual near one, along some directions, and that residual.
    fn fit(
        &self,
        from: &Configuration,
        mut displacement: DVector<f64>,
        fitted: &DMatrix<f64>,
    ) -> Result<(DVector<f64>, f64), Error> {
        let mut at = self.moved(from, &displacement);
        let mut residual = self.residual(&at);
        for _ in 0..MAX_CORRECTIONS {
            let round_off = f64::EPSILON * at.coordinates.component_div(&self.columns).amax();
            if residual.amax() <= round_off.max(f64::EPSILON) {
                break;
            }
            let decomposition = svd(&(self.jacobian(&at) * fitted))?;
            let before = residual.norm();
            let damping = before.max(LEAST_DAMPING);
            let mut step = -(fitted * decomposition.solve_damped(&residual, damping));
            step *= (LONGEST_CORRECTION / step.norm()).min(1.0);
            let mut gained = false;
            for _ in 0..MAX_HALVINGS {
                let there = &displacement + &step;
                let moved = self.moved(from, &there);
                let reached = self.residual(&moved);
                if reached.norm() < before {
                    (displacement, at, residual, gained) = (there, moved, reached, true);
                    break;
                }
                step *= 0.5;
            }
            if !gained || residual.norm() > STALLED * before {
                break;
            }
        }
        Ok((displacement, self.system.mismatch(&at)))
    }

    /// Configurations off the given one that satisfy the constraints to the tolerance.
    fn on_branches(
        &self,
        at: &Configuration,
        candidates: &DMatrix<f64>,
    ) -> Result<Vec<Configuration>, Error> {
        let all = DMatrix::identity(candidates.nrows(), candidates.nrows());
        let mut random = Random(4);
        let mut found = Vec::new();
        for _ in 0..candidates.ncols() + MIXED {
            let direction = DVector::from_fn(candidates.ncols(), |_, _| random.next()).normalize();
            let start = candidates * direction * BRANCH_RADIUS;
            let (displacement, size) = self.fit(at, start, &all)?;
            let far = displacement.norm() / BRANCH_RADIUS;
            if size <= self.tolerance && far > SAME_POINT && found.len() < BRANCHES {
                found.push(self.moved(at, &displacement));
            }
        }
        Ok(found)
    }
}

/// A singular value that counts, but so little that dimensions true to a tolerance might not tell it from zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearMiss {
    /// The least singular value that counts, as a share of the largest.
    pub share: f64,
    /// A tolerance at which it makes a candidate: the next power of ten.
    pub tolerance: f64,
}

impl InstantaneousMobility {
    /// Whether one more motion is hindered so little that [`near_mobility`] should be asked.
    #[must_use]
    pub fn near_miss(&self) -> Option<NearMiss> {
        let least = self.smallest_counted()?;
        let share = least / self.singular_values[0];
        let tolerance = 10.0_f64.powf(least.log10().ceil());
        (share < NEAR_MISS).then_some(NearMiss {
            share,
            tolerance: tolerance.clamp(*TOLERANCES.start(), *TOLERANCES.end()),
        })
    }
}

/// A system with its loops taken as closed where they are: Φ less its value at one configuration.
///
/// This is the mechanism put together by force, where dimensions do not let it close by itself; every analysis of closed configurations applies to it.
#[derive(Debug, Clone)]
pub struct ClosedThere<'a, S: ?Sized> {
    system: &'a S,
    open: DVector<f64>,
}

impl<'a, S: System + ?Sized> ClosedThere<'a, S> {
    /// The system closed at a configuration.
    pub fn new(system: &'a S, at: &Configuration) -> Self {
        Self { system, open: system.residual(at) }
    }
}

impl<S: System + ?Sized> System for ClosedThere<'_, S> {
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
    use crate::mechanism::{Joint, JointKind, Mechanism, MechanismSystem, Play};
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
    fn what_is_refused() {
        let refused = |gap, tolerance| near_mobility(&TwoCircles { gap }, &at(1.0, 0.0), tolerance);
        assert_eq!(refused(1e-4, 1e-5), Err(Error::NotClosed { residual: 1e-4, allowed: 1e-5 }));
        for tolerance in [0.0, -1e-3, 0.1, f64::NAN, f64::INFINITY] {
            assert!(matches!(refused(0.0, tolerance), Err(Error::Tolerance { .. })), "{tolerance}");
        }
        let nowhere = near_mobility(&TwoCircles { gap: 0.0 }, &at(f64::NAN, 0.0), 1e-5);
        assert!(matches!(nowhere, Err(Error::NotFinite { .. })));
    }

    /// Four hinges in a plane, one of which leans out of it; closed where all coordinates are zero.
    fn four_bar(lean: f64) -> Mechanism {
        let points = [[0.0, 0.0], [0.5, 0.9], [2.6, 1.5], [3.0, 0.0]];
        let joints = points.iter().enumerate().map(|(k, &[x, y])| {
            let turn = Rotation3::new(Vector3::new(if k == 1 { lean } else { 0.0 }, 0.0, 0.0));
            Joint {
                name: format!("j{k}"),
                kind: JointKind::Revolute,
                links: [k, (k + 1) % 4],
                frames: [Pose::from_parts(Vector3::new(x, y, 0.0).into(), turn); 2],
                actuated: false,
                guess: Vec::new(),
                limits: Vec::new(),
                clearance: Play::default(),
                stiffness: Play::default(),
            }
        });
        let links = (0..4).map(|k| format!("l{k}")).collect();
        Mechanism::new("four-bar", links, joints.collect()).unwrap()
    }

    #[test]
    fn four_bar_with_a_leaning_hinge() {
        for lean in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
            let mechanism = four_bar(lean);
            let system = MechanismSystem::new(&mechanism, DVector::zeros(4)).unwrap();
            let home = system.at_home();
            let finite = finite_mobility(&system, &home, RANK_THRESHOLD).unwrap();
            assert_eq!(finite.mobility, Some(0), "{lean}");

            let near = near_mobility(&system, &home, lean).unwrap();
            assert_eq!(near.mobility, 1, "{near:?}");
            assert!((0.05 * lean..0.5 * lean).contains(&near.needed), "{near:?}");

            // Too little of a tolerance: how much it takes is told.
            let less = near_mobility(&system, &home, 0.5 * near.needed).unwrap();
            assert_eq!(less.mobility, 0);
            assert!(less.next.is_some_and(|next| (next / near.needed - 1.0).abs() < 0.1));

            let suggested = finite.instantaneous.near_miss();
            match suggested {
                None => assert!(lean > NEAR_MISS),
                Some(NearMiss { share, tolerance }) => {
                    assert!(share < NEAR_MISS);
                    let found = near_mobility(&system, &home, tolerance).unwrap();
                    assert_eq!(found.mobility, 1, "{lean} {suggested:?}");
                }
            }
        }
        let exact = four_bar(0.0);
        let system = MechanismSystem::new(&exact, DVector::zeros(4)).unwrap();
        let near = near_mobility(&system, &system.at_home(), *TOLERANCES.start()).unwrap();
        assert!(near.mobility == 1 && near.needed < 1e-14, "{near:?}");
    }
}
