//! The small end of the singular values of linearized closures.
//!
//! # Source
//! \[GolubVanLoan\], sections 10.1 and 10.3

use nalgebra::{DMatrix, DVector};

use super::linear::Linear;
use crate::Error;
use crate::linalg::svd;
use crate::random::Random;

/// Twists that a space grows by before its values are examined.
const GROWTH: usize = 4;
/// How often a space grows so before the next one starts with more twists.
const BATCHES: usize = 6;
/// A value is settled where the gradient of its square is that of a singular vector, to this share of its square, or the inverse of the normal equations makes of the vector a multiple of it, to this share: the share to which it is known is the square of this, over the gap to the next.
const SETTLED_VALUE: f64 = 0.05;
/// Round-off of that gradient, as a share of the damping.
const ROUND_OFF: f64 = 0.1;
/// Values below this many times δ, the root of the damping, are hidden: the factor does not separate them from each other and from zero.
const HIDDEN: f64 = 1.5;
/// Values below this share of the largest one are round-off.
const ROUND_OFF_VALUE: f64 = 4.0 * f64::EPSILON;
/// How often the part of larger singular values is removed from hidden vectors: each time, a third of it is left at most.
const MAX_PURIFICATIONS: usize = 30;
/// Twists of a space, unless two blocks have more.
const MAX_TWISTS: usize = 24;
/// Most motions of one block: the cost grows with their square, and with the size of the block.
const MAX_MOTIONS: usize = 100;
/// How often columns are made orthonormal at most; twice unless some depend on others.
const MAX_ROUNDS: usize = 6;
/// Rows of a matrix that are factored at a time.
const ROWS: usize = 64;
/// Steps of the bidiagonalization for the largest singular value, which is needed to a few per cent.
const BIDIAGONAL_STEPS: usize = 16;

/// The small end of the singular values.
pub(super) struct Spectrum {
    /// The least values, ascending: all that count as zero, and at least one more if there is one.
    pub(super) values: Vec<f64>,
    /// (6·(links − 1), values) twists of links that belong to them.
    pub(super) vectors: DMatrix<f64>,
    /// How many count as zero.
    pub(super) zeros: usize,
    pub(super) largest: f64,
}

impl Linear {
    /// Least singular values, of a block of twists that grows until one of them counts and is settled.
    pub(super) fn smallest(
        &self,
        relative_threshold: f64,
        block: usize,
    ) -> Result<Spectrum, Error> {
        let largest = self.largest()?;
        // A space that half of all twists would start is all of them at once.
        let all = self.size();
        let within = |block: usize| if 2 * block > all { all } else { block };
        let mut block = within(block);
        loop {
            let (spectrum, is_settled) = self.least(block, relative_threshold, largest)?;
            let zeros = spectrum.zeros;
            if (zeros < block && (is_settled || block > MAX_MOTIONS)) || block == all {
                return Ok(spectrum);
            }
            if zeros > MAX_MOTIONS {
                let what = "motions of joints that loops or couplings connect";
                return Err(Error::TooConnected { what, found: zeros, allowed: MAX_MOTIONS });
            }
            block = within(2 * block);
        }
    }

    /// The `block` least singular values, and whether the first of them that counts is settled: by the block Krylov space of the inverse.
    fn least(
        &self,
        block: usize,
        relative_threshold: f64,
        largest: f64,
    ) -> Result<(Spectrum, bool), Error> {
        let mut random = Random(4);
        let mut start = DMatrix::from_fn(self.size(), block, |_, _| random.next());
        self.solve(start.as_mut_slice());
        let mut space = KrylovSpace::new(self, start);
        let is_whole = block == self.size();
        let mut batches = 0;
        loop {
            batches += 1;
            if !is_whole {
                for _ in 0..GROWTH.div_ceil(block) {
                    space.extend(self, block)?;
                }
            }
            let found = space.least(block)?;
            let hidden = self.hidden(&found);
            let counts_as_zero = |value: &&f64| **value <= relative_threshold * largest;
            // The first value that counts and is not hidden.
            let first = found.values.iter().filter(counts_as_zero).count().max(hidden);
            let is_first_settled = first >= found.values.len()
                || self.is_settled(&found, first)
                || (batches == BATCHES && self.is_settled_for_inverse(&found, first));
            let has_all = first < block;
            if !has_all || is_first_settled || batches == BATCHES || is_whole {
                let LeastVectors { values, twists: vectors, .. } = self.purified(found, largest)?;
                let zeros = values.iter().filter(counts_as_zero).count();
                let is_settled = has_all && (zeros < hidden || is_first_settled);
                return Ok((Spectrum { values, vectors, zeros, largest }, is_settled));
            }
        }
    }

