//! SI inside, millimetres and degrees outside, without spoiling decimals on the way.
//!
//! `0.093218 * 1000.0` is 93.21799999999999; here it is 93.218, and 93.218 mm read back is the same number again.

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

/// Degrees from radians: of all numbers that read back as the same radians, one with few decimals if there is one.
#[must_use]
pub fn deg(radians: f64) -> f64 {
    let degrees = radians.to_degrees();
    let rounded = (degrees * 1e11).round() / 1e11;
    if rounded.to_radians() == radians { rounded } else { degrees }
}

/// Units that columns of numbers may have.
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
}

impl Unit {
    /// Of lengths, the usual one first.
    pub const LENGTHS: [Self; 4] =
        [Self::Millimeter, Self::Micrometer, Self::Nanometer, Self::Meter];
    /// Of angles, the usual one first.
    pub const ANGLES: [Self; 4] =
        [Self::Degree, Self::Radian, Self::Milliradian, Self::Microradian];

    /// How the name of a column ends; empty without a unit.
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
        }
    }

    /// How many of this unit an SI unit is.
    #[must_use]
    pub fn in_si(self) -> f64 {
        match self {
            Self::One | Self::Meter | Self::Radian => 1.0,
            Self::Millimeter | Self::Milliradian => 1e3,
            Self::Micrometer | Self::Microradian => 1e6,
            Self::Nanometer => 1e9,
            Self::Degree => 180.0 / std::f64::consts::PI,
        }
    }

    /// A number in SI in this unit: one multiplication, for columns of millions.
    #[must_use]
    #[inline]
    pub fn of(self, si: f64) -> f64 {
        si * self.in_si()
    }

    /// The same for a number that somebody typed: the decimal with few digits that stands within round-off of it, if there is one.
    #[must_use]
    #[inline]
    pub fn of_typed(self, si: f64) -> f64 {
        let plain = self.of(si);
        let rounded = (plain * 1e9).round() / 1e9;
        let back = if self == Self::Degree { rounded.to_radians() } else { rounded / self.in_si() };
        if (back - si).abs() <= f64::EPSILON * si.abs() { rounded } else { plain }
    }
}

/// Moves the decimal point of the shortest decimal that stands for `value`.
pub fn shift(value: f64, places: i32) -> f64 {
    if !value.is_finite() {
        // NaN and the infinities have no decimals to move.
        return value;
    }
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format_finite(value);
    let (digits, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let exponent = exponent.parse().map_or(places, |exponent: i32| exponent + places);
    format!("{digits}e{exponent}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_stay() {
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
    fn decimals_stay_in_columns_too() {
        for millimeters in [93.218, 501.3, 0.1, 754.0, -12.75, 0.0] {
            assert_eq!(Unit::Millimeter.of_typed(m_from_mm(millimeters)), millimeters);
        }
        for degrees in [-1.8, 0.2, 359.9, 1.5, 0.0, 17.0, 0.7] {
            assert_eq!(Unit::Degree.of_typed(f64::to_radians(degrees)), degrees);
        }
        assert_eq!(Unit::Microradian.of(2.5e-6), 2.5);
        assert!(Unit::Degree.of_typed(f64::NAN).is_nan());
    }

    #[test]
    fn what_is_no_number_stays_none() {
        assert!(mm(f64::NAN).is_nan());
        assert_eq!(mm(f64::INFINITY), f64::INFINITY);
        assert!(deg(f64::NAN).is_nan());
    }
}
