//! Violations grouped by cause, bodies in zones, and remedies.

use jointplay_cell::check::{
    BodyInZone, Remedy, Violation, ViolationGroup, ViolationOccurrence, bodies_in_zones,
    group_violations,
};
use jointplay_cell::program::Step;
use jointplay_cell::workcell::Cell;
use jointplay_format::display_units::DisplayUnits;
use jointplay_format::number::counted;
use jointplay_format::program::phase_name;
use jointplay_format::units::mm;
use serde::Serialize;

use crate::entity::EntityReport;
use crate::violation::{explain_violation, in_display_unit};

/// Violations with one cause: of one limit by the same entities, with all wafers counted as one.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ViolationGroupReport {
    /// ViolationKind of the worst violation.
    pub kind: String,
    /// The axis, effector, bodies, wafers or zone of the worst violation.
    pub entities: Vec<EntityReport>,
    /// Number of violations.
    pub count: usize,
    /// Number of different wafers concerned.
    pub wafers: usize,
    /// Line of the worst violation.
    pub line: usize,
    /// Column of the worst violation.
    pub column: usize,
    /// Phase of the instruction at the worst time, such as `turn` or `extend`.
    pub phase: &'static str,
    /// Start of the first violation.
    pub first_s: f64,
    /// Time of the worst value.
    pub worst_s: f64,
    /// The worst value, in `unit`; negative for a penetration depth.
    pub worst: Option<f64>,
    /// The limit, in `unit`; of bodies the required clearance.
    pub limit: Option<f64>,
    /// Amount by which the limit is exceeded, in `unit`; of bodies the depth with the required clearance.
    pub excess: Option<f64>,
    /// ViolationQuantity of these values; empty if they have no value.
    pub unit: &'static str,
    /// Message of the worst violation with values and units.
    pub message: String,
    /// The violations by instruction, phase and station.
    pub occurrences: Vec<OccurrenceReport>,
}

/// Violations of a group in one instruction and phase, at one station.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct OccurrenceReport {
    /// Line of the instruction.
    pub line: usize,
    /// Column of the instruction.
    pub column: usize,
    /// Name of the station that the robot moves to or from, if any.
    pub station: Option<String>,
    /// Phase of the instruction, such as `turn` or `extend`.
    pub phase: &'static str,
    /// Number of violations.
    pub count: usize,
    /// Start of the first violation.
    pub first_s: f64,
    /// Time of the worst value.
    pub worst_s: f64,
    /// The worst value, in the unit of the group.
    pub worst: Option<f64>,
    /// Amount by which the limit is exceeded, in the unit of the group.
    pub excess: Option<f64>,
}

/// Translation of a fixed body or a keep-out zone that removes all its violations, verified by a check of the whole program.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct RemedyReport {
    /// Name of the body or zone.
    pub name: String,
    /// Translation in the base frame.
    pub translation_mm: [f64; 3],
    /// Number of violations that it removes.
    pub violations: usize,
    /// The remedy in words.
    pub message: String,
}

/// Fixed body in a keep-out zone; no violation, because zones restrict the robot and its wafers.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct BodyInZoneReport {
    /// Name of the body.
    pub body: String,
    /// Name of the zone.
    pub zone: String,
    /// Penetration depth.
    pub depth_mm: f64,
}

/// The groups of violations, the most severe first.
///
/// # Arguments
/// * `steps` – of the trajectory
/// * `violations` – in the order of time
#[must_use]
pub fn violation_groups(
    cell: &Cell,
    steps: &[Step],
    violations: &[Violation],
    units: DisplayUnits,
) -> Vec<ViolationGroupReport> {
    let groups = group_violations(steps, violations);
    groups.iter().map(|group| group_report(cell, violations, group, units)).collect()
}

fn group_report(
    cell: &Cell,
    violations: &[Violation],
    group: &ViolationGroup,
    units: DisplayUnits,
) -> ViolationGroupReport {
    let worst = &violations[group.worst];
    let displayed = |violation: &Violation, value: f64| displayed(violation, value, units);
    let occurrence = |one: &ViolationOccurrence| {
        let worst = &violations[one.worst];
        OccurrenceReport {
            line: one.place.line,
            column: one.place.column,
            station: one.station.map(|station| cell.stations[station].name.clone()),
            phase: phase_name(one.phase),
            count: one.count,
            first_s: violations[one.first].start,
            worst_s: worst.worst_time,
            worst: displayed(worst, worst.worst),
            excess: displayed(worst, worst.excess()),
        }
    };
    ViolationGroupReport {
        kind: worst.kind.to_string(),
        entities: worst.entities.iter().map(|&one| EntityReport::new(cell, one)).collect(),
        count: group.violations.len(),
        wafers: group.wafers.len(),
        line: worst.place.line,
        column: worst.place.column,
        phase: phase_name(worst.phase),
        first_s: violations[group.first()].start,
        worst_s: worst.worst_time,
        worst: displayed(worst, worst.worst),
        limit: displayed(worst, worst.limit),
        excess: displayed(worst, worst.excess()),
        unit: in_display_unit(worst, worst.worst, units).0,
        message: explain_violation(cell, worst, units),
        occurrences: group.occurrences.iter().map(occurrence).collect(),
    }
}

/// A value of a violation in its display unit; none without a value.
fn displayed(violation: &Violation, value: f64, units: DisplayUnits) -> Option<f64> {
    let (unit, shown) = in_display_unit(violation, value, units);
    (!unit.is_empty() && value.is_finite() && violation.worst.is_finite()).then_some(shown)
}

/// The remedies in numbers and words.
#[must_use]
pub fn remedy_reports(cell: &Cell, remedies: &[Remedy], units: DisplayUnits) -> Vec<RemedyReport> {
    let report = |remedy: &Remedy| {
        let name = cell.entity_name(remedy.entity);
        let translation_mm = remedy.translation.map(|length| (length * 1e4).round() / 10.0);
        let removed = match remedy.violations {
            1 => "its violation".to_owned(),
            count => format!("its {}", counted(count, "violation")),
        };
        let message =
            format!("{}, which removes {removed}", in_words(&name, remedy.translation, units));
        RemedyReport { name, translation_mm, violations: remedy.violations, message }
    };
    remedies.iter().map(report).collect()
}

/// A translation along an axis in words.
fn in_words(name: &str, translation: [f64; 3], units: DisplayUnits) -> String {
    let by = |length: f64| units.length(length.abs(), 1);
    let [x, y, z] = translation;
    let sign = |length: f64| if length < 0.0 { "−" } else { "+" };
    if z < 0.0 {
        format!("lower {name} by {}", by(z))
    } else if z > 0.0 {
        format!("raise {name} by {}", by(z))
    } else if x != 0.0 {
        format!("move {name} by {} along {}x", by(x), sign(x))
    } else {
        format!("move {name} by {} along {}y", by(y), sign(y))
    }
}

/// The fixed bodies in keep-out zones.
pub(crate) fn body_in_zone_reports(cell: &Cell) -> Vec<BodyInZoneReport> {
    let report = |BodyInZone { body, zone, depth }| BodyInZoneReport {
        body: cell.bodies[body].name.clone(),
        zone: cell.zones[zone].name.clone(),
        depth_mm: mm(depth),
    };
    bodies_in_zones(cell).into_iter().map(report).collect()
}
