//! Singular value decomposition: rank, null space, pseudo-inverse and least squares.
//!
//! Low rank is the usual case here, and the decomposition of the matrix library returns incorrect singular values on low-rank matrices without an error.
//! This one is correct on every rank, and its vectors are complete bases, so that a wide matrix has its null space.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::product::product;

/// Sweeps over all pairs of columns; quadratic convergence takes ten at most, also without a start.
const MAX_SWEEPS: usize = 60;

/// Product of two columns of length one that counts as zero: round-off of the product…
const PRODUCT_ROUND_OFF: f64 = 2.0 * f64::EPSILON;

/// …and the share of the longest column in the direction of one column that remains in others; below it, columns that should be zero would be rotated on and on.
const REST: f64 = 0.1 * f64::EPSILON;

/// Why a matrix has no decomposition.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinalgError {
    /// An entry of the matrix is NaN or infinite.
    #[error("an entry of the matrix is {value}, but has to be a finite number")]
    NotFinite {
        /// The first such entry.
        value: f64,
    },
    /// The singular value decomposition did not converge.
    #[error("the singular values of a {rows}×{columns} matrix did not converge")]
    SvdNotConverged {
        /// Rows of the matrix.
        rows: usize,
        /// Columns of the matrix.
        columns: usize,
    },
}

/// A full singular value decomposition.
///
/// ```text
///      A   =   U   ·  Σ  ·  Vᵀ
///    (m,n)   (m,m)  (m,n)  (n,n)
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Svd {
    /// (m,m) left singular vectors, orthonormal columns.
    pub u: DMatrix<f64>,
    /// (min(m,n)) singular values, largest first, in the unit of A.
    pub singular_values: DVector<f64>,
    /// (n,n) right singular vectors, orthonormal columns; those past the rank span the null space.
    pub v: DMatrix<f64>,
}

/// Decomposes any finite matrix.
///
/// # Errors
/// [`LinalgError::NotFinite`] for a NaN or an infinity, [`LinalgError::SvdNotConverged`] if columns are not orthogonal after sixty sweeps (never seen).
///
/// # Numerics
/// One-sided Jacobi: rotations of pairs of columns until all are orthogonal, beginning with the eigenvectors of AᵀA, which leave one to three sweeps to do.
/// Singular values are off by a few units of round-off of the largest; O(m n²), without products that depend on the processor.
/// The matrix is scaled by a power of two first, so that squares neither overflow nor vanish.
///
/// # Source
/// \[GolubVanLoan\], section 8.6
pub fn svd(a: &DMatrix<f64>) -> Result<Svd, LinalgError> {
    let (m, n) = a.shape();
    if m < n {
        let Svd { u, singular_values, v } = svd(&a.transpose()).map_err(|error| match error {
            LinalgError::SvdNotConverged { rows, columns } => {
                LinalgError::SvdNotConverged { rows: columns, columns: rows }
            }
            not_finite @ LinalgError::NotFinite { .. } => not_finite,
        })?;
        return Ok(Svd { u: v, singular_values, v: u });
    }
    if let Some(&value) = a.iter().find(|value| !value.is_finite()) {
        return Err(LinalgError::NotFinite { value });
    }
    let largest = a.amax();
    if largest == 0.0 {
        return Ok(Svd {
            u: DMatrix::identity(m, m),
            singular_values: DVector::zeros(n),
            v: DMatrix::identity(n, n),
        });
    }
    let scale = power_of_two_near(largest);
    let (columns, v) = orthogonal_columns(&(a / scale))
        .ok_or(LinalgError::SvdNotConverged { rows: m, columns: n })?;
    let lengths: Vec<f64> = columns.column_iter().map(|column| column.norm()).collect();
    let mut descending: Vec<usize> = (0..n).collect();
    descending.sort_by(|&i, &j| lengths[j].total_cmp(&lengths[i]));
    // Q R of orthogonal columns: R is Σ, and Q is a basis also where columns are zero.
    let mut transposed_u = DMatrix::identity(m, m);
    columns.select_columns(&descending).qr().q_tr_mul(&mut transposed_u);
    Ok(Svd {
        u: transposed_u.transpose(),
        singular_values: DVector::from_fn(n, |k, _| lengths[descending[k]] * scale),
        v: v.select_columns(&descending),
    })
}

