//! Tilt of a platform: direction and angle.

use nalgebra::Vector3;

/// A tilt: azimuth of the direction toward which the platform tilts, and angle.
///
/// ```text
///    n = (sin α cos γ, sin α sin γ, cos α)      γ: azimuth, α: tilt angle, n: platform normal in the base frame
/// ```
/// A negative tilt angle tilts in the opposite direction: `(γ, −α)` and `(γ + π, α)` are one tilt.
///
/// # Source
/// \[Virtualization\], VI.A
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tilt {
    /// Azimuth γ toward which the platform tilts, from e_b1 toward e_b2 (rad).
    pub azimuth: f64,
    /// Angle α between the platform normal and e_b3 (rad).
    pub angle: f64,
}

impl Tilt {
    /// No tilt at all.
    pub const LEVEL: Self = Self { azimuth: 0.0, angle: 0.0 };

    /// Platform normal in the base frame, a unit vector.
    #[must_use]
    pub fn normal(self) -> Vector3<f64> {
        let (sin_azimuth, cos_azimuth) = libm::sincos(self.azimuth);
        let (sin_angle, cos_angle) = libm::sincos(self.angle);
        Vector3::new(sin_angle * cos_azimuth, sin_angle * sin_azimuth, cos_angle)
    }

    /// The tilt of a normal in the base frame, of any length; tilt angle ≥ 0, azimuth 0 where level.
    ///
    /// # Numerics
    /// Full precision for small tilts, where an arc cosine would lose half the digits.
    #[must_use]
    pub fn from_normal(normal: &Vector3<f64>) -> Self {
        let horizontal = libm::hypot(normal.x, normal.y);
        let azimuth = if horizontal == 0.0 { 0.0 } else { libm::atan2(normal.y, normal.x) };
        Self { azimuth, angle: libm::atan2(horizontal, normal.z) }
    }

    /// The same tilt as one rotation vector in the base plane: angles about e_b1 and about e_b2 (rad).
    ///
    /// ```text
    ///    (θ_x, θ_y) = α (−sin γ, cos γ)
    /// ```
    /// Machine controllers describe tilt like this; to leading order the two are independent turns.
    #[must_use]
    pub fn about_x_and_y(self) -> (f64, f64) {
        let (sin_azimuth, cos_azimuth) = libm::sincos(self.azimuth);
        (-self.angle * sin_azimuth, self.angle * cos_azimuth)
    }

    /// The tilt of a rotation vector in the base plane, see [`Self::about_x_and_y`] (rad).
    #[must_use]
    pub fn from_about_x_and_y(about_x: f64, about_y: f64) -> Self {
        let tilt_angle = libm::hypot(about_x, about_y);
        let azimuth = if tilt_angle == 0.0 { 0.0 } else { libm::atan2(-about_x, about_y) };
        Self { azimuth, angle: tilt_angle }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// A tilt, and the same tilt with tilt angle ≥ 0 as a normal gives it back.
    #[track_caller]
    fn check(azimuth: f64, tilt_angle: f64, same_azimuth: f64, same_angle: f64) {
        let tilt = Tilt { azimuth, angle: tilt_angle };
        let normal = tilt.normal();
        assert!((normal.norm() - 1.0).abs() < 1e-15);
        let back = Tilt::from_normal(&(normal * 3.0));
        assert!((back.azimuth - same_azimuth).abs() < 1e-15, "{back:?}");
        assert!((back.angle - same_angle).abs() < 1e-15 * same_angle.max(1e-6), "{back:?}");

        let (about_x, about_y) = tilt.about_x_and_y();
        let again = Tilt::from_about_x_and_y(about_x, about_y);
        assert!((again.normal() - normal).norm() < 1e-15);
        assert!((again.angle - same_angle).abs() < 1e-15);
    }

    #[test]
    fn to_a_normal_and_back() {
        check(0.0, 0.0, 0.0, 0.0);
        check(2.0, 0.0, 0.0, 0.0);
        check(0.0, 0.02, 0.0, 0.02);
        check(FRAC_PI_2, 0.02, FRAC_PI_2, 0.02);
        check(-2.5, 0.3, -2.5, 0.3);
        check(1.0, -0.3, 1.0 - PI, 0.3);
        check(1.0, 1e-9, 1.0, 1e-9);
        check(1.0, 1e-200, 1.0, 1e-200);
        check(0.5, 2.0, 0.5, 2.0);
    }

    #[test]
    fn signs_of_the_axes() {
        assert_eq!(Tilt::LEVEL.normal(), Vector3::z());
        assert_eq!(Tilt::from_normal(&Vector3::z()), Tilt::LEVEL);
        // A tilt toward e_b1 is a rotation about e_b2; a tilt toward e_b2 one about −e_b1.
        let toward_x = Tilt { azimuth: 0.0, angle: 0.1 };
        assert!(toward_x.normal().x > 0.0 && toward_x.normal().y == 0.0);
        assert_eq!(toward_x.about_x_and_y(), (0.0, 0.1));
        let toward_y = Tilt { azimuth: FRAC_PI_2, angle: 0.1 };
        let (about_x, about_y) = toward_y.about_x_and_y();
        assert!((about_x + 0.1).abs() < 1e-16 && about_y.abs() < 1e-16);
    }
}
