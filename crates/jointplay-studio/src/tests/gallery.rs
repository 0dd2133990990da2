//! The gallery of the documentation: the motions of the catalogue that it plays are those that the library computes.
//!
//! `INSTA_UPDATE=always cargo test -p jointplay-studio gallery` writes the files.

use std::ops::ControlFlow;
use std::path::Path;
use std::{env, fs};

use jointplay::mechanism::{Closure, Drive, DrivePath, Waypoint, drive_from, held_actuators};
use jointplay::nalgebra::DVector;
use serde_json::{Map, Value, json};

use super::{get, repository};
use crate::mechanism_source::{self, ReadMechanism};
use crate::wire::mechanism_view::MechanismSource;
use crate::wire::pose::PlacedDocument;

/// Mechanisms whose motions are computed again in each run: all of them take seconds.
const COMPUTED: [&str; 5] = ["bennett", "four-bar", "gpr-mechanism", "sarrus", "slider-crank"];
/// Greatest turn of the driven joints to each side [rad].
const TURN: f64 = 0.7;
/// Greatest travel of the driven joints to each side, as a share of the size of the mechanism.
const TRAVEL: f64 = 0.3;
/// Poses to each side of the configuration of the file; the greater number where links move far between fewer.
const POSES: [usize; 2] = [10, 40];
/// Greatest change between poses that interpolation hides, as a share of the size of the mechanism and in direction cosines.
const FAR: f64 = 0.3;
/// Fewest poses of a motion that shows anything.
const FEWEST: usize = 9;
/// Rounding of lengths [m] and of direction cosines in the files: finer than a pixel.
const ROUNDING: f64 = 1e-5;

#[test]
fn the_gallery_plays_the_motions_of_the_library() {
    let folder = repository("docs/gallery");
    let update = env::var("INSTA_UPDATE").is_ok_and(|mode| mode == "always");
    let mut index = Vec::new();
    let mut differences = Vec::new();
    for entry in get("/api/v1/catalogue").json().as_array().unwrap() {
        let name = entry["name"].as_str().unwrap();
        let text = entry["text"].as_str().unwrap();
        if !text.contains("kind = \"mechanism\"") {
            // The three-rod robot is on the start page.
            continue;
        }
        let file = format!("{name}.json");
        let there = folder.as_ref().map(|folder| read(&folder.join(&file)));
        let is_computed = update || COMPUTED.contains(&name);
        if folder.is_none() && !is_computed {
            continue;
        }
        let known = there.as_ref().filter(|_| !is_computed);
        let found = recorded(text, known);
        let poses = found["poses"].as_array().unwrap().len();
        assert!(poses >= FEWEST, "{name}: {poses} poses");
        index.push(json!({ "name": name, "title": found["name"], "driven": found["driven"] }));
        differences.extend(folder.as_ref().and_then(|at| compared(&at.join(file), &found, update)));
    }
    let index = Value::Array(index);
    differences
        .extend(folder.and_then(|folder| compared(&folder.join("index.json"), &index, update)));
    assert!(differences.is_empty(), "{differences:?} differ; see the head of this file");
}

/// A file of the gallery; null if it is not there.
fn read(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// The path of the file if it differs from a value by more than rounding; with `update`, writes it instead.
fn compared(path: &Path, value: &Value, update: bool) -> Option<String> {
    if equal(&read(path), value) {
        return None;
    }
    if update {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, format!("{value}\n")).unwrap();
        return None;
    }
    Some(path.display().to_string())
}

/// Whether two values have the same structure and texts, and numbers within the rounding.
fn equal(one: &Value, other: &Value) -> bool {
    match (one, other) {
        (Value::Array(one), Value::Array(other)) => {
            one.len() == other.len() && one.iter().zip(other).all(|(a, b)| equal(a, b))
        }
        (Value::Object(one), Value::Object(other)) => {
            one.len() == other.len()
                && one.iter().all(|(key, a)| other.get(key).is_some_and(|b| equal(a, b)))
        }
        (Value::Number(one), Value::Number(other)) => {
            let (one, other) = (one.as_f64().unwrap(), other.as_f64().unwrap());
            (one - other).abs() <= 1.5 * ROUNDING
        }
        _ => one == other,
    }
}

/// A mechanism as the renderer takes it, with its motion from one side to the other, which is that of `known` if given.
fn recorded(text: &str, known: Option<&Value>) -> Value {
    let source =
        MechanismSource { text: text.to_owned(), loops: None, parameters: Default::default() };
    let Ok(read) = mechanism_source::read(&source) else { panic!("cannot read {text}") };
    let Ok(document) = read.document(None, 1.0) else { panic!("cannot close {text}") };
    let start = document.configuration.as_ref().unwrap().coordinates.clone();
    let start = DVector::from_vec(start);
    let moved = known.map_or_else(
        || {
            let (driven, poses) = motion(&read, &start, document.size_m);
            let name = |&k: &usize| read.coordinates.all()[k].name.clone();
            let driven: Vec<_> = driven.iter().map(name).collect();
            json!({ "driven": driven, "poses": poses })
        },
        Value::clone,
    );
    let all = serde_json::to_value(&document).unwrap();
    let mut value = Map::new();
    for key in ["name", "source", "links", "joints", "virtual_joints", "size_m"] {
        value.insert(key.to_owned(), all[key].clone());
    }
    for key in ["view_direction", "bar_radius_m", "joint_radius_m"] {
        value.insert(key.to_owned(), all[key].clone());
    }
    for key in ["driven", "poses"] {
        value.insert(key.to_owned(), moved[key].clone());
    }
    rounded(Value::Object(value))
}

