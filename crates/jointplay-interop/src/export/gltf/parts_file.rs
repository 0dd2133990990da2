//! Files of parts in binary glTF, such as those of CAD programs, to which an animation is added.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Matrix4, Quaternion, Translation3, UnitQuaternion};
use serde_json::{Value, json, to_value};

use super::document::{Document, GENERATOR, binary};
use super::node_names::NodeNames;
use super::numbers::single;
use super::parts_error::PartsError;
use crate::export::error::Error;
use jointplay_format::place::nearest;

/// The axis of a file of parts that is z of the base frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum UpAxis {
    /// The y axis, as glTF prescribes; the z axis of the base frame is y, and its y axis −z.
    #[default]
    Y,
    /// The z axis: the axes of the file are those of the base frame, as CAD programs write them.
    Z,
}

/// Parts of a CAD model: a binary glTF file with its data inside.
#[derive(Debug, Clone, PartialEq)]
pub struct PartsFile {
    document: Value,
    bytes: Vec<u8>,
    /// Parent of each node.
    parents: Vec<Option<usize>>,
}

/// An animated node: its name, the node of the file that it moves, and its first place and rotation.
pub(super) type MovedNode = (String, usize, Option<([f64; 3], [f64; 4])>);

impl PartsFile {
    /// Reads a binary glTF file.
    ///
    /// # Errors
    /// [`PartsError::NotBinary`].
    pub fn parse(file: &[u8]) -> Result<Self, PartsError> {
        let refused = |why: &str| PartsError::NotBinary { why: why.to_owned() };
        let word = |at: usize| {
            let bytes = file.get(at..at + 4)?.try_into().ok()?;
            Some(u32::from_le_bytes(bytes))
        };
        if file.get(..4) != Some(b"glTF") {
            return Err(refused("it does not begin with `glTF`"));
        }
        if word(4) != Some(2) {
            return Err(refused("its version is not 2"));
        }
        let (mut at, mut text, mut bytes) = (12, None, Vec::new());
        while let (Some(length), Some(kind)) = (word(at), word(at + 4)) {
            let length = usize::try_from(length).map_err(|_| refused("a chunk is too long"))?;
            let chunk = (at + 8).checked_add(length).and_then(|end| file.get(at + 8..end));
            let chunk = chunk.ok_or_else(|| refused("it ends within a chunk"))?;
            match &kind.to_le_bytes() {
                b"JSON" => text = Some(chunk),
                b"BIN\0" => chunk.clone_into(&mut bytes),
                _ => {}
            }
            at += 8 + length;
        }
        let text = text.ok_or_else(|| refused("it has no description"))?;
        let document: Value =
            serde_json::from_slice(text).map_err(|error| refused(&error.to_string()))?;
        if !document.is_object() {
            return Err(refused("its description is not an object"));
        }
        let is_list = |key: &str| match &document[key] {
            Value::Null => true,
            Value::Array(list) => list.iter().all(Value::is_object),
            _ => false,
        };
        let lists = ["nodes", "scenes", "buffers", "bufferViews", "accessors", "animations"];
        if !matches!(document["asset"], Value::Null | Value::Object(_))
            || !lists.into_iter().all(is_list)
        {
            return Err(refused("its description is not that of glTF"));
        }
        let buffers = document["buffers"].as_array().map_or(&[][..], Vec::as_slice);
        if buffers.iter().any(|buffer| buffer.get("uri").is_some()) {
            return Err(refused("its data are in other files; save it with all data inside"));
        }
        let nodes = document["nodes"].as_array().map_or(0, Vec::len);
        let mut parents = vec![None; nodes];
        for (parent, node) in document["nodes"].as_array().into_iter().flatten().enumerate() {
            for child in node["children"].as_array().into_iter().flatten() {
                let child = index(child).filter(|&child| child < nodes && child != parent);
                let child = child.ok_or_else(|| refused("a node has a child that is not there"))?;
                if parents[child].replace(parent).is_some() {
                    return Err(refused("a node has two parents"));
                }
            }
        }
        if has_cycle(&parents) {
            return Err(refused("a node is its own ancestor"));
        }
        let parts = Self { document, bytes, parents };
        let is_finite = |node: &Value| local(node).iter().all(|number| number.is_finite());
        if let Some(node) = parts.nodes().iter().position(|node| !is_finite(node)) {
            let name = parts.nodes()[node]["name"]
                .as_str()
                .map_or_else(String::new, |name| format!(" {name:?}"));
            return Err(refused(&format!("the transform of node {node}{name} is not finite")));
        }
        Ok(parts)
    }

