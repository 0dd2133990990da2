//! Changes of a cell file that keep its comments.

use jointplay_cell::station::{Approach, Stroke};
use jointplay_core::spatial::Tilt;
use nalgebra::Vector3;
use toml_edit::{Array, DocumentMut, InlineTable, Item, TableLike, Value};

use super::problem::{Fault, Problem};
use crate::file_problem::FileProblem;
use crate::place::{Error, Form, nearest};
use crate::units::{deg, mm, shift};

/// A new value of a station.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Where the centre of the lowest wafer rests, in the base frame (m); of a drift, both places are moved alike.
    Position(Vector3<f64>),
    /// Turn about the vertical (rad).
    Yaw(f64),
    /// How it leans; in place of taught points and of a drift.
    Tilt(Tilt),
    /// The same, but a drift stays one: the place of its last slot is turned about that of its first.
    Turned(Tilt),
    /// Taught points in the base frame, and how far from their plane they may be (m); in place of a tilt and of a drift.
    Taught {
        /// The points (m).
        points: Vec<Vector3<f64>>,
        /// The threshold (m).
        threshold: f64,
        /// Standard deviation of a measured coordinate; `None` keeps what the file says (m).
        noise: Option<f64>,
    },
    /// Where the wafers of the first and the last slot rest (m); in place of position, tilt and taught points.
    Drift {
        /// Of the first slot (m).
        first: Vector3<f64>,
        /// Of the last slot (m).
        last: Vector3<f64>,
    },
    /// From slot to slot (m).
    Pitch(f64),
    /// Added in the station frame (m).
    Offset(Vector3<f64>),
    /// Heights of handing over, and their speed.
    Stroke(Stroke),
    /// Reach at which the arm counts as retracted (m).
    Retract(f64),
    /// Places passed on the way, in the station frame (m).
    Via(Vec<Vector3<f64>>),
    /// How it is entered.
    Approach(Approach),
    /// How long it works on a wafer (s).
    ProcessTime(f64),
}

/// The text of a cell file in which one station has other values; all else stays, comments included.
///
/// What the values come to is not looked at: read the text for that.
///
/// # Errors
/// The text is no TOML, or has no station of this name.
pub fn set_station(text: &str, name: &str, changes: &[Change]) -> Result<String, Problem> {
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        let message = error.message().replace('\n', " ");
        let span = error.span().unwrap_or(0..0);
        Error::at(text, span, FileProblem::from(Form::Malformed { message }).into())
    })?;
    let mut table = station(&mut document, name).map_err(|fault| Error::at(text, 0..0, fault))?;
    for change in changes {
        apply(&mut table, change);
    }
    Ok(document.to_string())
}

/// How the note of a station begins that was taught in contact.
const NOTE: &str = "# Taught in contact: ";

/// The text of a cell file with a note before one station that it was taught in contact; an earlier note of this kind is replaced, or dropped without a new one.
///
/// # Arguments
/// * `touching` – pairs of names that touched
///
/// # Errors
/// As [`set_station`].
pub fn note_station(text: &str, name: &str, touching: &[[String; 2]]) -> Result<String, Problem> {
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        let message = error.message().replace('\n', " ");
        let span = error.span().unwrap_or(0..0);
        Error::at(text, span, FileProblem::from(Form::Malformed { message }).into())
    })?;
    // That there is such a station, as for its values.
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
    match document.get_mut("station") {
        Some(Item::ArrayOfTables(tables)) => {
            let found = tables.iter_mut().find(|it| is_called(*it, name));
            if let Some(table) = found {
                let prefix = noted(table.decor().prefix(), "");
                table.decor_mut().set_prefix(prefix);
            }
        }
        Some(Item::Value(Value::Array(list))) => {
            let mut tables = list.iter_mut().filter_map(Value::as_inline_table_mut);
            if let Some(table) = tables.find(|it| is_called(*it, name)) {
                let prefix = noted(table.decor().prefix(), "\n    ");
                table.decor_mut().set_prefix(prefix);
            }
        }
        _ => {}
    }
    Ok(document.to_string())
}

fn is_called(table: &dyn TableLike, name: &str) -> bool {
    table.get("name").and_then(Item::as_str) == Some(name)
}

/// A station: a table of its own under `[[station]]`, or one of the list `station = [{ … }]`.
struct Station<'d> {
    table: &'d mut dyn TableLike,
    is_inline: bool,
}

