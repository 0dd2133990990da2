//! Surfaces from binary glTF files, by the names of their nodes.
//!
//! # Source
//! \[glTF\]

use std::collections::BTreeSet;

use gltf_json::accessor::{ComponentType, Type};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::scene::Node;
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index, Root};
use nalgebra::{Matrix4, Point3, Quaternion, UnitQuaternion, Vector3};

use super::surface::{MAX_TRIANGLES, Mesh, too_many};
use crate::place::{listed, nearest, suggestion};

/// Bytes of the header, and of that of a chunk.
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
/// Types of chunks.
const JSON: &[u8] = b"JSON";
const BINARY: &[u8] = b"BIN\0";

/// Largest number of nodes of a scene.
const MAX_NODES: usize = 100_000;

/// The surface of a node with its children, or of the whole scene, in the frame of the scene with z up (m).
pub(super) fn surface(bytes: &[u8], node: Option<&str>) -> Result<Mesh, String> {
    let (root, binary) = parts(bytes)?;
    let compressed = ["draco", "meshopt", "quantization"];
    if let Some(found) = root
        .extensions_required
        .iter()
        .find(|name| compressed.iter().any(|word| name.to_lowercase().contains(word)))
    {
        return Err(format!("it requires the extension {found}: export it without compression"));
    }
    let scene = Scene { root: &root, binary };
    let placed = scene.placed_nodes(node)?;
    let mut mesh = Mesh { vertices: Vec::new(), triangles: Vec::new() };
    for (node, scene_from_node) in placed {
        let Some(found) = node.mesh else { continue };
        let found = root.meshes.get(found.value()).ok_or_else(missing)?;
        for primitive in &found.primitives {
            scene.append(primitive, &scene_from_node, &mut mesh)?;
        }
    }
    Ok(mesh)
}

fn missing() -> String {
    "it is no binary glTF file, or a broken one: an index refers to nothing".to_owned()
}

/// The document and the binary data of a file.
fn parts(bytes: &[u8]) -> Result<(Root, &[u8]), String> {
    let broken = |why: &str| format!("it is no binary glTF file, or a broken one: {why}");
    let number = |at: usize| {
        let four = bytes.get(at..at + 4)?.try_into().ok()?;
        usize::try_from(u32::from_le_bytes(four)).ok()
    };
    if bytes.get(..4) != Some(b"glTF") {
        return Err(broken("it does not start with `glTF`"));
    }
    if number(4) != Some(2) {
        return Err(broken("its version is not 2"));
    }
    let (mut document, mut binary): (Option<&[u8]>, &[u8]) = (None, &[]);
    let mut at = HEADER;
    while let (Some(length), Some(kind)) = (number(at), bytes.get(at + 4..at + 8)) {
        let start = at + CHUNK_HEADER;
        let chunk = start.checked_add(length).and_then(|end| bytes.get(start..end));
        let chunk = chunk.ok_or_else(|| broken("it ends within a chunk"))?;
        match kind {
            JSON if document.is_none() => document = Some(chunk),
            BINARY if binary.is_empty() => binary = chunk,
            _ => {}
        }
        at = start + length;
    }
    let document = document.ok_or_else(|| broken("it has no JSON"))?;
    let root = gltf_json::deserialize::from_slice(document);
    root.map(|root| (root, binary)).map_err(|error| broken(&error.to_string()))
}

struct Scene<'a> {
    root: &'a Root,
    binary: &'a [u8],
}

impl<'a> Scene<'a> {
    /// The nodes below a node of this name, itself included, or all nodes of the scene; each with its pose in the scene.
    fn placed_nodes(&self, name: Option<&str>) -> Result<Vec<(&'a Node, Matrix4<f64>)>, String> {
        let nodes = &self.root.nodes;
        let children = nodes.iter().filter_map(|node| node.children.as_ref()).flatten();
        let children: BTreeSet<usize> = children.map(Index::value).collect();
        let scene = self.root.scene.map_or(0, |scene| scene.value());
        let roots: Vec<usize> = match self.root.scenes.get(scene) {
            Some(scene) => scene.nodes.iter().map(Index::value).collect(),
            None => (0..nodes.len()).filter(|index| !children.contains(index)).collect(),
        };
        // z up: the y axis of glTF becomes z.
        let up = Matrix4::new(
            1.0, 0.0, 0.0, 0.0, //
            0.0, 0.0, -1.0, 0.0, //
            0.0, 1.0, 0.0, 0.0, //
            0.0, 0.0, 0.0, 1.0,
        );
        let is_named = |node: &Node| name.is_none() || node.name.as_deref() == name;
        let mut stack: Vec<(usize, Matrix4<f64>, bool)> =
            roots.into_iter().map(|index| (index, up, false)).collect();
        let (mut placed, mut count) = (Vec::new(), 0);
        let mut named = 0;
        while let Some((index, parent, is_within)) = stack.pop() {
            count += 1;
            if count > MAX_NODES {
                return Err(format!("it has more than {MAX_NODES} nodes, or nodes in a circle"));
            }
            let node = nodes.get(index).ok_or_else(missing)?;
            let pose = parent * transform(node);
            named += usize::from(name.is_some() && is_named(node));
            let is_within = is_within || is_named(node);
            if is_within {
                placed.push((node, pose));
            }
            let children = node.children.iter().flatten();
            stack.extend(children.map(|child| (child.value(), pose, is_within)));
        }
        match name {
            Some(name) if named == 0 => {
                let known: Vec<String> =
                    nodes.iter().filter_map(|node| node.name.clone()).collect();
                let likest = nearest(name, known.iter().map(String::as_str));
                Err(format!(
                    "it has no node {name:?}{}; known: {}",
                    suggestion(&likest),
                    listed(&known)
                ))
            }
            Some(name) if named > 1 => {
                Err(format!("it has {named} nodes {name:?}: give each node a name of its own"))
            }
            _ => Ok(placed),
        }
    }

