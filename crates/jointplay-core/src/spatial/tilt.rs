//! The direction in which a platform leans, and how far.

use nalgebra::Vector3;

/// A tilt: toward which azimuth the platform leans, and how far.
///
/// ```text
///    n = (sin α cos γ, sin α sin γ, cos α)      γ: yaw, α: pitch, n: platform normal in the base frame
/// ```
/// A negative pitch leans the opposite way: `(γ, −α)` and `(γ + π, α)` are one tilt.
///
/// # Source
/// [Virtualization], VI.A
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tilt {
    /// Azimuth γ toward which the platform leans, from e_b1 toward e_b2 [rad].
    pub yaw: f64,
    /// Angle α between the platform normal and e_b3 [rad].
    pub pitch: f64,
}

impl Tilt {
    /// No tilt at all.
    pub const LEVEL: Self = Self { yaw: 0.0, pitch: 0.0 };

    /// Platform normal in the base frame, a unit vector.
    #[must_use]
    pub fn normal(self) -> Vector3<f64> {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.sin_cos();
        Vector3::new(sin_pitch * cos_yaw, sin_pitch * sin_yaw, cos_pitch)
    }

    /// The tilt of a normal in the base frame, of any length; pitch ≥ 0, yaw 0 where level.
    ///
    /// # Numerics
    /// Full precision for small tilts, where an arc cosine would lose half the digits.
    #[must_use]
    pub fn from_normal(normal: &Vector3<f64>) -> Self {
        let lean = normal.x.hypot(normal.y);
        let yaw = if lean == 0.0 { 0.0 } else { normal.y.atan2(normal.x) };
        Self { yaw, pitch: lean.atan2(normal.z) }
    }

    /// The same tilt as one rotation vector in the base plane: angles about e_b1 and about e_b2 [rad].
    ///
    /// ```text
    ///    (θ_x, θ_y) = α (−sin γ, cos γ)
    /// ```
    /// This is how machine controllers speak of tilt; to leading order the two are independent turns.
    #[must_use]
    pub fn about_x_and_y(self) -> (f64, f64) {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        (-self.pitch * sin_yaw, self.pitch * cos_yaw)
    }

    /// The tilt of a rotation vector in the base plane, see [`Self::about_x_and_y`] [rad].
    #[must_use]
    pub fn from_about_x_and_y(about_x: f64, about_y: f64) -> Self {
        let pitch = about_x.hypot(about_y);
        let yaw = if pitch == 0.0 { 0.0 } else { (-about_x).atan2(about_y) };
        Self { yaw, pitch }
    }
}
