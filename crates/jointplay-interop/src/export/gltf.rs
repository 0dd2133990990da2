//! A cell in motion for 3D viewers: glTF 2.0 in one binary file.

mod buffer;
mod document;
mod material;
mod numbers;
mod parts;

use jointplay_cell::program::{HandoverDeflection, handover_deflections};
use jointplay_cell::station::SlotId;
use jointplay_cell::workcell::Cell;
use serde_json::{Map, Value, json};

use self::document::Document;
use self::numbers::single;
use self::parts::{Parts, slot_name};
use super::error::Error;
use super::motion_export::MotionExport;
use super::scene::{Scene, SlotStay, Track};
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
/// Numbers are single precision, as glTF has them; keys that follow from their neighbours are left out.
pub fn gltf(motion_export: &MotionExport<'_>, rate: f64) -> Result<Vec<u8>, Error> {
    let scene = Scene::of(motion_export, rate, true)?;
    let mut document = Document::default();
    let mut parts = Parts::default();
    // The first node is the base, whose children are known at the end.
    document.nodes.push(Value::Null);
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); scene.tracks.len() + 1];
    let mut nodes = Vec::with_capacity(scene.tracks.len());
    for (k, track) in scene.tracks.iter().enumerate() {
        let node = document.nodes.len();
        nodes.push(node);
        children[track.parent.map_or(0, |parent| parent + 1)].push(node);
        document.nodes.push(standing(track, motion_export.cell));
        let shown = parts.of_track(&mut document, motion_export.cell, track.of);
        children[k + 1].extend(shown);
        document.animate(node, track, &scene.times);
    }
    children[0].extend(parts.of_world(&mut document, motion_export.cell));
    let half = std::f64::consts::FRAC_1_SQRT_2;
    document.nodes[0] = json!({ "name": "base", "rotation": [-half, 0.0, 0.0, half] });
    for (node, children) in std::iter::once(0).chain(nodes).zip(children) {
        if !children.is_empty() {
            document.nodes[node]["children"] = json!(children);
        }
    }
    file_of(document, motion_export)
}

/// A node that stands where its track begins; that of a wafer tells in which slots it lies, as their nodes are called.
fn standing(track: &Track, cell: &Cell) -> Value {
    let mut node = json!({ "name": track.name });
    if let (Some(place), Some(turn)) = (track.places.first(), track.turns.first()) {
        node["translation"] = json!(place.map(single));
        node["rotation"] = json!(turn.map(single));
    }
    let told = |&SlotStay { slot: SlotId { station, slot }, from, to }: &SlotStay| {
        let name = slot_name(&cell.stations[station], slot);
        json!({ "slot": name, "from_s": from, "to_s": to })
    };
    if !track.slot_stays.is_empty() {
        node["extras"] = json!({ "lies": track.slot_stays.iter().map(told).collect::<Vec<_>>() });
    }
    node
}

/// Each handover of a wafer with its time, and the distance by which the effector jumps then, as its arm takes the weight or gives it up.
fn hand_overs(motion_export: &MotionExport<'_>) -> Vec<Value> {
    let MotionExport { cell, motion, .. } = *motion_export;
    let told = |one: &HandoverDeflection| {
        json!({
            "time_s": motion.times[one.step + 1],
            "effector": motion_export.effector_name(one.effector),
            "slot": slot_name(&cell.stations[one.slot.station], one.slot.slot),
            "jump_um": um(one.jump),
        })
    };
    handover_deflections(cell, &motion.steps).iter().map(told).collect()
}

/// The file: a header, the description, the numbers.
fn file_of(document: Document, motion_export: &MotionExport<'_>) -> Result<Vec<u8>, Error> {
    let mut told = Map::new();
    told.insert("duration_s".to_owned(), json!(motion_export.motion.duration()));
    if let Some(warning) = motion_export.warning() {
        let all = motion_export
            .violation_notes
            .iter()
            .map(|violation_note| json!({ "from_s": violation_note.from, "to_s": violation_note.to, "message": violation_note.message }));
        told.insert("warning".to_owned(), json!(warning));
        told.insert("violations".to_owned(), all.collect());
    }
    let handovers = hand_overs(motion_export);
    if !handovers.is_empty() {
        told.insert("hand_overs".to_owned(), json!(handovers));
    }
    let (views, accessors, bytes) = document.buffer.finish();
    let mut root = json!({
        "asset": {
            "version": "2.0",
            "generator": concat!("jointplay ", env!("CARGO_PKG_VERSION")),
            "extras": told,
        },
        "scene": 0,
        "scenes": [{ "name": motion_export.cell.name, "nodes": [0] }],
        "nodes": document.nodes,
        "meshes": document.meshes,
        "materials": document.materials.iter().map(|one| one.describe()).collect::<Vec<_>>(),
        "buffers": [{ "byteLength": bytes.len() }],
        "bufferViews": views,
        "accessors": accessors,
    });
    if !document.channels.is_empty() {
        let name = if motion_export.violation_notes.is_empty() {
            "program"
        } else {
            "program, NOT SAFE TO RUN"
        };
        root["animations"] =
            json!([{ "name": name, "channels": document.channels, "samplers": document.samplers }]);
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
