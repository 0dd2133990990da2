//! Arms: joints, effectors and droop.

use jointplay_cell::robot::{Arm, ArmJoint, AxisKind, Effector, RODS};
use jointplay_cell::wafer::{Droop, DroopRow, Support};

use super::super::tree::{AllowedRange, Entry, Reader, Table};
use super::words::MOTIONS;
use crate::file_problem::FileProblem;
use crate::units::m_from_mm;

/// Largest coefficient of friction: rubber on dry glass has less than 4; a larger value has another unit.
const MOST_FRICTION: f64 = 10.0;

pub(super) fn read_arm(table: &Table, axes: &[String]) -> Option<Arm> {
    let reader = table.reader;
    let name = table.name("name");
    let mount = table.point("mount_mm");
    let droop = table.table("droop", "`[arm.droop]`");
    let droop = droop.map_or(Some(Droop::Rigid), |droop| read_droop(&droop));
    let joints = table.tables("joint");
    let last = joints.len().saturating_sub(1);
    let read = |(k, joint): (usize, &Table)| read_joint(joint, axes, k == last);
    let joints: Vec<Option<ArmJoint>> = joints.iter().enumerate().map(read).collect();
    let effectors: Vec<Option<Effector>> =
        table.tables("effector").iter().map(|table| read_effector(reader, table)).collect();
    for key in ["joint", "effector"] {
        let _ = table.needed(key);
    }
    table.finish();
    Some(Arm {
        name: name?,
        mount: mount?.into(),
        joints: joints.into_iter().collect::<Option<_>>()?,
        effectors: effectors.into_iter().collect::<Option<_>>()?,
        droop: droop?,
    })
}

fn read_joint(table: &Table, axes: &[String], is_last: bool) -> Option<ArmJoint> {
    let reader = table.reader;
    let kind = table.needed("kind").and_then(|kind| kind.word(reader, "kind of joint", &MOTIONS));
    let zero = match kind {
        Some(AxisKind::Rotary) => table.number_or("zero_deg", AllowedRange::Any, 0.0).to_radians(),
        Some(AxisKind::Linear) => table.length_or("zero_mm", AllowedRange::Any, 0.0),
        None => {
            let _ = (table.entry("zero_deg"), table.entry("zero_mm"));
            0.0
        }
    };
    let drives = table.needed("drives").and_then(|entry| read_drives(reader, entry, axes));
    let length = if is_last {
        Some(table.length_or("length_mm", AllowedRange::NotNegative, 0.0))
    } else {
        table.length("length_mm", AllowedRange::NotNegative)
    };
    let offset = table.length_or("offset_mm", AllowedRange::Any, 0.0);
    let rise = table.length_or("rise_mm", AllowedRange::Any, 0.0);
    table.finish();
    Some(ArmJoint { kind: kind?, zero, drives: drives?, length: length?, offset, rise })
}

/// Axes by name, each with its ratio, in the order of the axes.
fn read_drives(reader: &Reader, entry: Entry, axes: &[String]) -> Option<Vec<(usize, f64)>> {
    let Some(table) = entry.value.get_ref().as_table() else {
        entry.type_error(reader, "a table of axes and their ratios, such as { T = 1, R = -2 }");
        return None;
    };
    let mut drives = Vec::new();
    let mut is_right = true;
    for (name, value) in table {
        let ratio = Entry { key: "drives", value }.number(reader, AllowedRange::Any);
        let motors = &axes[RODS..];
        match (motors.iter().position(|axis| axis == name.get_ref()), ratio) {
            (Some(axis), Some(ratio)) => drives.push((RODS + axis, ratio)),
            (None, _) => {
                // An axis with errors was reported already.
                if !motors.contains(&String::new()) {
                    let known = motors.iter().map(String::as_str);
                    let fault = FileProblem::unknown("axis", name.get_ref(), known);
                    reader.report(name.span(), fault);
                }
                is_right = false;
            }
            (Some(_), None) => is_right = false,
        }
    }
    drives.sort_by_key(|&(axis, _)| axis);
    is_right.then_some(drives)
}

fn read_effector(reader: &Reader, table: &Table) -> Option<Effector> {
    let name = table.name("name");
    let center = table.point("wafer_center_mm");
    let heading = table.number_or("heading_deg", AllowedRange::Any, 0.0).to_radians();
    let support = table.needed("support").and_then(|entry| entry.table(reader, "`support`"));
    let support = support.and_then(|support| read_support(&support));
    let friction = table.number("friction", AllowedRange::Within(0.0, MOST_FRICTION));
    table.finish();
    Some(Effector {
        name: name?,
        wafer_center: center?.into(),
        heading,
        support: support?,
        friction: friction?,
    })
}

fn read_support(table: &Table) -> Option<Support> {
    #[derive(Clone, Copy)]
    enum Kind {
        Edge,
        ThreePoints,
        TwoRails,
    }
    let kinds =
        [("edge", Kind::Edge), ("three-points", Kind::ThreePoints), ("two-rails", Kind::TwoRails)];
    let kind = table.needed("kind")?.word(table.reader, "kind of support", &kinds)?;
    let support = match kind {
        Kind::Edge => Some(Support::Edge),
        Kind::ThreePoints => table
            .length("radius_mm", AllowedRange::Positive)
            .map(|radius| Support::ThreePoints { radius }),
        Kind::TwoRails => table
            .length("distance_mm", AllowedRange::Positive)
            .map(|distance| Support::TwoRails { distance }),
    };
    table.finish();
    support
}

fn read_droop(table: &Table) -> Option<Droop> {
    #[derive(Clone, Copy)]
    enum Kind {
        Rigid,
        Table,
        Cantilever,
    }
    let kinds = [("rigid", Kind::Rigid), ("table", Kind::Table), ("cantilever", Kind::Cantilever)];
    let kind = table.needed("kind")?.word(table.reader, "kind of droop", &kinds)?;
    let droop = match kind {
        Kind::Rigid => Some(Droop::Rigid),
        Kind::Table => {
            let rows: Vec<Option<DroopRow>> = table.tables("row").iter().map(droop_row).collect();
            let _ = table.needed("row");
            rows.into_iter().collect::<Option<_>>().map(|rows| Droop::Table { rows })
        }
        Kind::Cantilever => {
            let stiffness = table.number("stiffness_n_m2", AllowedRange::Positive);
            let mass = table.number("mass_kg_m", AllowedRange::NotNegative);
            let both = stiffness.zip(mass);
            both.map(|(stiffness, mass_per_length)| Droop::Cantilever {
                stiffness,
                mass_per_length,
            })
        }
    };
    table.finish();
    droop
}

fn droop_row(table: &Table) -> Option<DroopRow> {
    let reach = table.length("reach_mm", AllowedRange::NotNegative);
    let empty_drop = table.length("empty_drop_mm", AllowedRange::Any);
    let empty_slope = table.number("empty_slope_mrad", AllowedRange::Any);
    let loaded_drop = table.length("loaded_drop_mm", AllowedRange::Any);
    let loaded_slope = table.number("loaded_slope_mrad", AllowedRange::Any);
    let load = table.number("load_g", AllowedRange::Positive);
    table.finish();
    Some(DroopRow {
        reach: reach?,
        empty_drop: empty_drop?,
        empty_slope: m_from_mm(empty_slope?),
        loaded_drop: loaded_drop?,
        loaded_slope: m_from_mm(loaded_slope?),
        load: m_from_mm(load?),
    })
}
