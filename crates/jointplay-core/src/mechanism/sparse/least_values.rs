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
/// A value is settled where the gradient of its square is that of a singular vector, to this share of its square: the share to which it is known is the square of this, over the gap to the next.
const SETTLED_VALUE: f64 = 0.05;
/// Round-off of that gradient, as a share of the damping.
const ROUND_OFF: f64 = 0.1;
/// Values below this many times δ, the root of the damping, are hidden: the factor does not separate them from each other and from zero.
const HIDDEN: f64 = 1.5;
/// How often the part of larger singular values is removed from hidden vectors: each time, a third of it is left at most.
const MAX_PURIFICATIONS: usize = 30;
/// Twists of a space, unless two blocks have more.
const MAX_TWISTS: usize = 24;
/// Most motions of one block: the cost grows with their square, and with the size of the block.
const MAX_MOTIONS: usize = 100;
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
        self.solve(&mut start);
        let mut space = KrylovSpace::new(self, start.qr().q());
        let is_whole = block == self.size();
        let mut batches = 0;
        loop {
            batches += 1;
            if !is_whole {
                for _ in 0..GROWTH.div_ceil(block) {
                    space.extend(self, block)?;
                }
            }
            let mut found = space.least(block)?;
            let hidden = self.hidden(&found);
            if hidden > 0 {
                found = self.purified(found)?;
                space = KrylovSpace::new(self, found.twists.clone());
            }
            let LeastVectors { values, twists, violations } = found;
            let zeros =
                values.iter().filter(|&&value| value <= relative_threshold * largest).count();
            let is_first_settled = zeros < hidden
                || values.get(zeros).is_none_or(|value| {
                    let square = value * value;
                    let gradient = self.apply_transposed(&violations.column(zeros).into_owned());
                    let rest = (gradient - twists.column(zeros) * square).norm();
                    rest <= SETTLED_VALUE * square + ROUND_OFF * self.damping
                });
            let has_all = zeros.max(hidden) < block;
            if !has_all || is_first_settled || batches == BATCHES || is_whole {
                let is_settled = has_all && is_first_settled;
                return Ok((Spectrum { values, vectors: twists, zeros, largest }, is_settled));
            }
        }
    }

    /// Number of hidden values, see [`HIDDEN`].
    fn hidden(&self, found: &LeastVectors) -> usize {
        let least = HIDDEN * self.damping.sqrt();
        found.values.iter().filter(|&&value| value <= least).count()
    }

    /// Removes from hidden vectors the part of larger singular values, until no value becomes much smaller.
    fn purified(&self, mut found: LeastVectors) -> Result<LeastVectors, Error> {
        for _ in 0..MAX_PURIFICATIONS {
            let hidden = self.hidden(&found);
            // N⁻¹ δ² x, but from J x itself, which loses nothing.
            let mut rest =
                self.apply_transposed_all(&found.violations.columns(0, hidden).into_owned());
            self.solve(&mut rest);
            let mut twists = found.twists;
            twists.columns_mut(0, hidden).zip_apply(&rest, |x, rest| *x -= rest);
            let next = KrylovSpace::new(self, twists.qr().q()).least(found.values.len())?;
            let is_over =
                next.values.iter().zip(&found.values).all(|(next, old)| *next > 0.5 * old);
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
            left = if k == 0 { image } else { image - left * above };
            let diagonal = left.norm();
            if k > 0 {
                bidiagonal[(k - 1, k)] = above;
            }
            bidiagonal[(k, k)] = diagonal;
            if diagonal == 0.0 {
                break;
            }
            left /= diagonal;
            right = self.apply_transposed(&left) - right * diagonal;
            above = right.norm();
        }
        Ok(svd(&bidiagonal)?.singular_values[0])
    }

    fn apply_all(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        let columns: Vec<_> = x.column_iter().map(|column| self.apply(column.as_slice())).collect();
        DMatrix::from_columns(&columns)
    }

    fn apply_transposed_all(&self, y: &DMatrix<f64>) -> DMatrix<f64> {
        let columns: Vec<_> =
            y.column_iter().map(|column| self.apply_transposed(&column.into_owned())).collect();
        DMatrix::from_columns(&columns)
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
    /// The space of orthonormal twists.
    fn new(linear: &Linear, twists: DMatrix<f64>) -> Self {
        let (violations, last) = (linear.apply_all(&twists), twists.ncols());
        Self { twists, violations, last }
    }

    /// Adds what the inverse makes of the last block; beyond [`MAX_TWISTS`] only the `block` singular vectors with the least singular values are kept.
    fn extend(&mut self, linear: &Linear, block: usize) -> Result<(), Error> {
        let first = self.twists.ncols() - self.last;
        let mut next = self.twists.columns(first, self.last).into_owned();
        linear.solve(&mut next);
        let most = MAX_TWISTS.max(2 * block).min(linear.size());
        if self.twists.ncols() + self.last > most {
            let LeastVectors { twists, violations, .. } = self.least(block)?;
            (self.twists, self.violations) = (twists, violations);
        }
        // Twice: what is left of a block that the space has nearly may be round-off.
        for _ in 0..2 {
            next -= &self.twists * self.twists.tr_mul(&next);
            next = next.qr().q();
        }
        let violations = linear.apply_all(&next);
        self.last = next.ncols();
        self.twists = side_by_side(&self.twists, &next);
        self.violations = side_by_side(&self.violations, &violations);
        Ok(())
    }

    /// The `count` singular vectors of the space with the least singular values.
    fn least(&self, count: usize) -> Result<LeastVectors, Error> {
        let found = svd(&self.violations.clone().qr().r())?;
        let ascending: Vec<usize> = (0..self.twists.ncols()).rev().take(count).collect();
        let v = found.v.select_columns(&ascending);
        let value = |k: usize| found.singular_values.get(k).copied().unwrap_or(0.0);
        let values = ascending.into_iter().map(value).collect();
        Ok(LeastVectors { values, twists: &self.twists * &v, violations: &self.violations * v })
    }
}

