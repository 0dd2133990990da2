//! Rank, null space, pseudo-inverse and least norm: the only singular value decomposition in the house.
//!
//! Low rank is daily bread here, and the common library's decomposition returns wrong singular values on low-rank matrices without a word.
//! This one is a one-sided Jacobi iteration: slower on large matrices, right on every rank, and its right vectors are a complete basis, so that a wide matrix has its null space.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::Error;

/// More sweeps than any matrix has been seen to need: ten do for most, scaling by 10³⁰⁰ included.
const MAX_SWEEPS: usize = 60;

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
/// [`Error::NotFinite`] for a NaN or an infinity, [`Error::SvdNotConverged`] if the iteration fails (never seen).
///
/// # Numerics
/// Hestenes' iteration on the columns, after scaling by a power of two so that squares neither overflow nor vanish.
/// Two columns count as orthogonal where their cosine is at round-off, or where one is at round-off of the whole matrix.
/// O(m n²) a sweep, about 35 µs for 12×12.
///
/// # Source
/// [GolubVanLoan], section 8.6.3
pub fn svd(a: &DMatrix<f64>) -> Result<Svd, Error> {
    let (m, n) = a.shape();
    if let Some(&value) = a.iter().find(|value| !value.is_finite()) {
        return Err(Error::NotFinite { what: "an entry of the matrix", value });
    }
    let largest = a.amax();
    let scale = if largest == 0.0 { 1.0 } else { power_of_two_near(largest) };
    let mut work = a.map(|value| value / scale);
    let mut v = DMatrix::identity(n, n);
    let negligible = f64::EPSILON * work.norm();
    orthogonalize_columns(&mut work, &mut v, negligible * negligible)?;

    let norms: Vec<f64> = work.column_iter().map(|column| column.norm()).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| norms[j].total_cmp(&norms[i]));
    let v = v.select_columns(&order);
    let kept = m.min(n);
    let singular_values =
        DVector::from_iterator(kept, order.iter().take(kept).map(|&i| norms[i] * scale));
    let directions: Vec<DVector<f64>> = order
        .iter()
        .take(kept)
        .take_while(|&&i| norms[i] > negligible)
        .map(|&i| work.column(i) / norms[i])
        .collect();
    Ok(Svd { u: complete_basis(m, directions), singular_values, v })
}

/// Rotates pairs of columns until all are orthogonal, and `v` along with them.
fn orthogonalize_columns(
    work: &mut DMatrix<f64>,
    v: &mut DMatrix<f64>,
    negligible_squared: f64,
) -> Result<(), Error> {
    let (m, n) = work.shape();
    for _ in 0..MAX_SWEEPS {
        let mut rotated = false;
        for i in 0..n {
            for j in i + 1..n {
                let alpha = work.column(i).norm_squared();
                let beta = work.column(j).norm_squared();
                if alpha <= negligible_squared || beta <= negligible_squared {
                    continue;
                }
                let gamma = work.column(i).dot(&work.column(j));
                if gamma.abs() <= 4.0 * f64::EPSILON * (alpha * beta).sqrt() {
                    continue;
                }
                rotated = true;
                let zeta = (beta - alpha) / (2.0 * gamma);
                let tangent = 1.0_f64.copysign(zeta) / (zeta.abs() + 1.0_f64.hypot(zeta));
                let cosine = 1.0 / 1.0_f64.hypot(tangent);
                rotate_columns(work, i, j, cosine, cosine * tangent);
                rotate_columns(v, i, j, cosine, cosine * tangent);
            }
        }
        if !rotated {
            return Ok(());
        }
    }
    Err(Error::SvdNotConverged { rows: m, columns: n, sweeps: MAX_SWEEPS })
}

fn rotate_columns(matrix: &mut DMatrix<f64>, i: usize, j: usize, cosine: f64, sine: f64) {
    let (mut first, mut second) = matrix.columns_range_pair_mut(i, j);
    for (x, y) in first.iter_mut().zip(second.iter_mut()) {
        let (old_x, old_y) = (*x, *y);
        *x = cosine * old_x - sine * old_y;
        *y = sine * old_x + cosine * old_y;
    }
}

fn power_of_two_near(value: f64) -> f64 {
    // The exponent is kept off the ends of the range, so that the scale and its inverse are both normal numbers.
    value.log2().round().clamp(-1000.0, 1000.0).exp2()
}

/// Orthonormal columns, completed to a basis of R^m.
fn complete_basis(m: usize, mut columns: Vec<DVector<f64>>) -> DMatrix<f64> {
    while columns.len() < m {
        // The unit vector that the columns so far span least; orthogonalised twice, which is enough.
        let spanned = |i: usize| columns.iter().map(|column| column[i] * column[i]).sum::<f64>();
        let least = (0..m)
            .min_by(|&i, &j| spanned(i).total_cmp(&spanned(j)))
            .expect("m > columns.len() ≥ 0");
        let mut next = DVector::zeros(m);
        next[least] = 1.0;
        for _ in 0..2 {
            for column in &columns {
                next -= column * column.dot(&next);
            }
        }
        columns.push(next.normalize());
    }
    if columns.is_empty() { DMatrix::zeros(0, 0) } else { DMatrix::from_columns(&columns) }
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
}

/// The shortest solution of three equations, lengths measured by a compliance for each unknown.
///
/// ```text
///    x  =  C Jᵀ (J C Jᵀ)⁻¹ b        least Σ x_m² / C_m with J x = b
///   (M)    (M,3)  (3,3)  (3)
/// ```
///
/// Returns `false`, and leaves `x` as it was, where the three equations are not independent.
///
/// # Arguments
/// * `columns` – (M) columns of J, each (3)
/// * `compliance` – (M) positive, the inverse of each unknown's weight
/// * `x` – (M) takes the solution
///
/// # Numerics
/// Cholesky of a 3×3, without allocation; J has to have full row rank, and the condition is squared.
#[must_use]
#[inline]
pub fn least_norm_of_three(
    columns: &[Vector3<f64>],
    compliance: &[f64],
    b: &Vector3<f64>,
    x: &mut [f64],
) -> bool {
    let mut gram = Matrix3::zeros();
    for (column, c) in columns.iter().zip(compliance) {
        gram += column * (column * *c).transpose();
    }
    let Some(factor) = gram.cholesky() else { return false };
    let multiplier = factor.solve(b);
    for ((unknown, column), c) in x.iter_mut().zip(columns).zip(compliance) {
        *unknown = c * column.dot(&multiplier);
    }
    true
}
