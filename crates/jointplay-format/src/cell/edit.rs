//! Changes of a cell file that keep its comments.

use jointplay_cell::station::teach::ReferencePoint;
use jointplay_cell::station::{Approach, Stroke};
use jointplay_core::spatial::Tilt;
use nalgebra::Vector3;
use toml_edit::{Array, DocumentMut, InlineTable, Item, TableLike, Value};

use super::described::{self, Described, TABLES, is_called};
use super::problem::{Fault, Problem};
use crate::file_problem::FileProblem;
use crate::line_ends;
use crate::place::{Error, Form};
use crate::units::{deg, mm, shift};

/// Noise of taught points: the standard deviation of each coordinate.
#[derive(Debug, Clone, PartialEq)]
pub enum TaughtNoise {
    /// Of all points (m).
    Equal(f64),
    /// Of each point (m).
    PerPoint(Vec<f64>),
    /// Noise of a sensor of the cell, by name.
    Sensor(String),
}

/// A new value of a station.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Centre of the lowest wafer at rest, in the base frame (m); a carrier axis moves as a whole.
    Position(Vector3<f64>),
    /// Rotation about the vertical (rad).
    Heading(f64),
    /// Tilt of the station; replaces taught points and a carrier axis.
    Tilt(Tilt),
    /// Tilt of the station; a carrier axis remains, and its last position rotates about its first.
    Turned(Tilt),
    /// Taught points in the base frame, with the largest distance from their plane (m); replace a tilt and a carrier axis.
    Taught {
        /// The points (m).
        points: Vec<Vector3<f64>>,
        /// The threshold (m).
        threshold: f64,
        /// Noise of the points; `None` leaves that of the file.
        noise: Option<TaughtNoise>,
    },
    /// Reference points, which determine centre and heading; replace those of the file and a carrier axis.
    References {
        /// The reference points.
        references: Vec<ReferencePoint>,
        /// Noise of the reference points; `None` leaves that of the file.
        noise: Option<TaughtNoise>,
    },
    /// Wafer centres at rest in the first and the last slot (m); replace position, tilt and taught points.
    CarrierAxis {
        /// In the first slot (m).
        first: Vector3<f64>,
        /// In the last slot (m).
        last: Vector3<f64>,
    },
    /// Distance between neighbouring slots (m).
    Pitch(f64),
    /// Displacement added in the station frame (m).
    Offset(Vector3<f64>),
    /// Heights and speed of the hand-off.
    Stroke(Stroke),
    /// Reach at which the arm counts as retracted (m).
    Retract(f64),
    /// Waypoints of the approach, in the station frame (m).
    Via(Vec<Vector3<f64>>),
    /// Kind of approach.
    Approach(Approach),
    /// Process time of a wafer (s).
    ProcessTime(f64),
    /// Numbers of the slots that hold a wafer at the start, from 1; `None` for all slots.
    Wafers(Option<Vec<usize>>),
}

/// Replaces values of one station in the text of a cell file; everything else remains, including comments.
///
/// The new values are not checked: read the returned text to check them.
///
/// # Errors
/// The text is not TOML, or has no station or no sensor of a name.
pub fn set_station(text: &str, name: &str, changes: &[Change]) -> Result<String, Problem> {
    let mut document = document(text)?;
    let at_start = |fault| Error::at(text, 0..0, fault);
    changes.iter().try_for_each(|change| check_sensor(&document, change)).map_err(at_start)?;
    let inherited = described::inherited(&document, name, &inherited_keys(changes));
    let mut station = station(&mut document, name).map_err(at_start)?;
    for (key, item) in inherited {
        station.table.insert(&key, item);
    }
    let expressions = described::expressions(station.table);
    for change in changes {
        apply(&mut station, change);
    }
    described::check_unchanged(station.table, name, &expressions, text)?;
    Ok(line_ends::as_before(document.to_string(), text))
}

/// A text as a document that keeps its comments.
pub(super) fn document(text: &str) -> Result<DocumentMut, Problem> {
    text.parse().map_err(|error: toml_edit::TomlError| {
        let message = error.message().replace('\n', " ");
        let span = error.span().unwrap_or(0..0);
        Error::at(text, span, FileProblem::from(Form::Malformed { message }).into())
    })
}

/// Checks that the cell has the sensor of a change.
fn check_sensor(document: &DocumentMut, change: &Change) -> Result<(), Fault> {
    let (Change::Taught { noise: Some(TaughtNoise::Sensor(name)), .. }
    | Change::References { noise: Some(TaughtNoise::Sensor(name)), .. }) = change
    else {
        return Ok(());
    };
    let sensors = described::all(document, "sensor");
    let known = sensors.iter().filter_map(|one| one.get("name")?.as_str());
    if known.clone().any(|one| one == name) {
        return Ok(());
    }
    Err(FileProblem::unknown("sensor", name, known).into())
}

