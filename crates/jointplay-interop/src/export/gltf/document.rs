//! Nodes, meshes and animation of a glTF file.

use gltf_json::accessor::Type;
use gltf_json::animation::{Channel, Interpolation, Property, Sampler, Target};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Index, Mesh, Node};

use super::buffer::Buffer;
use super::material::Material;
use super::numbers::single;
use crate::export::scene::{Track, is_key};

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

/// An animated property of a node.
#[derive(Clone, Copy)]
struct Animated {
    node: Index<Node>,
    property: Property,
    kind: Type,
}

/// A value at a time, and how fast it changes there.
#[derive(Clone, Copy, PartialEq)]
struct Key<const N: usize> {
    value: [f32; N],
    rate: [f32; N],
}

impl<const N: usize> Key<N> {
    fn new(value: &[f64; N], rate: &[f64; N]) -> Self {
        Self { value: value.map(single), rate: rate.map(single) }
    }
}

impl Document {
    /// Moves a node along its track, in translation and rotation where either changes.
    pub(super) fn animate(&mut self, node: Index<Node>, track: &Track, times: &[f64]) {
        let places = track.places.iter().zip(&track.rates);
        let places: Vec<_> = places.map(|(at, rate)| Key::new(at, &rate.place)).collect();
        let turns = track.turns.iter().zip(&track.rates);
        let turns: Vec<_> = turns.map(|(turn, rate)| Key::new(turn, &rate.turn)).collect();
        let translation = Animated { node, property: Property::Translation, kind: Type::Vec3 };
        self.channel(translation, times, &places);
        let rotation = Animated { node, property: Property::Rotation, kind: Type::Vec4 };
        self.channel(rotation, times, &turns);
    }

    fn channel<const N: usize>(&mut self, animated: Animated, times: &[f64], keys: &[Key<N>]) {
        if keys.windows(2).all(|pair| pair[0] == pair[1]) {
            return;
        }
        let (mut at, mut values): (Vec<f32>, Vec<[f32; N]>) = (Vec::new(), Vec::new());
        for (k, (&time, key)) in times.iter().zip(keys).enumerate() {
            let time = single(time);
            // Late in a long motion neighbouring times may be one in single precision.
            if is_key(keys, k) && at.last().is_none_or(|&last| last < time) {
                at.push(time);
                values.extend([key.rate, key.value, key.rate]);
            }
        }
        let sampler = Sampler {
            input: self.buffer.times(&at),
            output: self.buffer.floats(animated.kind, &values),
            interpolation: Valid(Interpolation::CubicSpline),
            extensions: None,
            extras: None,
        };
        let target = Target {
            node: animated.node,
            path: Valid(animated.property),
            extensions: None,
            extras: None,
        };
        let sampler = Index::push(&mut self.samplers, sampler);
        self.channels.push(Channel { sampler, target, extensions: None, extras: None });
    }
}