/// (m,n) A V with orthogonal columns, and V (n,n), for a matrix with at least as many rows as columns; `None` after too many sweeps.
fn orthogonal_columns(a: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let n = a.ncols();
    let gram = DMatrix::from_fn(n, n, |i, j| dot(column(a, i), column(a, j)));
    let near = SymmetricEigen::try_new(gram, f64::EPSILON, MAX_SWEEPS * n);
    let mut v = near.map_or_else(|| DMatrix::identity(n, n), |near| near.eigenvectors);
    let mut columns = product(a, &v);
    for _ in 0..MAX_SWEEPS {
        let mut squares: Vec<f64> =
            (0..n).map(|k| dot(column(&columns, k), column(&columns, k))).collect();
        let largest = squares.iter().copied().fold(0.0, f64::max).sqrt();
        let mut orthogonal = true;
        for p in 0..n {
            for q in p + 1..n {
                let inner = dot(column(&columns, p), column(&columns, q));
                // Rotations change them by differences, which can be below zero.
                let [longer, shorter] = [squares[p].max(squares[q]), squares[p].min(squares[q])]
                    .map(|square| square.max(0.0).sqrt());
                if inner.abs() <= longer * (PRODUCT_ROUND_OFF * shorter + REST * largest) {
                    continue;
                }
                orthogonal = false;
                let cotangent_of_double = (squares[q] - squares[p]) / (2.0 * inner);
                let tangent = 1.0_f64.copysign(cotangent_of_double)
                    / (cotangent_of_double.abs()
                        + (1.0 + cotangent_of_double * cotangent_of_double).sqrt());
                squares[p] -= tangent * inner;
                squares[q] += tangent * inner;
                rotate(&mut columns, [p, q], tangent);
                rotate(&mut v, [p, q], tangent);
            }
        }
        if orthogonal {
            return Some((columns, v));
        }
    }
    None
}

fn column(a: &DMatrix<f64>, k: usize) -> &[f64] {
    let m = a.nrows();
    &a.as_slice()[k * m..][..m]
}

/// Product of two vectors; the order of the sum is that of wide registers, and does not depend on the processor.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let ((many_a, few_a), (many_b, few_b)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    for (a, b) in many_a.iter().zip(many_b) {
        for k in 0..8 {
            sums[k] += a[k] * b[k];
        }
    }
    for ((a, b), sum) in few_a.iter().zip(few_b).zip(&mut sums) {
        *sum += a * b;
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (b + f)) + ((c + g) + (d + h))
}

