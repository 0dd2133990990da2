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

/// Moves the decimal point of the shortest decimal that stands for `value`.
pub(crate) fn shift(value: f64, places: i32) -> f64 {
    let text = format!("{value:e}");
    let moved = text.split_once('e').and_then(|(digits, exponent)| {
        let exponent: i32 = exponent.parse().ok()?;
        format!("{digits}e{}", exponent + places).parse().ok()
    });
    // NaN and the infinities have no decimals to move.
    moved.unwrap_or(value)
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
    fn what_is_no_number_stays_none() {
        assert!(mm(f64::NAN).is_nan());
        assert_eq!(mm(f64::INFINITY), f64::INFINITY);
        assert!(deg(f64::NAN).is_nan());
    }
}
