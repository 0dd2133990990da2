//! Changes of a cell file that keep its comments.

use jointplay_cell::station::{Approach, Stroke};
use jointplay_core::spatial::Tilt;
use nalgebra::Vector3;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value};

use super::problem::{Fault, Problem};
use crate::place::{Error, Form, nearest};
use crate::units::{deg, mm, shift};

/// A new value of a station.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Where the centre of the lowest wafer rests, in the base frame [m]; in place of a drift.
    Position(Vector3<f64>),
    /// Turn about the vertical [rad].
    Yaw(f64),
    /// How it leans; in place of taught points and of a drift.
    Tilt(Tilt),
    /// Taught points in the base frame, and how far from their plane they may be [m]; in place of a tilt and of a drift.
    Taught {
        /// The points [m].
        points: Vec<Vector3<f64>>,
        /// The threshold [m].
        threshold: f64,
    },
    /// Where the wafers of the first and the last slot rest [m]; in place of position, tilt and taught points.
    Drift {
        /// Of the first slot [m].
        first: Vector3<f64>,
        /// Of the last slot [m].
        last: Vector3<f64>,
    },
    /// From slot to slot [m].
    Pitch(f64),
    /// Added in the station frame [m].
    Offset(Vector3<f64>),
    /// Heights of handing over, and their speed.
    Stroke(Stroke),
    /// Reach at which the arm counts as retracted [m].
    Retract(f64),
    /// Places passed on the way, in the station frame [m].
    Via(Vec<Vector3<f64>>),
    /// How it is entered.
    Approach(Approach),
    /// How long it works on a wafer [s].
    ProcessTime(f64),
}

/// The text of a cell file in which one station has other values; all else stays, comments included.
///
/// What the values come to is not looked at: read the text for that.
///
/// # Errors
/// The text is no TOML, has no station of this name, or its stations are not tables `[[station]]`.
pub fn set_station(text: &str, name: &str, changes: &[Change]) -> Result<String, Problem> {
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        let message = error.message().replace('\n', " ");
        let span = error.span().unwrap_or(0..0);
        Error::at(text, span, Fault::Form(Form::Malformed { message }))
    })?;
    let table = station(&mut document, name).map_err(|fault| Error::at(text, 0..0, fault))?;
    for change in changes {
        apply(table, change);
    }
    Ok(document.to_string())
}

fn station<'d>(document: &'d mut DocumentMut, name: &str) -> Result<&'d mut Table, Fault> {
    let Some(stations) = document.get_mut("station").and_then(Item::as_array_of_tables_mut) else {
        let whose = "a cell whose stations can be changed".to_owned();
        return Err(Fault::Missing { whose, key: "[[station]]".to_owned() });
    };
    let name_of = |table: &Table| table.get("name").and_then(Item::as_str).map(str::to_owned);
    let names: Vec<String> = stations.iter().filter_map(name_of).collect();
    let mut tables = stations.iter_mut();
    tables.find(|table| name_of(table).as_deref() == Some(name)).ok_or_else(|| Fault::Unknown {
        what: "station".to_owned(),
        found: name.to_owned(),
        nearest: nearest(name, names.iter().map(String::as_str)),
        known: names,
    })
}

fn apply(table: &mut Table, change: &Change) {
    match change {
        Change::Position(position) => {
            drop_keys(table, &["drift"]);
            set(table, "position_mm", point(position));
        }
        Change::Yaw(yaw) => set(table, "yaw_deg", number(deg(*yaw))),
        Change::Tilt(tilt) => {
            undrift(table);
            drop_keys(table, &["taught"]);
            let values = [("yaw_deg", deg(tilt.yaw)), ("pitch_deg", deg(tilt.pitch))];
            set(table, "tilt", inline(values.map(|(key, value)| (key, number(value)))));
        }
        Change::Taught { points, threshold } => {
            undrift(table);
            drop_keys(table, &["tilt"]);
            let points: Array = points.iter().map(point).collect();
            let threshold = number(shift(*threshold, 6));
            let values = [("points_mm", Value::Array(points)), ("threshold_um", threshold)];
            set(table, "taught", inline(values));
        }
        Change::Drift { first, last } => {
            drop_keys(table, &["position_mm", "tilt", "taught"]);
            let values = [("first_mm", point(first)), ("last_mm", point(last))];
            set(table, "drift", inline(values));
        }
        Change::Pitch(pitch) => set(table, "pitch_mm", number(mm(*pitch))),
        Change::Offset(offset) => set(table, "offset_mm", point(offset)),
        Change::Stroke(stroke) => {
            let values = [
                ("below_mm", stroke.below),
                ("above_mm", stroke.above),
                ("speed_mm_s", stroke.speed),
            ];
            set(table, "stroke", inline(values.map(|(key, value)| (key, number(mm(value))))));
        }
        Change::Retract(reach) => set(table, "retract_mm", number(mm(*reach))),
        Change::Via(via) => set(table, "via_mm", Value::Array(via.iter().map(point).collect())),
        Change::Approach(approach) => {
            let word = match approach {
                Approach::Radial => "radial",
                Approach::Line => "line",
            };
            set(table, "approach", Value::from(word));
        }
        Change::ProcessTime(time) => set(table, "process_s", number(*time)),
    }
}

/// A station placed by its drift is placed by the first of its two places instead.
fn undrift(table: &mut Table) {
    let first = table.get("drift").and_then(|drift| drift.get("first_mm")).cloned();
    if let Some(Item::Value(first)) = first {
        drop_keys(table, &["drift"]);
        set(table, "position_mm", first);
    }
}

fn drop_keys(table: &mut Table, keys: &[&str]) {
    for key in keys {
        table.remove(key);
    }
}

/// Puts a value where the old one stood, with the comment behind it.
fn set(table: &mut Table, key: &str, mut value: Value) {
    match table.get_mut(key) {
        Some(Item::Value(old)) => {
            // Within a table or a list, what stays the same keeps how it was written.
            *value.decor_mut() = old.decor().clone();
            *old = value;
        }
        _ => {
            table.insert(key, Item::Value(value));
        }
    }
}

fn number(value: f64) -> Value {
    Value::from(value)
}

fn point(point: &Vector3<f64>) -> Value {
    Value::Array(point.iter().map(|value| mm(*value)).collect())
}

fn inline<const N: usize>(values: [(&str, Value); N]) -> Value {
    let mut table = InlineTable::new();
    for (key, value) in values {
        table.insert(key, value);
    }
    Value::InlineTable(table)
}
