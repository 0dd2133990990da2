//! A cell in motion for 3D viewers: glTF 2.0 in one binary file.

mod buffer;
mod document;
mod material;
mod numbers;
mod parts;

use gltf_json::animation::Animation;
use gltf_json::scene::UnitQuaternion;
use gltf_json::{Asset, Index, Node, Root, Scene as SceneOfNodes};
use jointplay_cell::program::{HandoffDeflection, handoff_deflections};
use jointplay_cell::station::SlotId;
use jointplay_cell::workcell::Cell;
use serde_json::{Map, Value, json};

use self::document::Document;
use self::numbers::{extras, single};
use self::parts::{Parts, slot_name};
use super::error::Error;
use super::motion_export::MotionExport;
use super::scene::{Scene, SlotStay, Track};
use super::violation_note::ViolationNote;
use jointplay_format::units::um;

/// The cell with its motion as binary glTF: rods, platform, links, wafers, stations, bodies and zones; one animation, as long as the motion.
///
/// The lengths are in metres; the first node turns the base frame, whose z points up, to glTF's y.
/// Rods, platform and links are drawn by simple shapes where the cell gives them no bodies.
///
/// # Arguments
/// * `rate` – keys a second, between which viewers interpolate by cubics; the last key is the end of the motion (Hz)
///
/// # Errors
/// [`Error::Rate`], [`Error::TooManySamples`], [`Error::TooManyPoses`], [`Error::Placing`], [`Error::TooLarge`]
///
/// # Numerics
/// Numbers are single precision, as glTF has them; keys that follow from their neighbours are omitted.
pub fn gltf(motion_export: &MotionExport<'_>, rate: f64) -> Result<Vec<u8>, Error> {
    let scene = Scene::of(motion_export, rate, true)?;
    let mut document = Document::default();
    let mut parts = Parts::default();
    // The first node is the base, whose children are known at the end.
    let base = Index::push(&mut document.nodes, Node::default());
    let mut children: Vec<Vec<Index<Node>>> = vec![Vec::new(); scene.tracks.len() + 1];
    let mut nodes = Vec::with_capacity(scene.tracks.len());
    for (k, track) in scene.tracks.iter().enumerate() {
        let node = Index::push(&mut document.nodes, initial_node(track, motion_export.cell));
        nodes.push(node);
        children[track.parent.map_or(0, |parent| parent + 1)].push(node);
        let shown = parts.of_track(&mut document, motion_export.cell, track.of);
        children[k + 1].extend(shown);
        document.animate(node, track, &scene.times);
    }
    children[0].extend(parts.of_world(&mut document, motion_export.cell));
    let half = std::f32::consts::FRAC_1_SQRT_2;
    document.nodes[base.value()] = Node {
        name: Some("base".to_owned()),
        rotation: Some(UnitQuaternion([-half, 0.0, 0.0, half])),
        ..Default::default()
    };
    for (node, children) in std::iter::once(base).chain(nodes).zip(children) {
        document.nodes[node.value()].children = (!children.is_empty()).then_some(children);
    }
    binary_file(document, motion_export)
}

/// A node at the first pose of its track; the node of a wafer lists the nodes of the slots that it is in.
fn initial_node(track: &Track, cell: &Cell) -> Node {
    let mut node = Node { name: Some(track.name.clone()), ..Default::default() };
    if let (Some(place), Some(turn)) = (track.places.first(), track.turns.first()) {
        node.translation = Some(place.map(single));
        node.rotation = Some(UnitQuaternion(turn.map(single)));
    }
    let in_slot = |&SlotStay { slot: SlotId { station, slot }, from, to }: &SlotStay| {
        let name = slot_name(&cell.stations[station], slot);
        json!({ "slot": name, "from_s": from, "to_s": to })
    };
    if !track.slot_stays.is_empty() {
        let lies: Vec<Value> = track.slot_stays.iter().map(in_slot).collect();
        node.extras = extras(&json!({ "lies": lies }));
    }
    node
}

/// Each hand-off of a wafer with its time, and the distance by which the effector jumps then, as its arm takes the weight or gives it up.
fn hand_offs(motion_export: &MotionExport<'_>) -> Vec<Value> {
    let MotionExport { cell, motion, .. } = *motion_export;
    let report = |one: &HandoffDeflection| {
        json!({
            "time_s": motion.times[one.step + 1],
            "effector": motion_export.effector_name(one.effector),
            "slot": slot_name(&cell.stations[one.slot.station], one.slot.slot),
            "jump_um": um(one.load_displacement),
        })
    };
    handoff_deflections(cell, &motion.steps).iter().map(report).collect()
}

/// The `extras` of the file: duration, violations and hand-offs of the motion.
fn notes(motion_export: &MotionExport<'_>) -> Value {
    let mut notes = Map::new();
    notes.insert("duration_s".to_owned(), json!(motion_export.motion.duration()));
    if let Some(warning) = motion_export.warning() {
        let note = |note: &ViolationNote| json!({ "from_s": note.from, "to_s": note.to, "message": note.message });
        notes.insert("warning".to_owned(), json!(warning));
        let violations = motion_export.violation_notes.iter().map(note).collect();
        notes.insert("violations".to_owned(), violations);
    }
    let handoffs = hand_offs(motion_export);
    if !handoffs.is_empty() {
        notes.insert("hand_offs".to_owned(), json!(handoffs));
    }
    Value::Object(notes)
}

/// The file: a header, the description, the numbers.
fn binary_file(document: Document, motion_export: &MotionExport<'_>) -> Result<Vec<u8>, Error> {
    let bytes = document.buffer.bytes;
    let mut root = Root {
        asset: Asset {
            version: "2.0".to_owned(),
            generator: Some(concat!("jointplay ", env!("CARGO_PKG_VERSION")).to_owned()),
            extras: extras(&notes(motion_export)),
            ..Default::default()
        },
        scene: Some(Index::new(0)),
        scenes: vec![SceneOfNodes {
            name: Some(motion_export.cell.name.clone()),
            nodes: vec![Index::new(0)],
            extensions: None,
            extras: None,
        }],
        nodes: document.nodes,
        meshes: document.meshes,
        materials: document.materials.iter().map(|one| one.describe()).collect(),
        buffers: vec![gltf_json::Buffer {
            byte_length: bytes.len().into(),
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        }],
        buffer_views: document.buffer.views,
        accessors: document.buffer.accessors,
        ..Default::default()
    };
    if !document.channels.is_empty() {
        let is_safe = motion_export.violation_notes.is_empty();
        let name = if is_safe { "program" } else { "program, NOT SAFE TO RUN" };
        root.animations.push(Animation {
            name: Some(name.to_owned()),
            channels: document.channels,
            samplers: document.samplers,
            extensions: None,
            extras: None,
        });
    }
    let mut text = serde_json::to_vec(&root).expect("all keys are strings");
    while !text.len().is_multiple_of(4) {
        text.push(b' ');
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