    /// Names of the nodes that have one, in the order of the file.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.nodes().iter().filter_map(|node| node["name"].as_str())
    }

    /// The axis of the file that is z of the base frame, by the program that wrote it: z for Open CASCADE, which keeps the axes of CAD models, and y otherwise.
    #[must_use]
    pub fn up_axis(&self) -> UpAxis {
        match self.document["asset"]["generator"].as_str() {
            Some(name) if name.contains("Open CASCADE") => UpAxis::Z,
            _ => UpAxis::Y,
        }
    }

    pub(super) fn node_count(&self) -> usize {
        self.nodes().len()
    }

    fn nodes(&self) -> &[Value] {
        self.document["nodes"].as_array().map_or(&[], Vec::as_slice)
    }

    /// Parents of a node, the nearest first.
    fn ancestors(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(self.parents[node], |&node| self.parents[node])
    }

    /// The link of each part, with the node of the part.
    pub(super) fn assign(
        &self,
        links: &[String],
        table: &[(String, String)],
    ) -> Result<Vec<(usize, usize)>, PartsError> {
        let all: Vec<Option<&str>> =
            self.nodes().iter().map(|node| node["name"].as_str()).collect();
        let nodes = NodeNames::new(&all, &self.parents);
        let numbers: BTreeMap<&str, usize> =
            links.iter().enumerate().map(|(number, name)| (name.as_str(), number)).collect();
        let mut found: BTreeMap<usize, usize> = BTreeMap::new();
        for (node, link) in table {
            let Some(&number) = numbers.get(link.as_str()) else {
                let nearest = nearest(link, links.iter().map(String::as_str));
                let (found, known) = (link.clone(), links.to_vec());
                return Err(PartsError::UnknownLink { found, nearest, known });
            };
            let Some(at) = only(node, nodes.exact(node))? else {
                let nearest = nearest(node, self.names());
                let (found, known) = (node.clone(), self.names().map(str::to_owned).collect());
                return Err(PartsError::UnknownNode { found, nearest, known });
            };
            if let Some(other) = found.insert(at, number).filter(|&other| other != number) {
                let (node, links) = (node.clone(), [other, number].map(|k| links[k].clone()));
                return Err(PartsError::TwoLinks { node, links });
            }
        }
        let assigned: BTreeSet<usize> = found.values().copied().collect();
        for (number, link) in links.iter().enumerate().filter(|(k, _)| !assigned.contains(k)) {
            if let Some(at) = only(link, nodes.find(link))? {
                found.entry(at).or_insert(number);
            }
        }
        // Parts of the base do not move.
        let moved: Vec<(usize, usize)> =
            found.into_iter().filter(|&(_, link)| link != 0).map(|(at, link)| (link, at)).collect();
        if moved.is_empty() {
            let nodes = self.names().map(str::to_owned).collect();
            return Err(PartsError::NoMatch { nodes, links: links.to_vec() });
        }
        Ok(moved)
    }

    /// The transform of the parent of a node in the scene.
    fn scene_from_parent(&self, node: usize) -> Matrix4<f64> {
        let all = self.ancestors(node);
        all.fold(Matrix4::identity(), |inner, node| local(&self.nodes()[node]) * inner)
    }

    /// The file with animated nodes around its parts, numbered from [`PartsFile::node_count`] on, and with an animation of them.
    pub(super) fn animated(
        &self,
        moved: &[MovedNode],
        animation: Document,
        notes: &Value,
    ) -> Result<Vec<u8>, Error> {
        let mut document = self.document.clone();
        let first = self.node_count();
        let mut holders = Vec::new();
        let mut animated = Vec::new();
        for (name, node, start) in moved {
            let at = self.scene_from_parent(*node);
            let child = if at == Matrix4::identity() {
                *node
            } else {
                let matrix: Vec<f64> = at.iter().copied().collect();
                holders.push(json!({ "matrix": matrix, "children": [node] }));
                first + moved.len() + holders.len() - 1
            };
            let mut entry = json!({ "name": name, "children": [child] });
            if let Some((place, turn)) = start {
                entry["translation"] = json!(place.map(single));
                entry["rotation"] = json!(turn.map(single));
            }
            animated.push(entry);
        }
        // Parts leave their parents, and scenes: animated nodes contain them now.
        let moved_nodes: BTreeSet<usize> = moved.iter().map(|(_, node, _)| *node).collect();
        let is_moved = |value: &Value| index(value).is_some_and(|node| moved_nodes.contains(&node));
        let roots: Vec<usize> = (first..first + moved.len()).collect();
        let nodes = array(&mut document, "nodes");
        for node in nodes.iter_mut() {
            if remove(node, "children", is_moved) && node.get("extras").is_none() {
                // Some programs report nodes without any contents.
                node["extras"] = json!({ "moved": "its parts are in animated nodes" });
            }
        }
        nodes.extend(animated);
        nodes.extend(holders);
        let shown = document["scene"].as_u64().map_or(Some(0), |shown| usize::try_from(shown).ok());
        let all_roots: Vec<usize> = (0..first)
            .filter(|&node| self.parents[node].is_none() && !is_moved(&json!(node)))
            .collect();
        let scenes = array(&mut document, "scenes");
        if scenes.is_empty() {
            scenes.push(json!({ "nodes": all_roots }));
        }
        for scene in scenes.iter_mut() {
            remove(scene, "nodes", is_moved);
        }
        let shown = shown.filter(|&shown| shown < scenes.len()).unwrap_or(0);
        array(&mut scenes[shown], "nodes").extend(roots.iter().map(|root| json!(root)));
        document["scene"] = json!(shown);
        let bytes = self.add(&mut document, animation);
        document["asset"]["version"] = json!("2.0");
        document["asset"]["generator"] =
            json!(match self.document["asset"]["generator"].as_str() {
                Some(before) => format!("{before}; animated by {GENERATOR}"),
                None => GENERATOR.to_owned(),
            });
        document["asset"]["extras"] = notes.clone();
        binary(serde_json::to_vec(&document).expect("all keys are strings"), bytes)
    }

    /// Adds an animation with its numbers; returns the numbers of the whole file.
    fn add(&self, document: &mut Value, animation: Document) -> Vec<u8> {
        let mut bytes = self.bytes.clone();
        if animation.channels.is_empty() {
            return bytes;
        }
        while !bytes.len().is_multiple_of(4) {
            bytes.push(0);
        }
        let start = bytes.len();
        let Document { buffer, channels, samplers, .. } = animation;
        bytes.extend(&buffer.bytes);
        let buffers = array(document, "buffers");
        if buffers.is_empty() {
            buffers.push(json!({}));
        }
        buffers[0]["byteLength"] = json!(bytes.len());
        let views = array(document, "bufferViews");
        let first_view = views.len();
        for view in &buffer.views {
            let mut view = written(to_value(view));
            let offset = view["byteOffset"].as_u64().unwrap_or(0);
            view["byteOffset"] = json!(offset + start as u64);
            views.push(view);
        }
        let accessors = array(document, "accessors");
        let first_accessor = accessors.len();
        for accessor in &buffer.accessors {
            let mut accessor = written(to_value(accessor));
            raise(&mut accessor["bufferView"], first_view);
            accessors.push(accessor);
        }
        let samplers: Vec<Value> = samplers
            .iter()
            .map(|sampler| {
                let mut sampler = written(to_value(sampler));
                raise(&mut sampler["input"], first_accessor);
                raise(&mut sampler["output"], first_accessor);
                sampler
            })
            .collect();
        let channels: Vec<Value> =
            channels.iter().map(|channel| written(to_value(channel))).collect();
        let motion = json!({ "name": "motion", "channels": channels, "samplers": samplers });
        array(document, "animations").push(motion);
        bytes
    }
}