fn rounded(value: Value) -> Value {
    match value {
        Value::Array(all) => all.into_iter().map(rounded).collect(),
        Value::Object(all) => {
            Value::Object(all.into_iter().map(|(key, value)| (key, rounded(value))).collect())
        }
        Value::Number(number) if number.is_f64() => {
            let per_unit = ROUNDING.recip().round();
            // The sum has no negative zero.
            json!((number.as_f64().unwrap() * per_unit).round() / per_unit + 0.0)
        }
        other => other,
    }
}

/// The driven coordinates, and the poses of all links along the motion: place, then the first two rows of the rotation.
fn motion(
    read: &ReadMechanism,
    start: &DVector<f64>,
    size: f64,
) -> (Vec<usize>, Vec<Vec<[f64; 9]>>) {
    let mechanism = &read.file.mechanism;
    let actuated = mechanism.actuated_coordinates();
    let first = vec![actuated.first().copied().unwrap_or(0)];
    // Where one motor alone cannot move, or moves by play alone, all move together.
    let one = mechanism.virtual_joints().is_empty() || actuated.is_empty();
    let choices = if one { [first, actuated] } else { [actuated, first] };
    for driven in choices.into_iter().filter(|driven| !driven.is_empty()) {
        for count in POSES {
            let side = |sign: f64| side(read, start, &driven, sign, size, count);
            let mut points = side(-1.0);
            points.reverse();
            points.push(start.clone());
            points.extend(side(1.0));
            let poses: Vec<_> = points.iter().map(|at| poses(read, at)).collect();
            let is_last = Some(&count) == POSES.last();
            if poses.len() >= FEWEST && (is_last || farthest(&poses, size) <= FAR) {
                return (driven, poses);
            }
        }
    }
    (Vec::new(), Vec::new())
}

/// Greatest change of a link between two poses, as a share of the size and in direction cosines.
fn farthest(poses: &[Vec<[f64; 9]>], size: f64) -> f64 {
    let change = |a: &[f64; 9], b: &[f64; 9]| {
        let one =
            |(k, (a, b)): (usize, (&f64, &f64))| (a - b).abs() / if k < 3 { size } else { 1.0 };
        a.iter().zip(b).enumerate().map(one).fold(0.0, f64::max)
    };
    let steps = poses.windows(2).flat_map(|two| two[0].iter().zip(&two[1]));
    steps.map(|(a, b)| change(a, b)).fold(0.0, f64::max)
}

/// Configurations of a motion to one side of the start, without it, at equal shares.
fn side(
    read: &ReadMechanism,
    start: &DVector<f64>,
    driven: &[usize],
    sign: f64,
    size: f64,
    count: usize,
) -> Vec<DVector<f64>> {
    let mechanism = &read.file.mechanism;
    let drives: Vec<Drive> = driven
        .iter()
        .map(|&coordinate| {
            let is_length = ["mm", "m", "inch"].contains(&read.coordinates.unit(coordinate));
            let by = if is_length { TRAVEL * size } else { TURN };
            Drive { coordinate, to: start[coordinate] + sign * by }
        })
        .collect();
    let path = DrivePath::line(start, &drives).unwrap();
    let held = held_actuators(mechanism, path.coordinates());
    let Ok(moved) = drive_from(mechanism, start, &path, &held, 2 * count, None, &mut |_| {
        ControlFlow::Continue(())
    }) else {
        return Vec::new();
    };
    // Within the limits of the file.
    let within = |point: &&Waypoint| mechanism.beyond_limits(&point.coordinates).is_empty();
    let points: Vec<&Waypoint> = moved.waypoints.iter().take_while(within).collect();
    let last = points.last().map_or(0.0, |point| point.share);
    let mut chosen = Vec::new();
    for k in 1..=count {
        let share = last * k as f64 / count as f64;
        let nearest = points
            .iter()
            .min_by(|a, b| (a.share - share).abs().total_cmp(&(b.share - share).abs()));
        chosen.extend(nearest.map(|point| point.coordinates.clone()));
    }
    chosen.dedup();
    chosen
}

fn poses(read: &ReadMechanism, at: &DVector<f64>) -> Vec<[f64; 9]> {
    let closed =
        Closure { coordinates: at.clone(), residual: 0.0, iterations: 0, is_searched: false };
    let Ok(found) = read.configuration(&closed, 1.0) else { panic!("no poses") };
    let numbers = |pose: &PlacedDocument| {
        let mut all = [0.0; 9];
        all[..3].copy_from_slice(&pose.origin_m.0);
        all[3..6].copy_from_slice(&pose.rotation[0].0);
        all[6..].copy_from_slice(&pose.rotation[1].0);
        all
    };
    found.poses.iter().map(numbers).collect()
}