    /// Whether a singular vector is one, by the gradient of its square.
    fn is_settled(&self, found: &LeastVectors, index: usize) -> bool {
        let (twist, square) = (found.twists.column(index), found.values[index].powi(2));
        let violation = found.violations.column(index).into_owned();
        let rest = (self.apply_transposed(&violation) - twist * square).norm();
        rest <= SETTLED_VALUE * square + ROUND_OFF * self.damping
    }

    /// Whether a singular vector is one, by the inverse of the normal equations.
    ///
    /// Among many values that are nearly equal, such as those of a chain of gears, a small part of much larger ones stays in the vector: their gradient is large, and the inverse does not have them.
    fn is_settled_for_inverse(&self, found: &LeastVectors, index: usize) -> bool {
        let (twist, square) = (found.twists.column(index), found.values[index].powi(2));
        let mut inverse = twist.into_owned();
        self.solve(inverse.as_mut_slice());
        (inverse * (square + self.damping) - twist).norm() <= SETTLED_VALUE
    }

    /// Number of hidden values, see [`HIDDEN`].
    fn hidden(&self, found: &LeastVectors) -> usize {
        let least = HIDDEN * self.damping.sqrt();
        found.values.iter().filter(|&&value| value <= least).count()
    }

    /// Removes from hidden vectors the part of larger singular values, until no value becomes much smaller, or all are round-off.
    fn purified(&self, mut found: LeastVectors, largest: f64) -> Result<LeastVectors, Error> {
        let is_round_off = |value: f64| value <= ROUND_OFF_VALUE * largest;
        for _ in 0..MAX_PURIFICATIONS {
            let hidden = self.hidden(&found);
            if hidden == 0 {
                break;
            }
            // N⁻¹ δ² x, but from J x itself, which loses nothing.
            let violations = found.violations.column_iter().take(hidden);
            let gradients: Vec<_> = violations
                .map(|violation| self.apply_transposed(&violation.into_owned()))
                .collect();
            let mut rest = DMatrix::from_columns(&gradients);
            self.solve(rest.as_mut_slice());
            let mut twists = found.twists;
            twists.columns_mut(0, hidden).zip_apply(&rest, |x, rest| *x -= rest);
            let next = KrylovSpace::new(self, twists).least(found.values.len())?;
            let mut values = next.values.iter().zip(&found.values);
            let is_over = values.all(|(&next, old)| next > 0.5 * old || is_round_off(next));
            found = next;
            if is_over {
                break;
            }
        }
        Ok(found)
    }

    /// The largest singular value, by Golub–Kahan bidiagonalization from a random start.
    fn largest(&self) -> Result<f64, Error> {
        let mut random = Random(5);
        let mut right = DVector::from_fn(self.size(), |_, _| random.next());
        let mut left: DVector<f64> = DVector::zeros(6 * self.joints.len());
        let mut bidiagonal = DMatrix::zeros(BIDIAGONAL_STEPS, BIDIAGONAL_STEPS);
        let mut above = right.norm();
        for k in 0..BIDIAGONAL_STEPS {
            if above == 0.0 {
                break;
            }
            right /= above;
            let image = self.apply(right.as_slice());
            if k == 0 {
                left = image;
            } else {
                left *= -above;
                left += image;
            }
            let diagonal = left.norm();
            if k > 0 {
                bidiagonal[(k - 1, k)] = above;
            }
            bidiagonal[(k, k)] = diagonal;
            if diagonal == 0.0 {
                break;
            }
            left /= diagonal;
            right *= -diagonal;
            right += self.apply_transposed(&left);
            above = right.norm();
        }
        Ok(svd(&bidiagonal)?.singular_values[0])
    }
}

/// Krylov space of the inverse of the normal equations, from a few twists of links at random.
struct KrylovSpace {
    /// Orthonormal twists.
    twists: DMatrix<f64>,
    /// J times the twists: how they violate the closures.
    violations: DMatrix<f64>,
    /// Columns of the last block.
    last: usize,
}

impl KrylovSpace {
    /// The space of some twists.
    fn new(linear: &Linear, twists: DMatrix<f64>) -> Self {
        let (violations, last) = (DMatrix::zeros(linear.closures(), 0), twists.ncols());
        let mut space = Self { twists, violations, last };
        space.complete(linear);
        space
    }

