//! A cell in motion for 3D viewers: glTF 2.0 in one binary file.

mod buffer;
mod document;
mod keys;
mod link_shape;
mod material;
mod mechanism_motion;
mod node_names;
mod numbers;
mod part_table;
mod parts;
pub(super) mod parts_error;
mod parts_file;

use gltf_json::scene::UnitQuaternion;
use gltf_json::{Index, Node};
use jointplay_cell::program::{HandoffDeflection, handoff_deflections};
use jointplay_cell::station::SlotId;
use jointplay_cell::workcell::Cell;
use serde_json::{Map, Value, json};

use self::document::{Document, Title, Tolerance};
use self::keys::Samples;
use self::numbers::{extras, single};
use self::parts::{Parts, slot_name};
use super::error::Error;
use super::motion_export::MotionExport;
use super::scene::{Part, Scene, SlotStay, Track};
use super::violation_note::ViolationNote;
use jointplay_format::units::um;

pub use self::mechanism_motion::{AnimatedParts, MechanismMotion, proportional_times};
pub use self::part_table::PartTable;
pub use self::parts_error::PartsError;
pub use self::parts_file::{PartsFile, UpAxis};

/// Largest deviation of points of the animated scene from the samples, unless another is chosen (m).
pub const KEY_TOLERANCE: f64 = 1e-6;

/// The cell with its motion as binary glTF: rods, platform, links, wafers, stations, bodies and zones; one animation, as long as the motion.
///
/// The lengths are in metres; the first node turns the base frame, whose z points up, to glTF's y.
/// Rods, platform and links are drawn by simple shapes where the cell gives them no bodies.
///
/// # Arguments
/// * `rate` – samples a second; others are at the end of the motion, and wherever the jerk of an axis jumps (Hz)
///
/// # Errors
/// [`Error::Rate`], [`Error::TooManySamples`], [`Error::TooManyPoses`], [`Error::Placing`], [`Error::TooLarge`]
///
/// # Numerics
/// Numbers are single precision, as glTF has them; keys are omitted as by [`gltf_within`] with [`KEY_TOLERANCE`].
pub fn gltf(motion_export: &MotionExport<'_>, rate: f64) -> Result<Vec<u8>, Error> {
    gltf_within(motion_export, rate, KEY_TOLERANCE)
}

