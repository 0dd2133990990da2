//! Conversion between SI units and mm, µm or degrees that preserves short decimals.
//!
//! `0.093218 * 1000.0` is 93.21799999999999; [`mm`] returns 93.218, and [`m_from_mm`] returns the original number.

pub use jointplay_core::decimal::shift;

/// Millimetres from metres.
#[must_use]
pub fn mm(meters: f64) -> f64 {
    shift(meters, 3)
}

/// Micrometres from metres.
#[must_use]
pub fn um(meters: f64) -> f64 {
    shift(meters, 6)
}

/// Metres from millimetres.
#[must_use]
pub fn m_from_mm(millimeters: f64) -> f64 {
    shift(millimeters, -3)
}

/// Metres from micrometres.
#[must_use]
pub fn m_from_um(micrometers: f64) -> f64 {
    shift(micrometers, -6)
}

/// Degrees from radians: among all numbers that convert to these radians, one with few decimals if there is one.
#[must_use]
pub fn deg(radians: f64) -> f64 {
    let degrees = radians.to_degrees();
    let rounded = (degrees * 1e11).round() / 1e11;
    if rounded.to_radians() == radians { rounded } else { degrees }
}

/// Units of columns of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// No unit.
    One,
    /// Metres.
    Meter,
    /// Millimetres.
    Millimeter,
    /// Micrometres.
    Micrometer,
    /// Nanometres.
    Nanometer,
    /// Radians.
    Radian,
    /// Milliradians.
    Milliradian,
    /// Microradians.
    Microradian,
    /// Degrees.
    Degree,
    /// Seconds.
    Second,
}

impl Unit {
    /// Units of lengths, the default first.
    pub const LENGTHS: [Self; 4] =
        [Self::Millimeter, Self::Micrometer, Self::Nanometer, Self::Meter];
    /// Units of angles, the default first.
    pub const ANGLES: [Self; 4] =
        [Self::Degree, Self::Radian, Self::Milliradian, Self::Microradian];
    /// Units of times.
    pub const TIMES: [Self; 1] = [Self::Second];

    /// Suffix of a column name; empty without a unit.
    #[must_use]
    pub fn suffix(self) -> &'static str {
        match self {
            Self::One => "",
            Self::Meter => "_m",
            Self::Millimeter => "_mm",
            Self::Micrometer => "_um",
            Self::Nanometer => "_nm",
            Self::Radian => "_rad",
            Self::Milliradian => "_mrad",
            Self::Microradian => "_urad",
            Self::Degree => "_deg",
            Self::Second => "_s",
        }
    }

    /// The unit in the codes of UCUM, such as `mm` or `urad`; `None` without a unit.
    #[must_use]
    pub fn code(self) -> Option<&'static str> {
        self.suffix().strip_prefix('_')
    }

    /// Number of this unit in one SI unit.
    #[must_use]
    pub fn in_si(self) -> f64 {
        match self {
            Self::One | Self::Meter | Self::Radian | Self::Second => 1.0,
            Self::Millimeter | Self::Milliradian => 1e3,
            Self::Micrometer | Self::Microradian => 1e6,
            Self::Nanometer => 1e9,
            Self::Degree => 180.0 / std::f64::consts::PI,
        }
    }

    /// Converts an SI value to this unit with one multiplication, for columns of millions.
    #[must_use]
    #[inline]
    pub fn from_si(self, si: f64) -> f64 {
        si * self.in_si()
    }

    /// Converts an SI value to this unit; prefers a decimal with few digits within round-off, as a user would type it.
    #[must_use]
    #[inline]
    pub fn typed_from_si(self, si: f64) -> f64 {
        let plain = self.from_si(si);
        let rounded = (plain * 1e9).round() / 1e9;
        let back = if self == Self::Degree { rounded.to_radians() } else { rounded / self.in_si() };
        if (back - si).abs() <= f64::EPSILON * si.abs() { rounded } else { plain }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_decimals_survive_the_conversion() {
        for millimeters in [93.218, 501.3, 0.1, 754.0, 1e-300, -12.75, 0.0, 123456.789] {
            assert_eq!(mm(m_from_mm(millimeters)), millimeters);
        }
        assert_eq!(mm(0.093218), 93.218);
        assert_eq!(um(2.84e-5), 28.4);
        for degrees in [-1.8, 0.2, 359.9, 1.5, 0.0, 17.0] {
            assert_eq!(deg(f64::to_radians(degrees)), degrees);
        }
    }

    #[test]
    fn short_decimals_survive_in_columns() {
        for millimeters in [93.218, 501.3, 0.1, 754.0, -12.75, 0.0] {
            assert_eq!(Unit::Millimeter.typed_from_si(m_from_mm(millimeters)), millimeters);
        }
        for degrees in [-1.8, 0.2, 359.9, 1.5, 0.0, 17.0, 0.7] {
            assert_eq!(Unit::Degree.typed_from_si(f64::to_radians(degrees)), degrees);
        }
        assert_eq!(Unit::Microradian.from_si(2.5e-6), 2.5);
        assert!(Unit::Degree.typed_from_si(f64::NAN).is_nan());
    }

    #[test]
    fn values_that_are_not_finite_remain_so() {
        assert!(mm(f64::NAN).is_nan());
        assert_eq!(mm(f64::INFINITY), f64::INFINITY);
        assert!(deg(f64::NAN).is_nan());
    }
}
