//! Numbers in single precision.

/// A number as the file holds it.
#[expect(clippy::cast_possible_truncation, reason = "glTF has single precision only")]
pub(super) fn single(value: f64) -> f32 {
    value as f32
}