/// The cell with its motion as [`gltf`], with fewer keys for a larger tolerance.
///
/// # Arguments
/// * `rate` – samples a second (Hz)
/// * `tolerance` – largest deviation of a point of the robot or of a wafer from the samples that are omitted (m)
///
/// # Errors
/// Those of [`gltf`]; [`Error::Tolerance`].
///
/// # Numerics
/// The tolerance is divided among the frames between the base and the point; rounding to single precision adds up to a few tenths of a micrometre.
pub fn gltf_within(
    motion_export: &MotionExport<'_>,
    rate: f64,
    tolerance: f64,
) -> Result<Vec<u8>, Error> {
    check_tolerance(tolerance)?;
    let scene = Scene::at_times(motion_export, key_times(motion_export, rate)?, true)?;
    let mut document = Document::default();
    let mut parts = Parts::default();
    // The first node is the base, whose children are known at the end.
    let base = Index::push(&mut document.nodes, Node::default());
    let mut children: Vec<Vec<Index<Node>>> = vec![Vec::new(); scene.tracks.len() + 1];
    let mut nodes = Vec::with_capacity(scene.tracks.len());
    let tolerances = tolerances(&scene, motion_export.cell, tolerance);
    for (k, track) in scene.tracks.iter().enumerate() {
        let node = Index::push(&mut document.nodes, initial_node(track, motion_export.cell));
        nodes.push(node);
        children[track.parent.map_or(0, |parent| parent + 1)].push(node);
        let shown = parts.of_track(&mut document, motion_export.cell, track.of);
        children[k + 1].extend(shown);
        let of_places: Vec<[f64; 3]> = track.rates.iter().map(|rate| rate.place).collect();
        let of_turns: Vec<[f64; 4]> = track.rates.iter().map(|rate| rate.turn).collect();
        let times = &scene.times;
        let places = Samples { times, values: &track.places, rates: &of_places };
        let turns = Samples { times, values: &track.turns, rates: &of_turns };
        document.animate(node, &places, &turns, tolerances[k]);
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
    let is_safe = motion_export.violation_notes.is_empty();
    document.file(&Title {
        scene: &motion_export.cell.name,
        animation: if is_safe { "program" } else { "program, NOT SAFE TO RUN" },
        notes: &notes(motion_export),
    })
}

/// Times at which there may be keys: at equal intervals, and where the jerk of an axis jumps, since no cubic fits a motion across it (s).
///
/// They are numbers of single precision, so that values and rates are those at the times of the file: late in a long motion, the nearest such number is so far that the velocity there is another.
fn key_times(motion_export: &MotionExport<'_>, rate: f64) -> Result<Vec<f64>, Error> {
    motion_export.check_rate(rate)?;
    let motion = motion_export.motion;
    let jumps = (0..motion.steps.len()).flat_map(|step| {
        let start = motion.times[step];
        motion.jerk_discontinuities(step).into_iter().map(move |since| start + since)
    });
    let rounded = |time: f64| f64::from(single(time)).min(motion.duration());
    let mut times: Vec<f64> = motion.sample_times(rate).iter().chain(jumps).map(rounded).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    Ok(times)
}

/// Weight of an origin in the division of a tolerance among the frames of a chain, as the distance of a point from the origin of a frame is that of its rotation (m).
const PLACE_WEIGHT: f64 = 0.25;

pub(super) fn check_tolerance(tolerance: f64) -> Result<(), Error> {
    if tolerance.is_finite() && tolerance > 0.0 {
        Ok(())
    } else {
        Err(Error::Tolerance { tolerance })
    }
}

/// The part of a tolerance (m) of each track, so that the deviations of a track and of all its parents together stay within it.
fn tolerances(scene: &Scene, cell: &Cell, tolerance: f64) -> Vec<Tolerance> {
    let tracks = &scene.tracks;
    // Distance of the farthest point that a track carries, from its origin.
    let wafer = 0.5 * cell.wafer.diameter;
    let effectors = cell.robot.arms.iter().flat_map(|arm| &arm.effectors);
    let centers = effectors.map(|effector| nalgebra::Vector3::from(effector.wafer_center).norm());
    let blade = centers.fold(0.0, f64::max) + wafer;
    let mut reaches: Vec<f64> = tracks
        .iter()
        .map(|track| if matches!(track.of, Part::Wafer(_)) { wafer } else { blade })
        .collect();
    // Children come after their parents.
    for (k, track) in tracks.iter().enumerate().rev() {
        let Some(parent) = track.parent else { continue };
        let places = track.places.iter().map(|&place| nalgebra::Vector3::from(place).norm());
        reaches[parent] = reaches[parent].max(places.fold(0.0, f64::max) + reaches[k]);
    }
    // Along a chain, the same angle for all rotations, and as much for an origin as for a rotation at its weight.
    let varies = |values: &[[f64; 3]]| values.windows(2).any(|pair| pair[0] != pair[1]);
    let weight = |(track, &reach): (&Track, &f64)| {
        let place = if varies(&track.places) { PLACE_WEIGHT } else { 0.0 };
        let turns = track.turns.windows(2).any(|pair| pair[0] != pair[1]);
        place + if turns { reach } else { 0.0 }
    };
    let mut sums: Vec<f64> = tracks.iter().zip(&reaches).map(weight).collect();
    for (k, track) in tracks.iter().enumerate() {
        sums[k] += track.parent.map_or(0.0, |parent| sums[parent]);
    }
    for (k, track) in tracks.iter().enumerate().rev() {
        if let Some(parent) = track.parent {
            sums[parent] = sums[parent].max(sums[k]);
        }
    }
    let part = |&sum: &f64| {
        let turn = tolerance / sum.max(PLACE_WEIGHT);
        Tolerance { place: turn * PLACE_WEIGHT, turn }
    };
    sums.iter().map(part).collect()
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
