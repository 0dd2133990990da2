//! Nodes, channels and samplers of a glTF file.

use serde_json::{Value, json};

use super::buffer::Buffer;
use super::material::Material;
use super::numbers::single;
use crate::export::scene::{Track, is_key};

/// Node, channel and sampler lists in the making.
#[derive(Default)]
pub(super) struct Document {
    pub(super) nodes: Vec<Value>,
    pub(super) meshes: Vec<Value>,
    /// Those that are used.
    pub(super) materials: Vec<Material>,
    pub(super) buffer: Buffer,
    pub(super) channels: Vec<Value>,
    pub(super) samplers: Vec<Value>,
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
    /// Moves a node along its track, in place and turn where either changes.
    pub(super) fn animate(&mut self, node: usize, track: &Track, times: &[f64]) {
        let places = track.places.iter().zip(&track.rates);
        let places: Vec<_> = places.map(|(at, rate)| Key::new(at, &rate.place)).collect();
        let turns = track.turns.iter().zip(&track.rates);
        let turns: Vec<_> = turns.map(|(turn, rate)| Key::new(turn, &rate.turn)).collect();
        self.channel(node, "translation", "VEC3", times, &places);
        self.channel(node, "rotation", "VEC4", times, &turns);
    }

    fn channel<const N: usize>(
        &mut self,
        node: usize,
        path: &str,
        kind: &str,
        times: &[f64],
        keys: &[Key<N>],
    ) {
        if keys.windows(2).all(|pair| pair[0] == pair[1]) {
            return;
        }
        let (mut at, mut told): (Vec<f32>, Vec<[f32; N]>) = (Vec::new(), Vec::new());
        for (k, (&time, key)) in times.iter().zip(keys).enumerate() {
            let time = single(time);
            // Late in a long motion neighbouring times may be one in single precision.
            if is_key(keys, k) && at.last().is_none_or(|&last| last < time) {
                at.push(time);
                told.extend([key.rate, key.value, key.rate]);
            }
        }
        let input = self.buffer.times(&at);
        let output = self.buffer.floats(kind, &told);
        let sampler = json!({ "input": input, "output": output, "interpolation": "CUBICSPLINE" });
        self.samplers.push(sampler);
        let target = json!({ "node": node, "path": path });
        self.channels.push(json!({ "sampler": self.samplers.len() - 1, "target": target }));
    }
}
