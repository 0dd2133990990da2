//! Finite numbers as values of flags.

/// A finite number.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("invalid number {text:?}"))?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(format!("{} is not a finite number", text.trim()))
    }
}