/// Rotates two columns by the angle with this tangent, the first towards the opposite of the second.
fn rotate(a: &mut DMatrix<f64>, [p, q]: [usize; 2], tangent: f64) {
    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
    let sine = cosine * tangent;
    let m = a.nrows();
    let (before, rest) = a.as_mut_slice().split_at_mut(q * m);
    for (x, y) in before[p * m..][..m].iter_mut().zip(&mut rest[..m]) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

fn power_of_two_near(value: f64) -> f64 {
    // The exponent is kept off the ends of the range, so that the scale and its inverse are both normal numbers.
    value.log2().round().clamp(-1000.0, 1000.0).exp2()
}

impl Svd {
    /// Largest singular value, 0 for an empty matrix.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.singular_values.iter().copied().next().unwrap_or(0.0)
    }

    /// How many singular values exceed `relative_threshold` times the largest.
    #[must_use]
    pub fn rank(&self, relative_threshold: f64) -> usize {
        let cut = relative_threshold * self.largest();
        self.singular_values.iter().filter(|&&value| value > cut).count()
    }

    /// (n, n − rank) orthonormal basis of the motions that A takes to zero.
    #[must_use]
    pub fn null_space(&self, rank: usize) -> DMatrix<f64> {
        self.v.columns(rank, self.v.ncols() - rank).into_owned()
    }

    /// (m, m − rank) orthonormal basis of the row combinations that vanish.
    #[must_use]
    pub fn left_null_space(&self, rank: usize) -> DMatrix<f64> {
        self.u.columns(rank, self.u.ncols() - rank).into_owned()
    }

    /// (n, m) Moore–Penrose pseudo-inverse from the first `rank` singular values.
    #[must_use]
    pub fn pseudo_inverse(&self, rank: usize) -> DMatrix<f64> {
        let mut inverse = DMatrix::zeros(self.v.nrows(), self.u.nrows());
        for k in 0..rank {
            inverse += self.v.column(k) * (self.u.column(k) / self.singular_values[k]).transpose();
        }
        inverse
    }

    /// (n) the shortest least-squares solution of A x = b, from the first `rank` singular values.
    #[must_use]
    pub fn solve(&self, b: &DVector<f64>, rank: usize) -> DVector<f64> {
        let mut x = DVector::zeros(self.v.nrows());
        for k in 0..rank {
            x.axpy(self.u.column(k).dot(b) / self.singular_values[k], &self.v.column(k), 1.0);
        }
        x
    }

    /// (n) V Σ (Σ² + damping²)⁻¹ Uᵀ b: the least-squares solution of A x = b, damped where singular values are no larger than `damping`.
    #[must_use]
    pub fn solve_damped(&self, b: &DVector<f64>, damping: f64) -> DVector<f64> {
        self.solve_damped_within(b, damping, self.singular_values.len())
    }

    /// (n) As [`solve_damped`](Self::solve_damped), from the first `rank` singular values.
    #[must_use]
    pub fn solve_damped_within(&self, b: &DVector<f64>, damping: f64, rank: usize) -> DVector<f64> {
        let mut x = DVector::zeros(self.v.nrows());
        for (k, &sigma) in self.singular_values.iter().take(rank).enumerate() {
            let share = sigma / (sigma * sigma + damping * damping);
            x.axpy(share * self.u.column(k).dot(b), &self.v.column(k), 1.0);
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::{inverse_of_three, least_norm_of_three};
    use crate::random::Random;
    use nalgebra::{Matrix3, Vector3};

    /// Round-off allowed, relative to the largest singular value: a few hundred rotations of a few units each.
    const ROUND_OFF: f64 = 1e-13;

    impl Random {
        fn matrix(&mut self, m: usize, n: usize) -> DMatrix<f64> {
            DMatrix::from_fn(m, n, |_, _| self.next())
        }

        fn orthogonal(&mut self, n: usize) -> DMatrix<f64> {
            self.matrix(n, n).qr().q()
        }

        /// A matrix with these singular values and random singular vectors.
        fn with_values(&mut self, m: usize, n: usize, values: &[f64]) -> DMatrix<f64> {
            let sigma = DMatrix::from_fn(m, n, |i, j| {
                if i == j { values.get(i).copied().unwrap_or(0.0) } else { 0.0 }
            });
            self.orthogonal(m) * sigma * self.orthogonal(n)
        }
    }

    fn near(what: &str, found: &DMatrix<f64>, expected: &DMatrix<f64>, tolerance: f64) {
        assert_eq!(found.shape(), expected.shape(), "{what}");
        let off = (found - expected).amax();
        assert!(off <= tolerance, "{what} is off by {off:e}, more than {tolerance:e}");
    }

    /// Everything that a decomposition of a matrix of known rank has to be.
    #[track_caller]
    fn check(a: &DMatrix<f64>, rank: usize) -> Svd {
        let (m, n) = a.shape();
        let found = svd(a).unwrap();
        let largest = found.largest();
        let sigma = DMatrix::from_fn(m, n, |i, j| {
            if i == j { found.singular_values[i] / largest.max(f64::MIN_POSITIVE) } else { 0.0 }
        });
        let unit = a.map(|value| value / largest.max(f64::MIN_POSITIVE));
        near("U Σ Vᵀ", &(&found.u * &sigma * found.v.transpose()), &unit, ROUND_OFF);
        near("UᵀU", &(found.u.transpose() * &found.u), &DMatrix::identity(m, m), ROUND_OFF);
        near("VᵀV", &(found.v.transpose() * &found.v), &DMatrix::identity(n, n), ROUND_OFF);
        let values = found.singular_values.as_slice();
        assert_eq!(values.len(), m.min(n));
        assert!(values.is_sorted_by(|a, b| a >= b) && values.iter().all(|&s| s >= 0.0));

        assert_eq!(found.rank(ROUND_OFF), rank, "{values:?}");
        let null_space = found.null_space(rank);
        let left = found.left_null_space(rank);
        assert_eq!((null_space.shape(), left.shape()), ((n, n - rank), (m, m - rank)));
        near("A N", &(&unit * &null_space), &DMatrix::zeros(m, n - rank), ROUND_OFF);
        near("LᵀA", &(left.transpose() * &unit), &DMatrix::zeros(m - rank, n), ROUND_OFF);
        found
    }

    #[test]
    fn the_inverse_of_a_definite_matrix_is_its_inverse() {
        let mut random = Random(7);
        for _ in 0..100 {
            let root = random.matrix(3, 3);
            let square = &root * root.transpose();
            let a = Matrix3::from_fn(|i, j| square[(i, j)]);
            let inverse = inverse_of_three(&a).unwrap();
            let condition = a.norm() * inverse.norm();
            assert!((a * inverse - Matrix3::identity()).amax() < 1e-14 * condition);
            assert_eq!(inverse_of_three(&-a), None);
        }
        let flat = Matrix3::new(1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        assert_eq!(inverse_of_three(&flat), None);
    }

    #[test]
    fn every_rank_of_every_shape() {
        let mut random = Random(1);
        for (m, n, repeats) in [(12, 18, 100), (18, 12, 100), (12, 12, 100), (3, 6, 200)] {
            for rank in 0..=m.min(n) {
                for _ in 0..repeats {
                    check(&(random.matrix(m, rank) * random.matrix(rank, n)), rank);
                }
            }
        }
    }

    #[test]
    fn rows_columns_and_nothing() {
        let mut random = Random(2);
        for n in 1..30 {
            check(&random.matrix(1, n), 1);
            check(&random.matrix(n, 1), 1);
            check(&DMatrix::zeros(1, n), 0);
            check(&DMatrix::zeros(n, 1), 0);
            check(&DMatrix::zeros(n, 0), 0);
            check(&DMatrix::zeros(0, n), 0);
        }
        let empty = check(&DMatrix::zeros(0, 0), 0);
        assert_eq!(empty.largest(), 0.0);
        assert_eq!(empty.pseudo_inverse(0).shape(), (0, 0));
    }

    #[test]
    fn known_singular_values() {
        let mut random = Random(3);
        for (m, n) in [(12, 18), (18, 12), (12, 12), (40, 40)] {
            for repeated in [false, true] {
                for _ in 0..50 {
                    let count = m.min(n) - 2;
                    let mut values: Vec<f64> = (0..count)
                        .map(|i| if repeated { [3.0, 1.0][i % 2] } else { 1.5 + random.next() })
                        .collect();
                    values.sort_by(|a, b| b.total_cmp(a));
                    let a = random.with_values(m, n, &values);
                    let found = check(&a, count);
                    // An independent result, at half the digits: eigenvalues of AᵀA.
                    let mut squares: Vec<f64> = (a.transpose() * &a)
                        .symmetric_eigen()
                        .eigenvalues
                        .iter()
                        .copied()
                        .collect();
                    squares.sort_by(|a, b| b.total_cmp(a));
                    for (k, expected) in values.iter().enumerate() {
                        assert!((found.singular_values[k] - expected).abs() < ROUND_OFF);
                        assert!((squares[k].sqrt() - expected).abs() < 1e-12);
                    }
                }
            }
        }
    }

    #[test]
    fn graded_singular_values() {
        let mut random = Random(4);
        let values: Vec<f64> = (0..12).map(|k| 10_f64.powf(-15.0 * f64::from(k) / 11.0)).collect();
        for (m, n) in [(12, 18), (18, 12), (12, 12)] {
            for _ in 0..100 {
                let found = check(&random.with_values(m, n, &values), 10);
                for (found, expected) in found.singular_values.iter().zip(&values) {
                    assert!((found - expected).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn any_scale_and_uneven_columns() {
        let mut random = Random(5);
        for _ in 0..200 {
            let a = random.matrix(12, 4) * random.matrix(4, 18);
            let expected = check(&a, 4);
            for exponent in [-300, -150, 150, 300] {
                let scale = 10_f64.powi(exponent);
                let found = check(&(&a * scale), 4);
                for k in 0..12 {
                    let off = found.singular_values[k] / scale - expected.singular_values[k];
                    assert!(off.abs() < ROUND_OFF * expected.largest());
                }
            }
            // Independent columns and rows, each with its own unit: still independent, however uneven.
            let mut uneven = random.matrix(18, 12);
            for mut column in uneven.column_iter_mut() {
                column *= 10_f64.powf(12.0 * random.next());
            }
            let found = svd(&uneven).unwrap();
            let unit = &found.u.transpose() * &found.u - DMatrix::identity(18, 18);
            assert!(unit.amax() < ROUND_OFF);
            let sigma =
                DMatrix::from_fn(
                    18,
                    12,
                    |i, j| if i == j { found.singular_values[i] } else { 0.0 },
                );
            let back = &found.u * sigma * found.v.transpose();
            assert!((back - &uneven).amax() < ROUND_OFF * uneven.amax());
        }
    }

    #[test]
    fn subnormal_and_huge_entries() {
        let mut random = Random(6);
        for scale in [f64::MIN_POSITIVE * 1e-10, f64::MIN_POSITIVE, 1e-305, 1e305] {
            // The least bits of a subnormal number are few: the rank is that of what is left of the matrix.
            let found = svd(&(random.matrix(12, 18) * scale)).unwrap();
            assert!(found.largest() > scale && found.largest() < 100.0 * scale);
            assert!(
                (found.v.transpose() * &found.v - DMatrix::identity(18, 18)).amax() < ROUND_OFF
            );
        }
        let least = f64::from_bits(1);
        assert_eq!(svd(&DMatrix::from_element(1, 1, least)).unwrap().largest(), least);
        assert_eq!(svd(&DMatrix::from_element(2, 2, 0.25 * f64::MAX)).unwrap().rank(0.1), 1);
    }

    /// Recorded on a processor with AVX-512; nothing that decides these digits is chosen where the program runs.
    #[test]
    fn all_processors_compute_the_same_bits() {
        let mut random = Random(11);
        let mut bits = 0_u64;
        for (m, n, rank) in [(12, 3, 3), (12, 18, 7), (40, 31, 30)] {
            // Repeated, and not multiplied: products depend on the processor.
            let columns = random.matrix(m, rank);
            let found = check(&DMatrix::from_fn(m, n, |i, j| columns[(i, j % rank)]), rank);
            for value in found.singular_values.iter().chain(&found.u).chain(&found.v) {
                bits = bits.rotate_left(5) ^ value.to_bits();
            }
        }
        assert_eq!(bits, 0x5755_2b5f_d52e_c655, "{bits:#x}");
    }

    #[test]
    fn non_finite_entries_are_refused() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut a = DMatrix::identity(3, 4);
            a[(2, 1)] = value;
            let error = svd(&a).unwrap_err();
            assert_eq!(
                error.to_string(),
                format!("an entry of the matrix is {value}, but has to be a finite number")
            );
        }
    }

    #[test]
    fn large_matrices_converge() {
        let mut random = Random(7);
        for (n, rank) in [(60, 60), (100, 30), (150, 149)] {
            check(&(random.matrix(n, rank) * random.matrix(rank, n)), rank);
        }
    }

    /// The four conditions of Penrose, and the shortest of the best solutions.
    #[test]
    fn pseudo_inverse_and_least_norm() {
        let mut random = Random(8);
        for (m, n) in [(12, 18), (18, 12), (12, 12), (1, 7), (7, 1)] {
            for rank in 0..=m.min(n) {
                let values: Vec<f64> = (0..rank).map(|_| 1.5 + random.next()).collect();
                let a = random.with_values(m, n, &values);
                let found = check(&a, rank);
                let inverse = found.pseudo_inverse(rank);
                near("A A† A", &(&a * &inverse * &a), &a, ROUND_OFF);
                near("A† A A†", &(&inverse * &a * &inverse), &inverse, 10.0 * ROUND_OFF);
                near("A A†", &(&a * &inverse), &(&a * &inverse).transpose(), ROUND_OFF);
                near("A† A", &(&inverse * &a), &(&inverse * &a).transpose(), ROUND_OFF);

                let b = DVector::from_fn(m, |_, _| random.next());
                let x = found.solve(&b, rank);
                assert!((&x - &inverse * &b).amax() < 10.0 * ROUND_OFF);
                // Nothing of x lies in the null space, nothing of the remainder in the range.
                assert!((found.null_space(rank).transpose() * &x).amax() < 10.0 * ROUND_OFF);
                assert!((a.transpose() * (&a * &x - &b)).amax() < 10.0 * ROUND_OFF);
            }
        }
    }

    #[test]
    fn three_equations_with_compliances() {
        let mut random = Random(9);
        for count in 3..=12 {
            for _ in 0..100 {
                let columns: Vec<Vector3<f64>> =
                    (0..count).map(|_| Vector3::from_fn(|_, _| random.next())).collect();
                let compliance: Vec<f64> =
                    (0..count).map(|_| 10_f64.powf(3.0 * random.next())).collect();
                let b = Vector3::from_fn(|_, _| random.next());
                // In y = x/√C the weighted norm is the plain one.
                let scaled =
                    DMatrix::from_fn(3, count, |i, m| columns[m][i] * compliance[m].sqrt());
                let decomposition = svd(&scaled).unwrap();
                let condition = decomposition.largest() / decomposition.singular_values[2];
                if condition > 1e3 {
                    continue;
                }
                let y = decomposition.solve(&DVector::from_column_slice(b.as_slice()), 3);
                let mut x = vec![0.0; count];
                assert!(least_norm_of_three(&columns, &compliance, &b, &mut x));
                for m in 0..count {
                    let off = x[m] / compliance[m].sqrt() - y[m];
                    assert!(off.abs() <= 1e-15 * condition.powi(2) * y.norm(), "{off:e}");
                }
            }
        }
    }

    /// Products of whole numbers on which the bidiagonal iteration of nalgebra 0.35 (`Matrix::svd`) fails.
    ///
    /// Its largest singular values, as found: 4.5415 for the first, 13.6877 for the second, 31.9863 for the third.
    #[test]
    fn low_rank_matrices_on_which_the_matrix_library_fails() {
        #[track_caller]
        fn check_product(m: usize, n: usize, left: &[f64], right: &[f64], expected: &[f64]) {
            let rank = expected.len();
            let left = DMatrix::from_column_slice(m, rank, left);
            let right = DMatrix::from_column_slice(rank, n, right);
            let found = check(&(&left * &right), rank);
            for (found, expected) in found.singular_values.iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < ROUND_OFF, "{found} for {expected}");
            }
        }
        check_product(
            4,
            6,
            &[1.0, 1.0, 1.0, 0.0],
            &[1.0, 0.0, -1.0, -1.0, 1.0, 1.0],
            &[15_f64.sqrt()],
        );
        check_product(
            4,
            6,
            &[-1.0, -2.0, -1.0, -1.0],
            &[2.0, -1.0, 2.0, -2.0, -2.0, -2.0],
            &[147_f64.sqrt()],
        );
        #[rustfmt::skip]
        let left = [
            0.0, 0.0, 1.0, -1.0, -2.0, 1.0, 2.0, 0.0, -1.0, 0.0, 0.0, 1.0,
            1.0, 1.0, 2.0, 1.0, 1.0, 0.0, 0.0, 0.0, 2.0, 1.0, -2.0, -2.0,
        ];
        #[rustfmt::skip]
        let right = [
            1.0, 2.0, -1.0, -2.0, 0.0, -1.0, -1.0, -2.0, 2.0, 2.0, -2.0, 1.0,
            1.0, -1.0, -1.0, 1.0, 2.0, 1.0, -2.0, 2.0, 2.0, 2.0, -1.0, 1.0,
            0.0, 0.0, 1.0, 0.0, -2.0, 2.0, 0.0, 2.0, 2.0, -1.0, 1.0, 1.0,
        ];
        // The squares are the roots of λ² − t λ + d, t and d being trace and determinant of (LᵀL)(RRᵀ).
        let (l, r) =
            (DMatrix::from_column_slice(12, 2, &left), DMatrix::from_column_slice(2, 18, &right));
        let product = (l.transpose() * &l) * (&r * r.transpose());
        let (half, determinant): (f64, f64) = (0.5 * product.trace(), product.determinant());
        let root = (half * half - determinant).sqrt();
        check_product(12, 18, &left, &right, &[(half + root).sqrt(), (half - root).sqrt()]);
    }

    #[test]
    fn dependent_equations_are_refused() {
        let mut x = [7.0, 8.0, 9.0];
        for dependent in [Vector3::new(1.0, 2.0, 0.0), Vector3::zeros()] {
            let columns = [dependent; 3];
            assert!(!least_norm_of_three(&columns, &[1.0; 3], &Vector3::x(), &mut x));
        }
        // Dependent to round-off only, as they come out of a computation.
        let mut random = Random(10);
        for _ in 0..1000 {
            let first = Vector3::from_fn(|_, _| random.next());
            let second = first.cross(&Vector3::from_fn(|_, _| random.next()));
            let third = first * random.next() + second * random.next();
            // Rows of J, of which the third is a combination.
            let columns = [0, 1, 2].map(|m| Vector3::new(first[m], second[m], third[m]));
            let compliance = [1.0, 2.0, 3.0];
            assert!(!least_norm_of_three(&columns, &compliance, &Vector3::x(), &mut x));
        }
        let not_a_number = [Vector3::from_element(f64::NAN); 3];
        assert!(!least_norm_of_three(&not_a_number, &[1.0; 3], &Vector3::x(), &mut x));
        assert_eq!(x, [7.0, 8.0, 9.0]);
    }
}
