//! Derivatives of the rods by tilt and height.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::{AxisHeight, Gpr};
use crate::Error;
use crate::spatial::Tilt;

/// Rods of a tilt and an axis height, with their first and second derivatives.
///
/// The tilt is differentiated as [a rotation vector in the base plane](Tilt::about_x_and_y), so that no pose is singular: variables are (θ_x, θ_y, z).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RodDerivatives {
    /// Rod lengths q_1, q_2, q_3 (m).
    pub rods: [f64; 3],
    /// ∂q_k/∂(θ_x, θ_y, z), a row for each rod ((m/rad), (m/rad), (m/m)).
    pub rod_jacobian: Matrix3<f64>,
    /// ∂²q_k/∂(θ_x, θ_y, z)², a symmetric matrix for each rod (m/rad²); zero where z is differentiated.
    pub second: [Matrix3<f64>; 3],
}

impl RodDerivatives {
    /// Velocities of the rods for rates of (θ_x, θ_y, z) ((rad/s), (rad/s), (m/s)).
    #[must_use]
    #[inline]
    pub fn velocities(&self, rates: &Vector3<f64>) -> Vector3<f64> {
        self.rod_jacobian * rates
    }

    /// Accelerations of the rods for rates of (θ_x, θ_y, z) and their derivatives.
    ///
    /// # Arguments
    /// * `rates` – ((rad/s), (rad/s), (m/s))
    /// * `accelerations` – ((rad/s²), (rad/s²), (m/s²))
    #[must_use]
    #[inline]
    pub fn accelerations(
        &self,
        rates: &Vector3<f64>,
        accelerations: &Vector3<f64>,
    ) -> Vector3<f64> {
        let curved = self.second.map(|second| rates.dot(&(second * rates)));
        self.rod_jacobian * accelerations + Vector3::from(curved)
    }
}

impl Gpr {
    /// Rods that put the platform plane at a tilt and an axis height (m), with their derivatives.
    ///
    /// ```text
    ///    q_k  =  z − s · B_k,      s = (tan α / α) (θ_y, −θ_x),      α² = θ_x² + θ_y²
    /// ```
    /// The rods are linear in the slopes s and the height z, and the same for every virtualization.
    ///
    /// # Errors
    /// Those of [`Self::inverse`].
    ///
    /// # Numerics
    /// Closed forms, series for tilts below 0.1 rad. Does not allocate.
    ///
    /// # Source
    /// Own derivation, `docs/explanation/kinematics.md`
    ///
    /// # Example
    /// ```
    /// use jointplay_core::gpr::{AxisHeight, Gpr};
    /// use jointplay_core::nalgebra::Vector3;
    /// use jointplay_core::spatial::Tilt;
    ///
    /// let gpr = Gpr::paper();
    /// // Precession at 1°, a turn each second: α is constant, and γ' = 2π/s.
    /// let tilt = Tilt { azimuth: 0.0, angle: 1.0_f64.to_radians() };
    /// let found = gpr.rod_derivatives(tilt, AxisHeight(0.5))?;
    /// let rates = Vector3::new(-tilt.angle, 0.0, 0.0) * std::f64::consts::TAU;
    /// let velocities = found.velocities(&rates);
    /// // The first rod is at its lowest; the two others pass each other.
    /// assert!(velocities[0].abs() < 1e-15 && velocities[1] * velocities[2] < 0.0);
    /// # Ok::<(), jointplay_core::Error>(())
    /// ```
    #[inline]
    pub fn rod_derivatives(&self, tilt: Tilt, height: AxisHeight) -> Result<RodDerivatives, Error> {
        let rods = self.inverse(tilt, height)?;
        let (about_x, about_y) = tilt.about_x_and_y();
        // The direction of the slopes, of length α.
        let toward = Vector2::new(about_y, -about_x);
        let [ratio, first, second] = slope_ratio(tilt.angle);
        let mut rod_jacobian = Matrix3::zeros();
        let mut seconds = [Matrix3::zeros(); 3];
        for (k, point) in self.base_points().iter().enumerate() {
            let along = toward.dot(point);
            let gradient = (point * ratio + toward * (first * along)) * -1.0;
            // Derivatives by `toward` are those by (θ_y, −θ_x).
            rod_jacobian[(k, 0)] = -gradient.y;
            rod_jacobian[(k, 1)] = gradient.x;
            rod_jacobian[(k, 2)] = 1.0;
            let entry = |i: usize, j: usize| {
                let same = if i == j { along } else { 0.0 };
                let mixed = same + toward[i] * point[j] + toward[j] * point[i];
                -(first * mixed + second * along * toward[i] * toward[j])
            };
            let (xx, xy, yy) = (entry(1, 1), -entry(0, 1), entry(0, 0));
            seconds[k] = Matrix3::new(xx, xy, 0.0, xy, yy, 0.0, 0.0, 0.0, 0.0);
        }
        Ok(RodDerivatives { rods, rod_jacobian, second: seconds })
    }
}

/// Tilts below this take the series, whose first neglected term is below round-off there (rad).
const SERIES_BELOW: f64 = 0.1;

/// Coefficients of tan α / α in powers of α².
const SERIES: [f64; 10] = [
    1.0,
    1.0 / 3.0,
    2.0 / 15.0,
    17.0 / 315.0,
    62.0 / 2835.0,
    1382.0 / 155_925.0,
    21_844.0 / 6_081_075.0,
    929_569.0 / 638_512_875.0,
    6_404_582.0 / 10_854_718_875.0,
    443_861_162.0 / 1_856_156_927_625.0,
];

/// τ = tan α / α, τ_1 = τ'/α and τ_2 = τ_1'/α, all even in α and finite at zero.
#[inline]
fn slope_ratio(angle: f64) -> [f64; 3] {
    let square = angle * angle;
    if angle.abs() < SERIES_BELOW {
        // Horner's scheme of a polynomial in α², with its first two derivatives.
        let (mut value, mut first, mut half_second) = (0.0, 0.0, 0.0);
        for coefficient in SERIES.into_iter().rev() {
            half_second = half_second * square + first;
            first = first * square + value;
            value = value * square + coefficient;
        }
        return [value, 2.0 * first, 8.0 * half_second];
    }
    let ratio = libm::tan(angle) / angle;
    let excess = (ratio - 1.0) / square;
    let first = ratio * ratio - excess;
    [ratio, first, 2.0 * ratio * first - (first - 2.0 * excess) / square]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_closed_form_agree_where_they_meet() {
        let [below, above] = [SERIES_BELOW * (1.0 - 1e-15), SERIES_BELOW].map(slope_ratio);
        for (k, tolerance) in [1e-15, 1e-13, 1e-10].into_iter().enumerate() {
            let off = (below[k] - above[k]).abs() / above[k];
            assert!(off < tolerance, "derivative {k}: {off:e}");
        }
        assert_eq!(slope_ratio(0.0), [1.0, 2.0 / 3.0, 16.0 / 15.0]);
    }
}