impl Station<'_> {
    fn name(&self) -> Option<&str> {
        self.table.get("name").and_then(Item::as_str)
    }

    /// Puts a value where the old one stood, with the comment behind it.
    fn set(&mut self, key: &str, mut value: Value) {
        if let Some(old) = self.table.get_mut(key).and_then(Item::as_value_mut) {
            replace(old, value);
            return;
        }
        // What stands behind the last value goes on to stand before the brace.
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

    /// The noise of its taught points, as the file says (µm).
    fn taught_noise(&self) -> Option<f64> {
        let noise = self.table.get("taught")?.as_table_like()?.get("noise_um")?.as_value()?;
        noise.as_float().or_else(|| noise.as_integer().map(|whole| whole as f64))
    }

    /// A station placed by its drift is placed by the first of its two places instead.
    fn undrift(&mut self) {
        let drift = self.table.get("drift").and_then(Item::as_table_like);
        let place = |key| drift.and_then(|drift| drift.get(key)).cloned();
        let (first, last) = (place("first_mm"), place("last_mm"));
        let Some(Item::Value(first)) = first else { return };
        if let Some(pitch) = self.drifted_pitch(&first, last.as_ref().and_then(Item::as_value)) {
            self.set("pitch_mm", number(pitch));
        }
        self.drop_keys(&["drift"]);
        self.set("position_mm", first);
    }

    /// The places of first and last slot of a station placed by its drift, each as another one; whether there are such.
    fn redrift(&mut self, to: impl Fn(Vector3<f64>, Vector3<f64>) -> [Vector3<f64>; 2]) -> bool {
        let Some(drift) = self.table.get_mut("drift").and_then(Item::as_table_like_mut) else {
            return false;
        };
        let place = |key| drift.get(key).and_then(Item::as_value).and_then(coordinates);
        let (Some(first), Some(last)) = (place("first_mm"), place("last_mm")) else { return false };
        for (key, place) in ["first_mm", "last_mm"].into_iter().zip(to(first, last)) {
            if let Some(old) = drift.get_mut(key).and_then(Item::as_value_mut) {
                replace(old, Value::Array(place.iter().map(|&mm| tidy(mm)).collect()));
            }
        }
        true
    }

    /// The pitch that a drift tells, where the station has slots and no pitch of its own (mm).
    fn drifted_pitch(&self, first: &Value, last: Option<&Value>) -> Option<f64> {
        let slots = self.table.get("slots").and_then(Item::as_integer)?;
        if slots < 2 || self.table.contains_key("pitch_mm") {
            return None;
        }
        let (first, last) = (coordinates(first)?, coordinates(last?)?);
        #[expect(clippy::cast_precision_loss, reason = "a count of slots")]
        Some((last - first).norm() / (slots - 1) as f64)
    }
}

/// Puts another value where one stands, with what is written around it.
fn replace(old: &mut Value, mut new: Value) {
    // Within a table or a list, what stays the same keeps how it was written.
    *new.decor_mut() = old.decor().clone();
    *old = new;
}

/// A length without the round-off of sums and turns, of far less than a nanometre (mm).
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

fn station<'d>(document: &'d mut DocumentMut, name: &str) -> Result<Station<'d>, Fault> {
    let stations: Vec<Station<'d>> = match document.get_mut("station") {
        Some(Item::ArrayOfTables(tables)) => {
            tables.iter_mut().map(|table| Station { table, is_inline: false }).collect()
        }
        Some(Item::Value(Value::Array(list))) => list
            .iter_mut()
            .filter_map(Value::as_inline_table_mut)
            .map(|table| Station { table, is_inline: true })
            .collect(),
        _ => {
            let whose = "a cell whose stations can be changed".to_owned();
            return Err(FileProblem::MissingKey { whose, key: "[[station]]".to_owned() }.into());
        }
    };
    let names: Vec<String> =
        stations.iter().filter_map(|station| station.name().map(str::to_owned)).collect();
    let mut stations = stations.into_iter();
    stations.find(|station| station.name() == Some(name)).ok_or_else(|| {
        let problem = FileProblem::Unknown {
            what: "station".to_owned(),
            found: name.to_owned(),
            nearest: nearest(name, names.iter().map(String::as_str)),
            known: names,
        };
        problem.into()
    })
}

fn apply(station: &mut Station<'_>, change: &Change) {
    match change {
        Change::Position(position) => {
            let to = position.map(mm);
            if !station.redrift(|first, last| [to, last + (to - first)]) {
                station.set("position_mm", point(position));
            }
        }
        Change::Yaw(yaw) => station.set("yaw_deg", number(deg(*yaw))),
        Change::Turned(tilt) => {
            let up = tilt.normal();
            let turned = |first: Vector3<f64>, last: Vector3<f64>| {
                [first, first + up * (last - first).norm()]
            };
            if !station.redrift(turned) {
                apply(station, &Change::Tilt(*tilt));
            }
        }
        Change::Tilt(tilt) => {
            station.undrift();
            station.drop_keys(&["taught"]);
            let values = [("yaw_deg", deg(tilt.yaw)), ("pitch_deg", deg(tilt.pitch))];
            station.set("tilt", inline(values.map(|(key, value)| (key, number(value)))));
        }
        Change::Taught { points, threshold, noise } => {
            station.undrift();
            station.drop_keys(&["tilt"]);
            let points: Array = points.iter().map(point).collect();
            let threshold = number(shift(*threshold, 6));
            let noise = noise.map(|noise| shift(noise, 6)).or_else(|| station.taught_noise());
            let values = [("points_mm", Value::Array(points)), ("threshold_um", threshold)];
            let mut taught = table(values);
            if let Some(noise) = noise {
                taught.insert("noise_um", number(noise));
            }
            station.set("taught", Value::InlineTable(taught));
        }
        Change::Drift { first, last } => {
            station.drop_keys(&["position_mm", "tilt", "taught"]);
            let values = [("first_mm", point(first)), ("last_mm", point(last))];
            station.set("drift", inline(values));
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
    }
}

fn number(value: f64) -> Value {
    Value::from(value)
}

fn point(point: &Vector3<f64>) -> Value {
    Value::Array(point.iter().map(|value| mm(*value)).collect())
}

fn inline<const N: usize>(values: [(&str, Value); N]) -> Value {
    Value::InlineTable(table(values))
}

fn table<const N: usize>(values: [(&str, Value); N]) -> InlineTable {
    let mut table = InlineTable::new();
    for (key, value) in values {
        table.insert(key, value);
    }
    table
}