    /// Adds the triangles of a primitive.
    fn append(
        &self,
        primitive: &Primitive,
        scene_from_node: &Matrix4<f64>,
        mesh: &mut Mesh,
    ) -> Result<(), String> {
        if primitive.mode != Checked::Valid(Mode::Triangles) {
            return match primitive.mode {
                Checked::Valid(Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) => {
                    Ok(())
                }
                _ => Err("it has triangle strips or fans: export it with triangles".to_owned()),
            };
        }
        let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
        let positions = positions.ok_or_else(|| "it has triangles without positions".to_owned())?;
        let points = self.elements(*positions, Type::Vec3, &[ComponentType::F32])?;
        let first = mesh.vertices.len();
        for point in points {
            let at = |k: usize| {
                let four = point.get(4 * k..4 * k + 4).and_then(|four| four.try_into().ok());
                four.map_or(f64::NAN, |four| f64::from(f32::from_le_bytes(four)))
            };
            let point = scene_from_node.transform_point(&Point3::new(at(0), at(1), at(2)));
            mesh.vertices.push(point.coords.into());
        }
        let count = mesh.vertices.len() - first;
        let indices: Vec<usize> = match primitive.indices {
            None => (0..count).collect(),
            Some(indices) => {
                let allowed = [ComponentType::U8, ComponentType::U16, ComponentType::U32];
                let indices = self.elements(indices, Type::Scalar, &allowed)?;
                let number = |bytes: &[u8]| {
                    bytes.iter().rev().fold(0, |number, byte| number << 8 | usize::from(*byte))
                };
                indices.map(number).collect()
            }
        };
        if mesh.triangles.len() + indices.len() / 3 > MAX_TRIANGLES {
            return Err(too_many());
        }
        let is_mirrored = scene_from_node.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
        for corners in indices.chunks_exact(3) {
            let corner = |k: usize| {
                let index = corners[k];
                let index = if index < count { u32::try_from(first + index).ok() } else { None };
                index.ok_or_else(missing)
            };
            let [a, b, c] = [corner(0)?, corner(1)?, corner(2)?];
            mesh.triangles.push(if is_mirrored { [a, c, b] } else { [a, b, c] });
        }
        Ok(())
    }

    /// The bytes of each element of an accessor.
    fn elements(
        &self,
        index: Index<Accessor>,
        kind: Type,
        allowed: &[ComponentType],
    ) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, String> {
        let accessor = self.root.accessors.get(index.value()).ok_or_else(missing)?;
        if accessor.sparse.is_some() {
            return Err("it has sparse data: export it without".to_owned());
        }
        let component = match accessor.component_type {
            Checked::Valid(component) if allowed.contains(&component.0) => component.0,
            _ => return Err("it has positions or indices of an unknown type".to_owned()),
        };
        if accessor.type_ != Checked::Valid(kind) {
            return Err("it has positions or indices of an unknown type".to_owned());
        }
        let view = accessor.buffer_view.ok_or_else(|| {
            "it has compressed or missing data: export it without compression".to_owned()
        })?;
        let view = self.root.buffer_views.get(view.value()).ok_or_else(missing)?;
        let buffer = self.root.buffers.get(view.buffer.value()).ok_or_else(missing)?;
        if buffer.uri.is_some() {
            return Err("its data are in another file: export it with all data included".to_owned());
        }
        let size = component.size() * kind.multiplicity();
        let stride = view.byte_stride.map_or(size, |stride| stride.0).max(size);
        let number = |value: gltf_json::validation::USize64| usize::try_from(value.0).ok();
        let offset = |value: Option<_>| value.map_or(Some(0), number);
        let range = || {
            let start = offset(view.byte_offset)?;
            let end = start.checked_add(number(view.byte_length)?)?;
            let bytes = self.binary.get(start..end)?.get(offset(accessor.byte_offset)?..)?;
            let count = number(accessor.count)?;
            let needed = match count.checked_sub(1) {
                Some(further) => further.checked_mul(stride)?.checked_add(size)?,
                None => 0,
            };
            Some((bytes.get(..needed)?, count))
        };
        let (bytes, count) =
            range().ok_or_else(|| "its data end before its positions or indices do".to_owned())?;
        let element = move |index: usize| bytes.get(index * stride..index * stride + size);
        Ok((0..count).filter_map(element))
    }
}

/// Pose of a node in its parent.
fn transform(node: &Node) -> Matrix4<f64> {
    if let Some(matrix) = node.matrix {
        return Matrix4::from_iterator(matrix.into_iter().map(f64::from));
    }
    let vector = |values: [f32; 3]| Vector3::from(values.map(f64::from));
    let translation = node.translation.map_or(Vector3::zeros(), vector);
    let scale = node.scale.map_or(Vector3::repeat(1.0), vector);
    let [x, y, z, w] = node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |it| it.0.map(f64::from));
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    Matrix4::new_translation(&translation)
        * rotation.to_homogeneous()
        * Matrix4::new_nonuniform_scaling(&scale)
}