/// Whether a node is its own ancestor, by the parents of all nodes; each node is visited once.
fn has_cycle(parents: &[Option<usize>]) -> bool {
    // The walk that has visited a node.
    let mut walks = vec![None; parents.len()];
    (0..parents.len()).any(|walk| {
        let mut node = walk;
        while walks[node].is_none() {
            walks[node] = Some(walk);
            match parents[node] {
                Some(parent) => node = parent,
                None => return false,
            }
        }
        walks[node] == Some(walk)
    })
}

/// The only node of a name; `None` if there is none.
fn only(name: &str, found: &[usize]) -> Result<Option<usize>, PartsError> {
    match found {
        [] => Ok(None),
        [only] => Ok(Some(*only)),
        _ => Err(PartsError::Ambiguous { name: name.to_owned(), count: found.len() }),
    }
}

fn index(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

fn written(object: serde_json::Result<Value>) -> Value {
    object.expect("all keys are strings")
}

fn raise(index: &mut Value, by: usize) {
    let found = self::index(index).expect("our own files have indices");
    *index = json!(found + by);
}

/// A list of an object, made if it is not there or no list.
fn array<'a>(object: &'a mut Value, key: &str) -> &'a mut Vec<Value> {
    let list = &mut object[key];
    if !list.is_array() {
        *list = json!([]);
    }
    list.as_array_mut().expect("it is one now")
}

/// Removes entries of a list, and the list where it becomes empty, as glTF has none of those; returns whether it did.
fn remove(object: &mut Value, key: &str, is_removed: impl Fn(&Value) -> bool) -> bool {
    let Some(list) = object.get_mut(key).and_then(Value::as_array_mut) else { return false };
    list.retain(|entry| !is_removed(entry));
    let is_empty = list.is_empty();
    if is_empty && let Some(object) = object.as_object_mut() {
        object.remove(key);
    }
    is_empty
}

/// The transform of a node in its parent.
fn local(node: &Value) -> Matrix4<f64> {
    fn numbers<const N: usize>(value: &Value) -> Option<[f64; N]> {
        let list: Vec<f64> = value.as_array()?.iter().filter_map(Value::as_f64).collect();
        list.try_into().ok()
    }
    if let Some(columns) = numbers::<16>(&node["matrix"]) {
        return Matrix4::from_column_slice(&columns);
    }
    let [x, y, z] = numbers(&node["translation"]).unwrap_or([0.0; 3]);
    let [i, j, k, w] = numbers(&node["rotation"]).unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = numbers::<3>(&node["scale"]).unwrap_or([1.0; 3]);
    Translation3::new(x, y, z).to_homogeneous()
        * UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k)).to_homogeneous()
        * Matrix4::new_nonuniform_scaling(&scale.into())
}
