//! The numbers of a glTF file, and where each list of them stands.

use serde_json::{Value, json};

/// glTF's numbers for kinds of numbers, and for what they are used.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// All numbers, and the descriptions of the lists in them.
#[derive(Default)]
pub(super) struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    /// Times that are there already, with their accessors: many nodes move at the same ones.
    times: Vec<(Vec<f32>, usize)>,
}

impl Buffer {
    /// Times of keys, as an accessor.
    pub(super) fn times(&mut self, times: &[f32]) -> usize {
        if let Some((_, known)) = self.times.iter().find(|(known, _)| known == times) {
            return *known;
        }
        let bounds = json!({ "min": [times.first()], "max": [times.last()] });
        let bytes = times.iter().flat_map(|time| time.to_le_bytes());
        let accessor = self.push(bytes, None, FLOAT, "SCALAR", times.len(), bounds);
        self.times.push((times.to_vec(), accessor));
        accessor
    }

    /// Values of keys, as an accessor.
    pub(super) fn floats<const N: usize>(&mut self, kind: &str, values: &[[f32; N]]) -> usize {
        let bytes = values.as_flattened().iter().flat_map(|value| value.to_le_bytes());
        self.push(bytes, None, FLOAT, kind, values.len(), json!({}))
    }

    /// Corners of a surface, as an accessor.
    pub(super) fn vertices(&mut self, values: &[[f32; 3]]) -> usize {
        let bound = |pick: fn(f32, f32) -> f32| {
            [0, 1, 2].map(|k| values.iter().map(|value| value[k]).reduce(pick))
        };
        let bounds = json!({ "min": bound(f32::min), "max": bound(f32::max) });
        let bytes = values.as_flattened().iter().flat_map(|value| value.to_le_bytes());
        self.push(bytes, Some(VERTICES), FLOAT, "VEC3", values.len(), bounds)
    }

    /// Corners of triangles, as an accessor.
    pub(super) fn triangles(&mut self, values: &[[u32; 3]]) -> usize {
        let flat = values.as_flattened();
        let bytes = flat.iter().flat_map(|value| value.to_le_bytes());
        self.push(bytes, Some(INDICES), UNSIGNED_INT, "SCALAR", flat.len(), json!({}))
    }

    fn push(
        &mut self,
        bytes: impl Iterator<Item = u8>,
        target: Option<u32>,
        component: u32,
        kind: &str,
        count: usize,
        mut accessor: Value,
    ) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let length = self.bytes.len() - start;
        let mut view = json!({ "buffer": 0, "byteOffset": start, "byteLength": length });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.views.push(view);
        accessor["bufferView"] = json!(self.views.len() - 1);
        accessor["componentType"] = json!(component);
        accessor["count"] = json!(count);
        accessor["type"] = json!(kind);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// The views, the accessors and the numbers, all four bytes long.
    pub(super) fn finish(self) -> (Vec<Value>, Vec<Value>, Vec<u8>) {
        (self.views, self.accessors, self.bytes)
    }
}
