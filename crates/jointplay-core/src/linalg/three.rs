//! Systems of three equations, without a heap.

use nalgebra::{Matrix3, Vector3};

/// An equation of which elimination leaves no more than this share is a combination of those before it: a few hundred units of round-off.
const LEAST_PIVOT: f64 = 1e-13;

/// Inverse of a symmetric 3×3 matrix; `None` where it is not positive definite beyond round-off.
///
/// # Numerics
/// Adjugate and one division; pivots, as ratios of leading minors, count as zero below 10⁻¹³ of their diagonal entries.
#[must_use]
#[inline(always)]
pub fn inverse_of_three(a: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let [xx, xy, xz] = [a[(0, 0)], a[(0, 1)], a[(0, 2)]];
    let [yy, yz, zz] = [a[(1, 1)], a[(1, 2)], a[(2, 2)]];
    let (m_xx, m_yy, m_zz) = (yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy);
    let (m_xy, m_xz, m_yz) = (xz * yz - xy * zz, xy * yz - xz * yy, xy * xz - xx * yz);
    let determinant = xx * m_xx + xy * m_xy + xz * m_xz;
    // Written so that NaN counts as dependent.
    let definite =
        xx > 0.0 && m_zz > LEAST_PIVOT * xx * yy && determinant > LEAST_PIVOT * m_zz * zz;
    let inverse = Matrix3::new(m_xx, m_xy, m_xz, m_xy, m_yy, m_yz, m_xz, m_yz, m_zz);
    definite.then(|| inverse * (1.0 / determinant))
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
/// L D Lᵀ of a 3×3, without allocation; the condition is squared, so that equations count as dependent from 3·10⁻⁷ on.
#[must_use]
#[inline]
pub fn least_norm_of_three(
    columns: &[Vector3<f64>],
    compliance: &[f64],
    b: &Vector3<f64>,
    x: &mut [f64],
) -> bool {
    // J C Jᵀ = L D Lᵀ with ones on the diagonal of L.
    let [mut xx, mut xy, mut xz, mut yy, mut yz, mut zz] = [0.0; 6];
    for (column, c) in columns.iter().zip(compliance) {
        let weighted = column * *c;
        xx += weighted.x * column.x;
        xy += weighted.x * column.y;
        xz += weighted.x * column.z;
        yy += weighted.y * column.y;
        yz += weighted.y * column.z;
        zz += weighted.z * column.z;
    }
    let (l_yx, l_zx) = (xy / xx, xz / xx);
    let d_y = yy - l_yx * xy;
    let remainder = yz - l_zx * xy;
    let l_zy = remainder / d_y;
    let d_z = zz - l_zx * xz - l_zy * remainder;
    // Written so that NaN counts as dependent.
    if !(xx > 0.0 && d_y > LEAST_PIVOT * yy && d_z > LEAST_PIVOT * zz) {
        return false;
    }
    let forward_y = b.y - l_yx * b.x;
    let forward_z = b.z - l_zx * b.x - l_zy * forward_y;
    let z = forward_z / d_z;
    let y = forward_y / d_y - l_zy * z;
    let multiplier = Vector3::new(b.x / xx - l_yx * y - l_zx * z, y, z);
    for ((unknown, column), c) in x.iter_mut().zip(columns).zip(compliance) {
        *unknown = c * column.dot(&multiplier);
    }
    true
}