/// Singular vectors of a space with the least singular values.
struct LeastVectors {
    /// Singular values, ascending.
    values: Vec<f64>,
    twists: DMatrix<f64>,
    /// J times the twists: how they violate the closures.
    violations: DMatrix<f64>,
}

/// The columns of two matrices.
fn side_by_side(one: &DMatrix<f64>, other: &DMatrix<f64>) -> DMatrix<f64> {
    let columns = one.column_iter().chain(other.column_iter());
    DMatrix::from_columns(&columns.collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{JointKind, Mechanism, SparseSystem, guess};

    /// A closed chain of links with joints of any directions, at a guess that need not close.
    fn chain(random: &mut Random, links: usize) -> Mechanism {
        use crate::mechanism::{Joint, LinearAndAngular};
        use crate::spatial::Pose;
        use nalgebra::{Rotation3, Translation3, Vector3};
        let mut vector = || Vector3::from_fn(|_, _| random.next());
        let joint = |k: usize, frames: [Pose; 2], kind| Joint {
            name: format!("j{k}"),
            kind,
            links: [k, (k + 1) % links],
            frames,
            actuated: false,
            guess: vec![0.0],
            limits: Vec::new(),
            clearance: LinearAndAngular::default(),
            stiffness: LinearAndAngular::default(),
        };
        let joints = (0..links).map(|k| {
            let mut frame =
                || Pose::from_parts(Translation3::from(vector()), Rotation3::new(vector() * 2.0));
            let kind = if k % 3 == 0 { JointKind::Prismatic } else { JointKind::Revolute };
            joint(k, [frame(), frame()], kind)
        });
        let joints = joints.collect();
        let links = (0..links).map(|k| format!("l{k}")).collect();
        Mechanism::new("chain", links, joints).unwrap()
    }

    #[test]
    fn least_values_are_those_of_the_dense_matrix() {
        let mut random = Random(7);
        let (mut compared, mut worst) = (0, 0.0_f64);
        for round in 0..40 {
            let mechanism = chain(&mut random, 4 + round);
            let system = SparseSystem::new(&mechanism, guess(&mechanism)).unwrap();
            let linear = system.linear(&system.held([]), 0.0).unwrap();
            let dense = linear.apply_all(&DMatrix::identity(linear.size(), linear.size()));
            let mut expected: Vec<f64> =
                svd(&dense).unwrap().singular_values.iter().copied().collect();
            expected.sort_by(f64::total_cmp);
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