/// Keys whose present values the changes need, also where the station takes them from another table.
fn inherited_keys(changes: &[Change]) -> Vec<&'static str> {
    let needs_carrier_axis = |change: &Change| {
        matches!(
            change,
            Change::Position(_)
                | Change::Tilt(_)
                | Change::Turned(_)
                | Change::Taught { .. }
                | Change::References { .. }
        )
    };
    let needs_taught =
        |change: &Change| matches!(change, Change::Taught { .. } | Change::References { .. });
    let mut keys = Vec::new();
    if changes.iter().any(needs_carrier_axis) {
        keys.push("carrier_axis");
    }
    if changes.iter().any(needs_taught) {
        keys.push("taught");
    }
    keys
}

fn station<'d>(document: &'d mut DocumentMut, name: &str) -> Result<Station<'d>, Fault> {
    let Described { table, is_inline } = described::table(document, name)?;
    Ok(Station { table, is_inline })
}

/// Start of the note on a station that was taught in contact.
const NOTE: &str = "# Taught in contact: ";

/// Replaces the note before one station that it was taught in contact.
///
/// An earlier note is replaced, or removed if no pair touches.
///
/// # Arguments
/// * `touching` – pairs of names that touched
///
/// # Errors
/// As [`set_station`].
pub fn note_station(text: &str, name: &str, touching: &[[String; 2]]) -> Result<String, Problem> {
    let mut document = document(text)?;
    // A missing station is an error here, as in `set_station`.
    station(&mut document, name).map_err(|fault| Error::at(text, 0..0, fault))?;
    let pairs: Vec<String> =
        touching.iter().map(|[one, other]| format!("{one} and {other}")).collect();
    let note = (!pairs.is_empty()).then(|| format!("{NOTE}{}.", pairs.join("; ")));
    let noted = |before: Option<&toml_edit::RawString>, indent: &str| {
        let before = before.and_then(toml_edit::RawString::as_str).unwrap_or_default();
        let kept: Vec<&str> =
            before.split('\n').filter(|line| !line.trim_start().starts_with(NOTE)).collect();
        let kept = kept.join("\n");
        match &note {
            None => kept,
            Some(note) if kept.is_empty() => format!("{indent}{note}\n"),
            Some(note) => {
                let (above, last) = kept.rsplit_once('\n').unwrap_or(("", &kept));
                format!("{above}\n{indent}{note}\n{last}")
            }
        }
    };
    for (_, item) in document.iter_mut().filter(|(key, _)| TABLES.contains(&key.get())) {
        match item {
            Item::ArrayOfTables(tables) => {
                if let Some(table) = tables.iter_mut().find(|it| is_called(*it, name)) {
                    let prefix = noted(table.decor().prefix(), "");
                    table.decor_mut().set_prefix(prefix);
                }
            }
            Item::Value(Value::Array(list)) => {
                let mut tables = list.iter_mut().filter_map(Value::as_inline_table_mut);
                if let Some(table) = tables.find(|it| is_called(*it, name)) {
                    let prefix = noted(table.decor().prefix(), "\n    ");
                    table.decor_mut().set_prefix(prefix);
                }
            }
            _ => {}
        }
    }
    Ok(line_ends::as_before(document.to_string(), text))
}

/// Keys of the noise of taught points.
const NOISE_KEYS: [&str; 2] = ["noise_um", "sensor"];
/// Keys of reference points and of their noise.
const REFERENCE_KEYS: [&str; 3] = ["references", "reference_noise_um", "reference_sensor"];

/// A station: a table of its own under `[[station]]`, or one of the list `station = [{ … }]`.
struct Station<'d> {
    table: &'d mut dyn TableLike,
    is_inline: bool,
}

