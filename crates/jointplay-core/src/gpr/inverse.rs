//! From where the platform should be to the rods.

use core::f64::consts::FRAC_PI_2;

use super::{AxisHeight, CenterHeight, Gpr, PlatformPose};
use crate::Error;
use crate::error::{LARGEST_LENGTH, finite, length};
use crate::spatial::Tilt;
use crate::virtualization::{SolveOptions, Virtualization};

impl Gpr {
    /// Rods that put the platform plane at a tilt and an axis height (m).
    ///
    /// ```text
    ///    q_k  =  z − (n_x B_kx + n_y B_ky) / n_z
    /// ```
    /// Exact, and the same for every virtualization: three ball centres fix the plane, whatever moves within it.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::TooLong`] for a height beyond 10⁵⁰ m, [`Error::TiltTooLarge`] at ±90° and beyond.
    /// [`Error::BeyondLimits`], unless the robot is one [without limit checks](Self::without_limit_checks).
    ///
    /// # Numerics
    /// Does not allocate.
    ///
    /// # Source
    /// Own derivation, `docs/explanation/kinematics.md`
    #[inline]
    pub fn inverse(&self, tilt: Tilt, height: AxisHeight) -> Result<[f64; 3], Error> {
        let rods = self.rods(tilt, height)?;
        if self.checks_limits() {
            let broken = self.limits().broken(&rods, tilt);
            if !broken.is_empty() {
                return Err(Error::BeyondLimits(broken));
            }
        }
        Ok(rods)
    }

    /// The rods of [`Self::inverse`], limits not checked (m).
    #[inline]
    fn rods(&self, tilt: Tilt, height: AxisHeight) -> Result<[f64; 3], Error> {
        // Written so that what is not a number is refused.
        let usable = tilt.angle.abs() < FRAC_PI_2 && height.0.abs() <= LARGEST_LENGTH;
        if !usable || !tilt.azimuth.is_finite() {
            return Err(unreached(tilt, height));
        }
        let slope = libm::tan(tilt.angle);
        let (sin, cos) = libm::sincos(tilt.azimuth);
        let (slope_x, slope_y) = (slope * cos, slope * sin);
        Ok(self.base_points().map(|point| height.0 - (slope_x * point.x + slope_y * point.y)))
    }

    /// The pose with a tilt whose origin O_p lies at a centre height (m), with the rods that reach it.
    ///
    /// Raising all rods alike raises the platform alike, sides and virtual joints unchanged; so one correction of the height is exact.
    ///
    /// # Errors
    /// As [`Self::inverse`] and [`Self::forward`]; limits are checked of the pose that is returned.
    pub fn inverse_for_center<V: Virtualization + ?Sized>(
        &self,
        tilt: Tilt,
        height: CenterHeight,
        virtualization: &V,
        options: &SolveOptions,
    ) -> Result<PlatformPose, Error> {
        let rods = self.rods(tilt, AxisHeight(height.0))?;
        // Far beyond the largest tilt the virtual joints may not be found at all.
        let broken = self.limits().broken(&rods, tilt);
        if self.checks_limits() && broken.tilt() {
            return Err(Error::BeyondLimits(broken));
        }
        let first = self.pose(rods, virtualization, options)?;
        let missing = height.0 - first.base_from_platform.translation.z;
        let rods = self.inverse(tilt, AxisHeight(height.0 + missing))?;
        self.pose(rods, virtualization, options)
    }
}

/// Why there are no rods for a tilt and a height.
#[cold]
fn unreached(tilt: Tilt, height: AxisHeight) -> Error {
    let checked = finite("the azimuth", tilt.azimuth)
        .and_then(|_| finite("the tilt angle", tilt.angle))
        .and_then(|_| length("the axis height", height.0));
    checked.err().unwrap_or(Error::TiltTooLarge { tilt_angle: tilt.angle })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::virtualization::Planar;

    #[track_caller]
    fn check(azimuth: f64, tilt_angle: f64, height: f64, message: &str) {
        let (gpr, tilt) =
            (Gpr::paper().without_limit_checks(), Tilt { azimuth, angle: tilt_angle });
        assert_eq!(gpr.inverse(tilt, AxisHeight(height)).unwrap_err().to_string(), message);
        let options = SolveOptions::default();
        let center = gpr.inverse_for_center(tilt, CenterHeight(height), &Planar, &options);
        assert_eq!(center.unwrap_err().to_string(), message);
    }

    #[test]
    fn what_no_rods_reach() {
        check(f64::NAN, 0.1, 0.5, "the azimuth is NaN, but has to be a finite number");
        check(0.1, f64::INFINITY, 0.5, "the tilt angle is inf, but has to be a finite number");
        check(0.1, 0.1, f64::NAN, "the axis height is NaN, but has to be a finite number");
        for tilt_angle in [FRAC_PI_2, -2.0] {
            check(
                0.1,
                tilt_angle,
                0.5,
                &format!("the tilt angle is {tilt_angle} rad, but has to stay within ±π/2"),
            );
        }
    }
}
