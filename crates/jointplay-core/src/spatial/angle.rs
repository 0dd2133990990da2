//! Angles that differ by whole revolutions.

use std::f64::consts::TAU;

/// An angle shifted by whole revolutions to within half a revolution of a reference (rad).
#[must_use]
#[inline]
pub fn nearest_angle(angle: f64, reference: f64) -> f64 {
    angle + ((reference - angle) / TAU).round() * TAU
}

/// An angle shifted by whole revolutions to the range from −π to π (rad).
#[must_use]
#[inline]
pub fn wrap_angle(angle: f64) -> f64 {
    nearest_angle(angle, 0.0)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::{nearest_angle, wrap_angle};

    #[test]
    fn angles_are_shifted_by_whole_revolutions() {
        let check = |angle, reference, expected: f64| {
            let found: f64 = nearest_angle(angle, reference);
            assert!((found - expected).abs() < 1e-14, "{angle} near {reference}: {found}");
        };
        check(0.5, 0.0, 0.5);
        check(0.5, 7.0, 0.5 + 2.0 * PI);
        check(0.5, -9.0, 0.5 - 4.0 * PI);
        check(3.0 + 6.0 * PI, 3.5, 3.0);
        check(-3.0, 3.0, 2.0 * PI - 3.0);
        assert!((wrap_angle(1.5 * PI) + 0.5 * PI).abs() < 1e-14);
        assert!((wrap_angle(-1.5 * PI) - 0.5 * PI).abs() < 1e-14);
        assert!(wrap_angle(-0.3).to_bits() == (-0.3_f64).to_bits());
    }
}