impl Station<'_> {
    /// Replaces the value of a key; the comment after it remains.
    fn set(&mut self, key: &str, mut value: Value) {
        if let Some(old) = self.table.get_mut(key).and_then(Item::as_value_mut) {
            replace(old, value);
            return;
        }
        // A comment after the last value of an inline table moves before its closing brace.
        if self.is_inline
            && let Some((_, Item::Value(last))) = self.table.iter_mut().last()
            && let Some(behind) = last.decor().suffix().cloned()
        {
            last.decor_mut().set_suffix("");
            value.decor_mut().set_suffix(behind);
        }
        self.table.insert(key, Item::Value(value));
    }

    fn drop_keys(&mut self, keys: &[&str]) {
        for key in keys {
            self.table.remove(key);
        }
    }

    /// A value of the taught points in the file.
    fn taught(&self, key: &str) -> Option<Value> {
        self.table.get("taught")?.as_table_like()?.get(key)?.as_value().cloned()
    }

    /// Sets the noise of taught points, or takes that of the file.
    fn set_noise(
        &self,
        taught: &mut InlineTable,
        [noise_key, sensor_key]: [&str; 2],
        noise: Option<&TaughtNoise>,
        count: usize,
    ) {
        let micro = |noise: f64| number(shift(noise, 6));
        match noise {
            Some(TaughtNoise::Equal(noise)) => taught.insert(noise_key, micro(*noise)),
            Some(TaughtNoise::PerPoint(noise)) => {
                taught.insert(noise_key, Value::Array(noise.iter().copied().map(micro).collect()))
            }
            Some(TaughtNoise::Sensor(name)) => taught.insert(sensor_key, name.as_str().into()),
            None => {
                for key in [noise_key, sensor_key] {
                    let Some(mut value) = self.taught(key) else { continue };
                    if let Value::Array(list) = &mut value {
                        // Further points are measured as the last one.
                        while list.len() > count {
                            list.remove(list.len() - 1);
                        }
                        while let Some(last) = list.iter().last().cloned()
                            && list.len() < count
                        {
                            list.push(last);
                        }
                    }
                    taught.insert(key, value);
                }
                None
            }
        };
    }

    /// Replaces a carrier axis by the position of its first slot.
    fn remove_carrier_axis(&mut self) {
        let carrier_axis = self.table.get("carrier_axis").and_then(Item::as_table_like);
        let place = |key| carrier_axis.and_then(|carrier_axis| carrier_axis.get(key)).cloned();
        let (first, last) = (place("first_mm"), place("last_mm"));
        let Some(Item::Value(first)) = first else { return };
        if let Some(pitch) = self.carrier_axis_pitch(&first, last.as_ref().and_then(Item::as_value))
        {
            self.set("pitch_mm", number(pitch));
        }
        self.drop_keys(&["carrier_axis"]);
        self.set("position_mm", first);
    }

    /// Moves the positions of the first and last slot of a station with a carrier axis; false without a carrier axis.
    fn move_carrier_axis(
        &mut self,
        to: impl Fn(Vector3<f64>, Vector3<f64>) -> [Vector3<f64>; 2],
    ) -> bool {
        let Some(carrier_axis) =
            self.table.get_mut("carrier_axis").and_then(Item::as_table_like_mut)
        else {
            return false;
        };
        let place = |key| carrier_axis.get(key).and_then(Item::as_value).and_then(coordinates);
        let (Some(first), Some(last)) = (place("first_mm"), place("last_mm")) else { return false };
        for (key, place) in ["first_mm", "last_mm"].into_iter().zip(to(first, last)) {
            if let Some(old) = carrier_axis.get_mut(key).and_then(Item::as_value_mut) {
                replace(old, Value::Array(place.iter().map(|&mm| tidy(mm)).collect()));
            }
        }
        true
    }

    /// The pitch that follows from a carrier axis, if the station has several slots and no `pitch_mm` (mm).
    fn carrier_axis_pitch(&self, first: &Value, last: Option<&Value>) -> Option<f64> {
        let slots = self.table.get("slots").and_then(Item::as_integer)?;
        if slots < 2 || self.table.contains_key("pitch_mm") {
            return None;
        }
        let (first, last) = (coordinates(first)?, coordinates(last?)?);
        #[expect(clippy::cast_precision_loss, reason = "a count of slots")]
        Some((last - first).norm() / (slots - 1) as f64)
    }
}

/// Replaces a value; the white space and comments around it remain.
pub(super) fn replace(old: &mut Value, mut new: Value) {
    // Equal values within a table or a list keep their notation.
    *new.decor_mut() = old.decor().clone();
    *old = new;
}

/// A length without the round-off of sums and rotations, far below a nanometre (mm).
fn tidy(mm: f64) -> f64 {
    const FRACTIONS: f64 = 1e9;
    (mm * FRACTIONS).round() / FRACTIONS
}

/// The three numbers of a point.
fn coordinates(point: &Value) -> Option<Vector3<f64>> {
    let list = point.as_array()?;
    let number = |value: &Value| {
        #[expect(clippy::cast_precision_loss, reason = "as the number is read elsewhere")]
        value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
    };
    let numbers: Vec<f64> = list.iter().map_while(number).collect();
    (list.len() == 3 && numbers.len() == 3).then(|| Vector3::from_column_slice(&numbers))
}

