//! The numbers of a glTF file: bytes, buffer views and accessors.

use gltf_json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Target, View};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Index, Value};
use serde_json::json;

/// All numbers, with the accessors that describe the lists of them.
#[derive(Default)]
pub(super) struct Buffer {
    pub(super) bytes: Vec<u8>,
    pub(super) views: Vec<View>,
    pub(super) accessors: Vec<Accessor>,
    /// Lists of times with their accessors, each stored once: many nodes have keys at the same times.
    times: Vec<(Vec<f32>, Index<Accessor>)>,
}

/// A list of numbers in the buffer.
struct NumberList {
    kind: Type,
    component: ComponentType,
    count: usize,
    target: Option<Target>,
    /// Least and greatest number of each component.
    bounds: Option<[Value; 2]>,
}

impl Buffer {
    /// The accessor of times of keys (s).
    pub(super) fn times(&mut self, times: &[f32]) -> Index<Accessor> {
        if let Some((_, known)) = self.times.iter().find(|(known, _)| known == times) {
            return *known;
        }
        let bytes = times.iter().flat_map(|time| time.to_le_bytes());
        let list = NumberList {
            kind: Type::Scalar,
            component: ComponentType::F32,
            count: times.len(),
            target: None,
            bounds: Some([json!([times.first()]), json!([times.last()])]),
        };
        let accessor = self.push(bytes, list);
        self.times.push((times.to_vec(), accessor));
        accessor
    }

    /// The accessor of values of keys.
    pub(super) fn floats<const N: usize>(
        &mut self,
        kind: Type,
        values: &[[f32; N]],
    ) -> Index<Accessor> {
        let bytes = values.as_flattened().iter().flat_map(|value| value.to_le_bytes());
        let component = ComponentType::F32;
        let count = values.len();
        self.push(bytes, NumberList { kind, component, count, target: None, bounds: None })
    }

    /// The accessor of the vertices of a surface (m).
    pub(super) fn vertices(&mut self, values: &[[f32; 3]]) -> Index<Accessor> {
        let bound = |pick: fn(f32, f32) -> f32| {
            json!([0, 1, 2].map(|k| values.iter().map(|value| value[k]).reduce(pick)))
        };
        let bytes = values.as_flattened().iter().flat_map(|value| value.to_le_bytes());
        let list = NumberList {
            kind: Type::Vec3,
            component: ComponentType::F32,
            count: values.len(),
            target: Some(Target::ArrayBuffer),
            bounds: Some([bound(f32::min), bound(f32::max)]),
        };
        self.push(bytes, list)
    }

    /// The accessor of the vertex indices of triangles.
    pub(super) fn triangles(&mut self, values: &[[u32; 3]]) -> Index<Accessor> {
        let flat = values.as_flattened();
        let bytes = flat.iter().flat_map(|value| value.to_le_bytes());
        let list = NumberList {
            kind: Type::Scalar,
            component: ComponentType::U32,
            count: flat.len(),
            target: Some(Target::ElementArrayBuffer),
            bounds: None,
        };
        self.push(bytes, list)
    }

    fn push(&mut self, bytes: impl Iterator<Item = u8>, list: NumberList) -> Index<Accessor> {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let view = View {
            buffer: Index::new(0),
            byte_length: (self.bytes.len() - start).into(),
            byte_offset: Some(start.into()),
            byte_stride: None,
            name: None,
            target: list.target.map(Valid),
            extensions: None,
            extras: None,
        };
        let view = Index::push(&mut self.views, view);
        let (min, max) = list.bounds.map_or((None, None), |[min, max]| (Some(min), Some(max)));
        let accessor = Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: list.count.into(),
            component_type: Valid(GenericComponentType(list.component)),
            extensions: None,
            extras: None,
            type_: Valid(list.kind),
            min,
            max,
            name: None,
            normalized: false,
            sparse: None,
        };
        Index::push(&mut self.accessors, accessor)
    }
}
