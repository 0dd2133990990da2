//! Axes: rods, and the motors of the arms.

use jointplay_cell::robot::{Axis, AxisKind, KinematicLimits, RODS};
use jointplay_core::gpr::Gpr;

use super::super::problem::Fault;
use super::super::tree::{AllowedRange, Table};
use super::words::{MOTIONS, ROD_NAMES};
use crate::units::m_from_mm;

pub(super) fn rod_axes(table: &Table, gpr: &Gpr) -> Option<[Axis; RODS]> {
    let (min, max) = (gpr.limits().rod_min, gpr.limits().rod_max);
    let home = table.length_or("home_mm", AllowedRange::Any, gpr.working_height());
    let empty = dynamics(table, "empty", AxisKind::Linear);
    let loaded = dynamics(table, "loaded", AxisKind::Linear);
    table.finish();
    let (empty, loaded) = (empty?, loaded?);
    let kind = AxisKind::Linear;
    Some(ROD_NAMES.map(|name| Axis { name: name.to_owned(), kind, min, max, home, empty, loaded }))
}

pub(super) fn motor(table: &Table) -> Option<Axis> {
    let reader = table.reader;
    let name = table.name("name");
    let kind = table.needed("kind").and_then(|kind| kind.word(reader, "kind of axis", &MOTIONS));
    let Some(kind) = kind else {
        // The valid keys depend on the kind.
        for key in ["range_deg", "range_mm", "home_deg", "home_mm", "empty", "loaded"] {
            let _ = table.entry(key);
        }
        table.finish();
        return None;
    };
    let (range, home) = match kind {
        AxisKind::Rotary => ("range_deg", "home_deg"),
        AxisKind::Linear => ("range_mm", "home_mm"),
    };
    let range =
        table.needed(range).and_then(|range| range.numbers::<2, _>(reader, AllowedRange::Any));
    let home = table.number(home, AllowedRange::Any);
    let empty = dynamics(table, "empty", kind);
    let loaded = dynamics(table, "loaded", kind);
    table.finish();
    let [min, max] = range?.map(|value| to_si(kind, value));
    let home = to_si(kind, home?);
    Some(Axis { name: name?, kind, min, max, home, empty: empty?, loaded: loaded? })
}

/// Reports axes with equal names, between which `drives` cannot distinguish.
pub(super) fn report_duplicate_names(table: &Table, axes: &[Table]) {
    let reader = table.reader;
    let rods = table.entry("rods").map_or(0, |rods| reader.line(rods.span()));
    let mut known: Vec<(&str, usize)> = ROD_NAMES.map(|name| (name, rods)).into();
    for axis in axes {
        let Some(entry) = axis.entry("name") else { continue };
        let Some(name) = entry.value.get_ref().as_str() else { continue };
        match known.iter().find(|(other, _)| *other == name) {
            Some(&(_, first)) => {
                let (what, found) = ("axis".to_owned(), name.to_owned());
                entry.report(reader, Fault::Twice { what, found, first });
            }
            None => known.push((name, reader.line(entry.span()))),
        }
    }
}

fn to_si(kind: AxisKind, value: f64) -> f64 {
    match kind {
        AxisKind::Rotary => value.to_radians(),
        AxisKind::Linear => m_from_mm(value),
    }
}

fn dynamics(table: &Table, key: &'static str, kind: AxisKind) -> Option<KinematicLimits> {
    let whose = format!("`{key}` of {}", table.whose);
    let limits = table.needed(key)?.table(table.reader, whose)?;
    let keys = match kind {
        AxisKind::Rotary => ["velocity_deg_s", "acceleration_deg_s2", "jerk_deg_s3"],
        AxisKind::Linear => ["velocity_mm_s", "acceleration_mm_s2", "jerk_mm_s3"],
    };
    let values = keys.map(|key| limits.number(key, AllowedRange::Positive));
    limits.finish();
    let [velocity, acceleration, jerk] = values;
    let si = |value| to_si(kind, value);
    Some(KinematicLimits {
        velocity: si(velocity?),
        acceleration: si(acceleration?),
        jerk: si(jerk?),
    })
}
