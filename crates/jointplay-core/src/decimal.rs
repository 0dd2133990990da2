//! Decimal arithmetic of numbers as written.

/// Moves the decimal point of the shortest decimal that represents `value`: 0.3 mm is 0.0003 m, to the bit.
#[must_use]
pub fn shift(value: f64, places: i32) -> f64 {
    if !value.is_finite() {
        // NaN and infinities have no decimals.
        return value;
    }
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format_finite(value);
    let (digits, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let exponent = exponent.parse().map_or(places, |exponent: i32| exponent + places);
    format!("{digits}e{exponent}").parse().unwrap_or(value)
}
