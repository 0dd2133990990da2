//! Numbers in single precision, and notes of this program on glTF objects.

use gltf_json::extras::RawValue;
use serde_json::Value;

/// A number in single precision, as in the file.
#[expect(clippy::cast_possible_truncation, reason = "glTF has single precision only")]
pub(super) fn single(value: f64) -> f32 {
    value as f32
}

/// The `extras` of a glTF object.
pub(super) fn extras(value: &Value) -> Option<Box<RawValue>> {
    Some(serde_json::value::to_raw_value(value).expect("all keys are strings"))
}
