//! Nodes, meshes and animation of a glTF file.

use gltf_json::accessor::Type;
use gltf_json::animation::{Animation, Channel, Interpolation, Property, Sampler, Target};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Asset, Index, Mesh, Node, Root, Scene as SceneOfNodes};
use serde_json::Value;

use super::buffer::Buffer;
use super::keys::{self, Key, Samples};
use super::material::Material;
use super::numbers::extras;
use crate::export::error::Error;

/// The lists of a glTF file.
#[derive(Default)]
pub(super) struct Document {
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<Mesh>,
    /// The materials in use.
    pub(super) materials: Vec<Material>,
    pub(super) buffer: Buffer,
    pub(super) channels: Vec<Channel>,
    pub(super) samplers: Vec<Sampler>,
}

/// Largest deviation of an animated node from its samples.
#[derive(Clone, Copy)]
pub(super) struct Tolerance {
    /// Of its origin (m).
    pub(super) place: f64,
    /// Of its rotation (rad).
    pub(super) turn: f64,
}

/// The names of a file, and its notes.
pub(super) struct Title<'a> {
    pub(super) scene: &'a str,
    pub(super) animation: &'a str,
    pub(super) notes: &'a Value,
}

impl Document {
    /// Moves a node through samples with rates, by cubics, in translation and rotation where either changes.
    pub(super) fn animate(
        &mut self,
        node: Index<Node>,
        places: &Samples<'_, 3>,
        turns: &Samples<'_, 4>,
        tolerance: Tolerance,
    ) {
        let interpolation = Interpolation::CubicSpline;
        let places = keys::cubic(places, tolerance.place);
        self.channel(node, (Property::Translation, Type::Vec3), interpolation, &places);
        // Half of the angle between two unit quaternions is the norm of their difference.
        let turns = keys::cubic(turns, 0.5 * tolerance.turn);
        self.channel(node, (Property::Rotation, Type::Vec4), interpolation, &turns);
    }

    /// Moves a node through samples, along straight lines and great circles.
    pub(super) fn animate_lines(
        &mut self,
        node: Index<Node>,
        times: &[f64],
        (places, turns): (&[[f64; 3]], &[[f64; 4]]),
        tolerance: Tolerance,
    ) {
        let interpolation = Interpolation::Linear;
        let places = keys::lines(times, places, tolerance.place);
        self.channel(node, (Property::Translation, Type::Vec3), interpolation, &places);
        let turns = keys::arcs(times, turns, tolerance.turn);
        self.channel(node, (Property::Rotation, Type::Vec4), interpolation, &turns);
    }

    fn channel<const N: usize>(
        &mut self,
        node: Index<Node>,
        (property, kind): (Property, Type),
        interpolation: Interpolation,
        keys: &[Key<N>],
    ) {
        let rests = keys.iter().all(|key| key.value == keys[0].value && key.rate == [0.0; N]);
        if rests {
            return;
        }
        let times: Vec<f32> = keys.iter().map(|key| key.time).collect();
        let values: Vec<[f32; N]> = match interpolation {
            Interpolation::CubicSpline => {
                keys.iter().flat_map(|key| [key.rate, key.value, key.rate]).collect()
            }
            _ => keys.iter().map(|key| key.value).collect(),
        };
        let sampler = Sampler {
            input: self.buffer.times(&times),
            output: self.buffer.floats(kind, &values),
            interpolation: Valid(interpolation),
            extensions: None,
            extras: None,
        };
        let target = Target { node, path: Valid(property), extensions: None, extras: None };
        let sampler = Index::push(&mut self.samplers, sampler);
        self.channels.push(Channel { sampler, target, extensions: None, extras: None });
    }

    /// The file, whose first node is the root of the scene.
    pub(super) fn file(self, title: &Title<'_>) -> Result<Vec<u8>, Error> {
        let bytes = self.buffer.bytes;
        let mut root = Root {
            asset: Asset {
                version: "2.0".to_owned(),
                generator: Some(GENERATOR.to_owned()),
                extras: extras(title.notes),
                ..Default::default()
            },
            scene: Some(Index::new(0)),
            scenes: vec![SceneOfNodes {
                name: Some(title.scene.to_owned()),
                nodes: vec![Index::new(0)],
                extensions: None,
                extras: None,
            }],
            nodes: self.nodes,
            meshes: self.meshes,
            materials: self.materials.iter().map(|one| one.describe()).collect(),
            buffers: vec![gltf_json::Buffer {
                byte_length: bytes.len().into(),
                name: None,
                uri: None,
                extensions: None,
                extras: None,
            }],
            buffer_views: self.buffer.views,
            accessors: self.buffer.accessors,
            ..Default::default()
        };
        if !self.channels.is_empty() {
            root.animations.push(Animation {
                name: Some(title.animation.to_owned()),
                channels: self.channels,
                samplers: self.samplers,
                extensions: None,
                extras: None,
            });
        }
        binary(serde_json::to_vec(&root).expect("all keys are strings"), bytes)
    }
}

/// Name of the program in files.
pub(super) const GENERATOR: &str = concat!("jointplay ", env!("CARGO_PKG_VERSION"));

/// A file in binary form: a header, the description, the numbers.
pub(super) fn binary(mut text: Vec<u8>, mut bytes: Vec<u8>) -> Result<Vec<u8>, Error> {
    while !text.len().is_multiple_of(4) {
        text.push(b' ');
    }
    while !bytes.len().is_multiple_of(4) {
        bytes.push(0);
    }
    let total = 12 + 8 + text.len() + 8 + bytes.len();
    let length = u32::try_from(total).map_err(|_| Error::TooLarge { bytes: total })?;
    let part = |length: usize| u32::try_from(length).expect("less than all of it").to_le_bytes();
    let mut file = Vec::with_capacity(total);
    file.extend(b"glTF");
    file.extend(2_u32.to_le_bytes());
    file.extend(length.to_le_bytes());
    file.extend(part(text.len()));
    file.extend(b"JSON");
    file.extend(text);
    file.extend(part(bytes.len()));
    file.extend(b"BIN\0");
    file.extend(bytes);
    Ok(file)
}
