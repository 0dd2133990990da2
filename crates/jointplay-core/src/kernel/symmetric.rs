//! Symmetric systems of three equations, for many poses.

use pulp::Simd;

use super::lanes::Lanes;
use super::shape::Three;

/// Solution of a symmetric system N y = target · share, and the minors that show whether its rows are independent.
pub(super) struct Solution<S: Simd> {
    pub(super) y: Three<S>,
    /// Product of the first two entries of the diagonal of N.
    pub(super) product: Lanes<S>,
    /// Determinant of the first two rows and columns of N.
    pub(super) minor: Lanes<S>,
    pub(super) determinant: Lanes<S>,
}

/// Solves a symmetric system by cofactors: one division, and no product waits for another.
///
/// # Arguments
/// * `entries` – diagonal of N, then its entries (0,1), (1,2), (2,0)
#[inline(always)]
pub(super) fn solve_symmetric<S: Simd>(
    entries: [Lanes<S>; 6],
    target: &Three<S>,
    share: f64,
) -> Solution<S> {
    let [n_00, n_11, n_22, n_01, n_12, n_20] = entries;
    let product = n_00 * n_11;
    let c_00 = n_12.times_from(n_12, n_11 * n_22);
    let c_11 = n_20.times_from(n_20, n_00 * n_22);
    let c_22 = n_01.times_from(n_01, product);
    let c_01 = n_01.times_from(n_22, n_20 * n_12);
    let c_12 = n_12.times_from(n_00, n_20 * n_01);
    let c_20 = n_20.times_from(n_11, n_01 * n_12);
    let determinant = n_00.times_plus(c_00, n_01.times_plus(c_01, n_20 * c_20));
    let scale = determinant.like(share) / determinant;
    let [t_0, t_1, t_2] = *target;
    let y = [
        c_00.times_plus(t_0, c_01.times_plus(t_1, c_20 * t_2)) * scale,
        c_01.times_plus(t_0, c_11.times_plus(t_1, c_12 * t_2)) * scale,
        c_20.times_plus(t_0, c_12.times_plus(t_1, c_22 * t_2)) * scale,
    ];
    Solution { y, product, minor: c_22, determinant }
}