    /// Adds what the inverse makes of the last block; beyond [`MAX_TWISTS`] only the `block` singular vectors with the least singular values are kept.
    fn extend(&mut self, linear: &Linear, block: usize) -> Result<(), Error> {
        let first = self.twists.ncols() - self.last;
        let mut next = self.twists.columns(first, self.last).into_owned();
        linear.solve(next.as_mut_slice());
        let most = MAX_TWISTS.max(2 * block).min(linear.size());
        if self.twists.ncols() + self.last > most {
            let LeastVectors { twists, violations, .. } = self.least(block)?;
            (self.twists, self.violations) = (twists, violations);
        }
        let kept = self.twists.ncols();
        self.twists.resize_horizontally_mut(kept + self.last, 0.0);
        self.twists.columns_mut(kept, self.last).copy_from(&next);
        self.complete(linear);
        Ok(())
    }

    /// Makes the twists whose violations are not known orthonormal, and computes these.
    fn complete(&mut self, linear: &Linear) {
        let known = self.violations.ncols();
        orthonormalize(&mut self.twists, known);
        self.violations.resize_horizontally_mut(self.twists.ncols(), 0.0);
        for k in known..self.twists.ncols() {
            let mut violations = self.violations.column_mut(k);
            linear.apply_to(self.twists.column(k).as_slice(), violations.as_mut_slice());
        }
    }

    /// The `count` singular vectors of the space with the least singular values.
    fn least(&self, count: usize) -> Result<LeastVectors, Error> {
        let found = svd(&triangle(&self.violations))?;
        let ascending: Vec<usize> = (0..self.twists.ncols()).rev().take(count).collect();
        let v = found.v.select_columns(&ascending);
        let value = |k: usize| found.singular_values.get(k).copied().unwrap_or(0.0);
        let values = ascending.into_iter().map(value).collect();
        Ok(LeastVectors { values, twists: &self.twists * &v, violations: &self.violations * v })
    }
}

/// Makes the columns from `first` on orthonormal, to each other and to those before, which are.
///
/// Columns that those before have already, to round-off, become others at random.
fn orthonormalize(columns: &mut DMatrix<f64>, first: usize) {
    let mut random = Random(6);
    let mut left = MAX_ROUNDS;
    // Twice: what is left of a block that the space has nearly may be round-off.
    let mut rounds = 2;
    while rounds > 0 && left > 0 {
        (rounds, left) = (rounds - 1, left - 1);
        let (known, mut new) = columns.columns_range_pair_mut(..first, first..);
        if first > 0 {
            let shares = known.tr_mul(&new);
            new.gemm(-1.0, &known, &shares, 1.0);
        }
        for k in 0..new.ncols() {
            let (before, mut own) = new.columns_range_pair_mut(..k, k);
            let whole = own.norm();
            for one in before.column_iter() {
                own.axpy(-one.dot(&own), &one, 1.0);
            }
            if own.norm() <= f64::EPSILON * whole {
                own.apply(|value| *value = random.next());
                rounds = 2;
            }
            let norm = own.norm();
            own /= norm;
        }
    }
}

/// R of A = Q R for a matrix with many more rows than columns, from some rows at a time: it is read once, and not copied.
///
/// # Source
/// \[GolubVanLoan\], section 5.2, for the factorization
fn triangle(a: &DMatrix<f64>) -> DMatrix<f64> {
    let mut r = DMatrix::zeros(0, a.ncols());
    for first in (0..a.nrows()).step_by(ROWS) {
        let rows = a.rows(first, ROWS.min(a.nrows() - first));
        let known = r.nrows();
        let mut both = DMatrix::zeros(known + rows.nrows(), a.ncols());
        both.rows_mut(0, known).copy_from(&r);
        both.rows_mut(known, rows.nrows()).copy_from(&rows);
        r = both.qr().r();
    }
    r
}

/// Singular vectors of a space with the least singular values.
struct LeastVectors {
    /// Singular values, ascending.
    values: Vec<f64>,
    twists: DMatrix<f64>,
    /// J times the twists: how they violate the closures.
    violations: DMatrix<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{Joint, JointKind, LinearAndAngular, Mechanism, SparseSystem, guess};
    use crate::spatial::Pose;
    use nalgebra::{Rotation3, Translation3, Vector3};

