//! The platform as built: its nominal sockets.

use nalgebra::Vector2;

use crate::Error;
use crate::error::finite;

/// The three sockets in the platform plane, in the platform frame (m).
pub type Sockets = [Vector2<f64>; 3];

/// The three sides between ball centres, in the order L_12, L_23, L_31 (m).
pub type Sides = [f64; 3];

/// The least height of a triangle over its longest side that still fixes a plane.
const LEAST_HEIGHT_TO_BASE: f64 = 1e-6;

/// Nominal sockets at radius r_k and angle β_k about O_p.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Platform {
    radii: [f64; 3],
    angles: [f64; 3],
    directions: [Vector2<f64>; 3],
    sockets: Sockets,
    equally_spaced: bool,
}

impl Platform {
    /// A platform from its socket radii (m) and angles from e_p1 toward e_p2 (rad).
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::NotPositive`] for a radius, [`Error::Collinear`] sockets.
    pub fn new(radii: [f64; 3], angles: [f64; 3]) -> Result<Self, Error> {
        for (k, (&radius, &angle)) in radii.iter().zip(&angles).enumerate() {
            finite("a socket angle", angle)?;
            if finite("a socket radius", radius)? <= 0.0 {
                return Err(Error::NotPositive {
                    what: "the socket radius",
                    limb: k + 1,
                    value: radius,
                });
            }
        }
        let directions = angles.map(unit);
        let sockets = [0, 1, 2].map(|k| directions[k] * radii[k]);
        check_not_collinear("sockets", &sockets)?;
        let equally_spaced = (0..3).all(|k| {
            let cosine = directions[k].dot(&directions[(k + 1) % 3]);
            (cosine + 0.5).abs() <= 8.0 * f64::EPSILON
        });
        Ok(Self { radii, angles, directions, sockets, equally_spaced })
    }

    /// Socket radii r_k (m).
    #[must_use]
    pub fn radii(&self) -> &[f64; 3] {
        &self.radii
    }

    /// Socket angles β_k (rad).
    #[must_use]
    pub fn angles(&self) -> &[f64; 3] {
        &self.angles
    }

    /// Unit vectors u(β_k) from O_p toward the nominal sockets.
    #[must_use]
    pub fn directions(&self) -> &[Vector2<f64>; 3] {
        &self.directions
    }

    /// Nominal sockets r_k u(β_k) (m).
    #[must_use]
    pub fn sockets(&self) -> &Sockets {
        &self.sockets
    }

    /// Mean of the socket radii, the platform's own measure of length (m).
    #[must_use]
    pub fn mean_radius(&self) -> f64 {
        // Differences to the first, so that the mean of equal radii is that radius to the bit.
        let [first, second, third] = self.radii;
        first + ((second - first) + (third - first)) / 3.0
    }

    /// Whether the sockets are 120° apart, to round-off.
    #[must_use]
    pub fn equally_spaced(&self) -> bool {
        self.equally_spaced
    }
}

/// u(θ) = (cos θ, sin θ).
#[inline]
pub(crate) fn unit(angle: f64) -> Vector2<f64> {
    let (sin, cos) = libm::sincos(angle);
    Vector2::new(cos, sin)
}

/// The sides between three points of a plane.
#[inline]
pub(crate) fn sides_of(points: &Sockets) -> Sides {
    let [p_1, p_2, p_3] = points;
    [(p_2 - p_1).norm(), (p_3 - p_2).norm(), (p_1 - p_3).norm()]
}

/// Twice the area of a triangle, positive where it runs round counter-clockwise (m²).
#[inline]
pub(crate) fn signed_area(points: &Sockets) -> f64 {
    (points[1] - points[0]).perp(&(points[2] - points[0]))
}

pub(crate) fn check_not_collinear(what: &'static str, points: &Sockets) -> Result<(), Error> {
    let longest = sides_of(points).into_iter().fold(0.0, f64::max);
    let height_to_base =
        if longest == 0.0 { 0.0 } else { signed_area(points).abs() / longest / longest };
    if height_to_base < LEAST_HEIGHT_TO_BASE {
        return Err(Error::Collinear { what, height_to_base, allowed: LEAST_HEIGHT_TO_BASE });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const RADII: [f64; 3] = [0.1, 0.2, 0.3];
    const ANGLES: [f64; 3] = [0.0, TAU / 3.0, 2.0 * TAU / 3.0];

    #[track_caller]
    fn check(radii: [f64; 3], angles: [f64; 3], message: &str) {
        assert_eq!(Platform::new(radii, angles).unwrap_err().to_string(), message);
    }

    #[test]
    fn invalid_platforms_are_refused() {
        check(
            [0.1, f64::NAN, 0.1],
            ANGLES,
            "a socket radius is NaN, but has to be a finite number",
        );
        check(
            [0.1, 0.1, f64::INFINITY],
            ANGLES,
            "a socket radius is inf, but has to be a finite number",
        );
        check(
            RADII,
            [0.0, f64::NEG_INFINITY, 1.0],
            "a socket angle is -inf, but has to be a finite number",
        );
        check(
            [0.1, 0.0, 0.1],
            ANGLES,
            "the socket radius of limb 2 is 0 m, but has to be positive",
        );
        check(
            [0.1, 0.2, -0.3],
            ANGLES,
            "the socket radius of limb 3 is -0.3 m, but has to be positive",
        );
        check(
            RADII,
            [0.5; 3],
            "the three sockets lie on one line: their triangle is 0 times as high as it is long, at least 0.000001 is needed",
        );
        check(
            [0.1; 3],
            [0.0, 0.0, 1.0],
            "the three sockets lie on one line: their triangle is 0 times as high as it is long, at least 0.000001 is needed",
        );
    }

    #[test]
    fn sockets_and_spacing() {
        let platform = Platform::new(RADII, ANGLES).unwrap();
        assert_eq!(platform.sockets()[0], Vector2::new(0.1, 0.0));
        assert!((platform.sockets()[1] - Vector2::new(-0.1, 0.03_f64.sqrt())).norm() < 1e-16);
        assert!((platform.mean_radius() - 0.2).abs() < 1e-16);
        assert!(platform.equally_spaced() && signed_area(platform.sockets()) > 0.0);
        for turn in [0.1, 1.0, 3.0, -2.0] {
            for sense in [1.0, -1.0] {
                let turned =
                    Platform::new(RADII, ANGLES.map(|angle| sense * angle + turn)).unwrap();
                assert!(turned.equally_spaced(), "{turn}");
                assert_eq!(signed_area(turned.sockets()) > 0.0, sense > 0.0);
            }
        }
        let uneven = Platform::new(RADII, [0.0, 2.1, 4.2]).unwrap();
        assert!(!uneven.equally_spaced());
    }
}