fn apply(station: &mut Station<'_>, change: &Change) {
    match change {
        Change::Position(position) => {
            let to = position.map(mm);
            if !station.move_carrier_axis(|first, last| [to, last + (to - first)]) {
                station.set("position_mm", point(position));
            }
        }
        Change::Heading(heading) => station.set("heading_deg", number(deg(*heading))),
        Change::Turned(tilt) => {
            let up = tilt.normal();
            let turned = |first: Vector3<f64>, last: Vector3<f64>| {
                [first, first + up * (last - first).norm()]
            };
            if !station.move_carrier_axis(turned) {
                apply(station, &Change::Tilt(*tilt));
            }
        }
        Change::Tilt(tilt) => {
            station.remove_carrier_axis();
            station.drop_keys(&["taught"]);
            let values = [("azimuth_deg", deg(tilt.azimuth)), ("angle_deg", deg(tilt.angle))];
            station.set("tilt", inline(values.map(|(key, value)| (key, number(value)))));
        }
        Change::Taught { points, threshold, noise } => {
            station.remove_carrier_axis();
            station.drop_keys(&["tilt"]);
            let count = points.len();
            let points: Array = points.iter().map(point).collect();
            let threshold = number(shift(*threshold, 6));
            let mut taught =
                table([("points_mm", Value::Array(points)), ("threshold_um", threshold)]);
            station.set_noise(&mut taught, NOISE_KEYS, noise.as_ref(), count);
            for key in REFERENCE_KEYS {
                taught.extend(station.taught(key).map(|value| (key, value)));
            }
            station.set("taught", Value::InlineTable(taught));
        }
        Change::References { references, noise } => {
            station.remove_carrier_axis();
            let mut taught = InlineTable::new();
            for key in ["points_mm", "threshold_um", NOISE_KEYS[0], NOISE_KEYS[1]] {
                taught.extend(station.taught(key).map(|value| (key, value)));
            }
            let one = |one: &ReferencePoint| {
                let nominal = one.nominal.iter().map(|value| mm(*value)).collect();
                let values =
                    [("station_mm", Value::Array(nominal)), ("measured_mm", point(&one.measured))];
                Value::InlineTable(table(values))
            };
            let listed: Array = references.iter().map(one).collect();
            taught.insert(REFERENCE_KEYS[0], Value::Array(listed));
            let keys = [REFERENCE_KEYS[1], REFERENCE_KEYS[2]];
            station.set_noise(&mut taught, keys, noise.as_ref(), references.len());
            station.set("taught", Value::InlineTable(taught));
        }
        Change::CarrierAxis { first, last } => {
            station.drop_keys(&["position_mm", "tilt", "taught"]);
            let values = [("first_mm", point(first)), ("last_mm", point(last))];
            station.set("carrier_axis", inline(values));
        }
        Change::Pitch(pitch) => station.set("pitch_mm", number(mm(*pitch))),
        Change::Offset(offset) => station.set("offset_mm", point(offset)),
        Change::Stroke(stroke) => {
            let values = [
                ("below_mm", stroke.below),
                ("above_mm", stroke.above),
                ("speed_mm_s", stroke.speed),
            ];
            station.set("stroke", inline(values.map(|(key, value)| (key, number(mm(value))))));
        }
        Change::Retract(reach) => station.set("retract_mm", number(mm(*reach))),
        Change::Via(via) => station.set("via_mm", Value::Array(via.iter().map(point).collect())),
        Change::Approach(approach) => {
            let word = match approach {
                Approach::Radial => "radial",
                Approach::Line => "line",
            };
            station.set("approach", Value::from(word));
        }
        Change::ProcessTime(time) => station.set("process_s", number(*time)),
        Change::Wafers(None) => station.set("wafers", Value::from("all")),
        Change::Wafers(Some(slots)) => {
            let slots = slots.iter().map(|&slot| i64::try_from(slot).unwrap_or(i64::MAX));
            station.set("wafers", Value::Array(slots.collect()));
        }
    }
}

pub(super) fn number(value: f64) -> Value {
    Value::from(value)
}

pub(super) fn point(point: &Vector3<f64>) -> Value {
    Value::Array(point.iter().map(|value| mm(*value)).collect())
}

pub(super) fn inline<const N: usize>(values: [(&str, Value); N]) -> Value {
    Value::InlineTable(table(values))
}

fn table<const N: usize>(values: [(&str, Value); N]) -> InlineTable {
    let mut table = InlineTable::new();
    for (key, value) in values {
        table.insert(key, value);
    }
    table
}