    /// A closed chain of links, whose joints are one after the other.
    fn closed(joints: impl Iterator<Item = (JointKind, [Pose; 2])>) -> Mechanism {
        let joints: Vec<_> = joints.collect();
        let count = joints.len();
        let joints = joints.into_iter().enumerate().map(|(k, (kind, frames))| Joint {
            name: format!("j{k}"),
            kind,
            links: [k, (k + 1) % count],
            frames,
            actuated: false,
            guess: vec![0.0],
            limits: Vec::new(),
            clearance: LinearAndAngular::default(),
            stiffness: LinearAndAngular::default(),
        });
        let links = (0..count).map(|k| format!("l{k}")).collect();
        Mechanism::new("chain", links, joints.collect()).unwrap()
    }

    /// A closed chain of links with joints of any directions, at a guess that need not close.
    fn chain(random: &mut Random, links: usize) -> Mechanism {
        let mut vector = || Vector3::from_fn(|_, _| random.next());
        let mut frame =
            || Pose::from_parts(Translation3::from(vector()), Rotation3::new(vector() * 2.0));
        closed((0..links).map(|k| {
            let kind = if k % 3 == 0 { JointKind::Prismatic } else { JointKind::Revolute };
            (kind, [frame(), frame()])
        }))
    }

    /// A closed chain in a plane, with axes that are off its normal by some angle.
    fn nearly_planar(random: &mut Random, links: usize, off: f64) -> Mechanism {
        let mut next = || random.next();
        let mut frame = || {
            let place = Translation3::new(next(), next(), 0.0);
            let turn = Rotation3::new(Vector3::new(off * next(), off * next(), next()));
            Pose::from_parts(place, turn)
        };
        closed((0..links).map(|_| (JointKind::Revolute, [frame(), frame()])))
    }

    /// All singular values by dense algebra, ascending.
    fn dense_values(linear: &Linear) -> Vec<f64> {
        let unit = DMatrix::identity(linear.size(), linear.size());
        let columns: Vec<_> = unit.column_iter().map(|x| linear.apply(x.as_slice())).collect();
        let found = svd(&DMatrix::from_columns(&columns)).unwrap();
        let mut values: Vec<f64> = found.singular_values.iter().copied().collect();
        values.sort_by(f64::total_cmp);
        values
    }

    #[test]
    fn small_values_are_separated_from_zeros() {
        let mut random = Random(9);
        for round in 0..60 {
            let off = 10.0_f64.powi(-3 - round % 7);
            let links = 4 + usize::try_from(round).unwrap() % 9;
            let mechanism = nearly_planar(&mut random, links, off);
            let system = SparseSystem::new(&mechanism, guess(&mechanism)).unwrap();
            let linear = system.linear(&system.held([]), 0.0, None).unwrap();
            let expected = dense_values(&linear);
            let largest = expected[expected.len() - 1];
            for threshold in [1e-5, 1e-7, 1e-12] {
                // A value at the threshold is on either side of it.
                if expected.iter().any(|value| (value / (threshold * largest) - 1.0).abs() < 0.1) {
                    continue;
                }
                let found = linear.smallest(threshold, 1 + links % 4).unwrap();
                let zeros = expected.iter().filter(|&&value| value <= threshold * largest).count();
                assert_eq!(found.zeros, zeros, "{round}, {threshold}: {expected:?}");
                for (value, expected) in found.values.iter().zip(&expected).take(zeros + 1) {
                    let difference = (value - expected).abs();
                    assert!(
                        difference <= 0.03 * expected + 1e-14,
                        "{round}, {threshold}: {value} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn least_values_are_those_of_the_dense_matrix() {
        let mut random = Random(7);
        let (mut compared, mut worst) = (0, 0.0_f64);
        for round in 0..40 {
            let mechanism = chain(&mut random, 4 + round);
            let system = SparseSystem::new(&mechanism, guess(&mechanism)).unwrap();
            let linear = system.linear(&system.held([]), 0.0, None).unwrap();
            let expected = dense_values(&linear);
            let found = linear.smallest(1e-7, 1 + round % 3).unwrap();
            let zeros = expected.iter().filter(|&&value| value <= 1e-7 * found.largest).count();
            assert_eq!(found.zeros, zeros, "{round}: {expected:?}");
            assert!((found.largest / expected.last().unwrap() - 1.0).abs() < 0.1);
            for (value, expected) in found.values.iter().zip(&expected).take(zeros) {
                assert!((value - expected).abs() < 1e-12, "{round}: {value} {expected}");
            }
            let (value, expected) = (found.values[zeros], expected[zeros]);
            worst = worst.max((value / expected - 1.0).abs());
            compared += 1;
        }
        assert!(compared == 40 && worst < 0.03, "{worst}");
    }
}
