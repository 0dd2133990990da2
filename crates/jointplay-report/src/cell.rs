//! Report on a program in a cell.

use std::ops::Range;

use jointplay_cell::check::{CheckResult, Report, Unmodelled, Utilization, Violation, unmodelled};
use jointplay_cell::program::{HandoffDeflection, SourceLocation, handoff_deflections};
use jointplay_cell::robot::AxisKind;
use jointplay_cell::schedule::schedule;
use jointplay_cell::trajectory::{Blend, LineDeviation, Trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_core::virtualization::BuiltIn;
use jointplay_format::display_units::DisplayUnits;
use serde::Serialize;

use crate::distance::{DistanceReport, distance};
use crate::entity::EntityReport;
use crate::nearest::{NearestReport, nearest};
use crate::schedule::{ScheduleReport, schedule_report};
use crate::segment::{SegmentReport, segments};
use crate::violation::{explain_violation, in_display_unit};
use crate::violation_group::{
    BodyInZoneReport, RemedyReport, ViolationGroupReport, body_in_zone_reports, violation_groups,
};
use jointplay_format::cell::robot::virtualization_name;
use jointplay_format::place;
use jointplay_format::program::phase_name;
use jointplay_format::units::{mm, um};

/// Result of `cell check` and `cell run`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct CellReport {
    /// Name of the cell.
    pub cell: String,
    /// Name of the cell's robot.
    pub robot: String,
    /// Virtualization that determines the platform's position over the rods.
    pub virtualization: &'static str,
    /// Solver of the virtual joints.
    pub solver: String,
    /// Characteristic length by which angles of the virtualization are multiplied; none without angles.
    pub metric_mm: Option<f64>,
    /// Values of cell and robot that are assumptions, with their reasons.
    pub assumed: Vec<String>,
    /// `passed`, `failed`, or `no_motion` where no axis moves.
    pub result: &'static str,
    /// Duration of the motion.
    pub duration_s: f64,
    /// Number of different wafers that are put into a slot.
    pub wafers: usize,
    /// Wafers per hour of the repeated program.
    pub wafers_per_hour: Option<f64>,
    /// Use of robot and stations, bottleneck, periodic parts, and stays of wafers.
    pub schedule: ScheduleReport,
    /// Number of motions; a wait of zero length is not counted.
    pub steps: usize,
    /// Cartesian lines, if there are any.
    pub straight: Option<StraightReport>,
    /// Blended motions, if there are any.
    pub blended: Option<BlendedReport>,
    /// Deflection of carried wafers at hand-offs, if there are any.
    pub compensated: Option<CompensatedReport>,
    /// Number of checked samples.
    pub samples: usize,
    /// Axes, rods first.
    pub axes: Vec<AxisReport>,
    /// One row for each instruction, in order of execution.
    pub instructions: Vec<InstructionReport>,
    /// All violations, by time.
    pub violations: Vec<ViolationReport>,
    /// The violations by cause, the most severe first.
    pub violation_groups: Vec<ViolationGroupReport>,
    /// Translations of fixed bodies and zones that remove violations, of the most severe ones; none where they were not computed.
    pub remedies: Option<Vec<RemedyReport>>,
    /// Parts of the cell that have no bodies, and are not checked for collisions: arms, and the surroundings of the robot.
    pub not_checked: Vec<String>,
    /// Fixed bodies in keep-out zones.
    pub bodies_in_zones: Vec<BodyInZoneReport>,
    /// Minimum distances of pairs, smallest first.
    pub distances: Vec<DistanceReport>,
    /// The smallest of these distances, with all wafers counted as one.
    pub nearest: Vec<NearestReport>,
}

/// Cartesian lines.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct StraightReport {
    /// Number of lines.
    pub motions: usize,
    /// Largest distance of a wafer's centre from its line.
    pub off_um: f64,
    /// Largest angle of the wafer's plane from the evenly interpolated one.
    pub off_mrad: f64,
}

/// Blended motions.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct BlendedReport {
    /// Number of blends.
    pub motions: usize,
    /// Total time during which two motions overlap.
    pub overlap_s: f64,
    /// Upper bound of the distance of a wafer's centre from the unblended path.
    pub off_mm: f64,
}

/// Deflection of carried wafers at hand-offs: the compensated droop and sag, and the remaining deviation.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct CompensatedReport {
    /// Number of hand-offs.
    pub handoffs: usize,
    /// Largest drop of a loaded arm, which is compensated.
    pub droop_um: f64,
    /// Largest slope of a loaded arm, which is compensated.
    pub slope_mrad: f64,
    /// Largest distance of a wafer's mean plane from its supports by its own sag, which is compensated.
    pub sag_um: f64,
    /// Largest remaining distance of the mean plane's centre from its target in the slot.
    pub residual_um: f64,
    /// Largest remaining angle of the mean plane from the plane of the slot.
    pub residual_mrad: f64,
    /// Largest root mean square distance of a wafer from its mean plane, which no platform pose removes.
    pub residual_sag_um: f64,
    /// Largest displacement of an effector when its load changes; poses jump by it at the hand-off.
    pub jump_um: f64,
    /// Largest uncertainty of the tilt of these stations, times the coverage factor; none where it is not known.
    pub taught_mrad: Option<f64>,
    /// Largest uncertainty of the height of these slots, times the coverage factor.
    pub taught_um: Option<f64>,
    /// Largest uncertainty of the position of these slots in their plane, times the coverage factor.
    pub taught_sideways_um: Option<f64>,
    /// Coverage factor of the cell; it is larger where the noise of points is estimated.
    pub coverage_factor: f64,
    /// Stations whose tilt has no known uncertainty; it counts as exact.
    pub taught_unknown: Vec<String>,
}

/// An axis in a motion.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct AxisReport {
    /// Name of the axis.
    pub name: String,
    /// `mm` or `deg`.
    pub unit: &'static str,
    /// Time during which the axis moves.
    pub moving_s: f64,
}

/// Utilization of a limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ShareReport {
    /// Name of the axis or effector.
    pub name: String,
    /// Share of the limit; above 1 the limit is violated.
    pub share: f64,
    /// Time of the largest share.
    pub time_s: f64,
}

/// An executed instruction.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct InstructionReport {
    /// Number of the instruction in order of execution, from 1.
    pub number: usize,
    /// Line of the program.
    pub line: usize,
    /// Text of the instruction.
    pub text: String,
    /// Start time.
    pub start_s: f64,
    /// Duration.
    pub duration_s: f64,
    /// Number of motions; a wait of zero length is not counted.
    pub steps: usize,
    /// Segments that move, in order.
    pub segments: Vec<SegmentReport>,
    /// Cartesian lines of the instruction, if there are any.
    pub straight: Option<StraightReport>,
    /// Blended motions of the instruction, if there are any.
    pub blended: Option<BlendedReport>,
    /// Deflection of carried wafers at hand-offs of the instruction, if there are any.
    pub compensated: Option<CompensatedReport>,
    /// Time during which each axis moves, in the order of `axes`.
    pub moving_s: Vec<f64>,
    /// Axis with the largest share of its velocity limit.
    pub speed: Option<ShareReport>,
    /// Axis with the largest share of its acceleration limit.
    pub acceleration: Option<ShareReport>,
    /// Axis with the largest share of its jerk limit.
    pub jerk: Option<ShareReport>,
    /// Share of the tilt limit.
    pub tilt: f64,
    /// Share of the play budget.
    pub play: f64,
    /// Effector whose wafer has the largest share of its friction limit.
    pub slip: Option<ShareReport>,
    /// The pair with the minimum distance.
    pub nearest: Option<DistanceReport>,
    /// Number of violations that begin in the instruction.
    pub violations: usize,
}

/// A violation over an interval of time.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ViolationReport {
    /// Kind of the violation, such as `speed limit` or `collision`.
    pub kind: String,
    /// The axis, effector, bodies, wafers or zone concerned.
    pub entities: Vec<EntityReport>,
    /// Number of the instruction, from 1.
    pub instruction: usize,
    /// Line of the instruction.
    pub line: usize,
    /// Column of the instruction.
    pub column: usize,
    /// Phase of the instruction at the worst time, such as `turn` or `extend`.
    pub phase: &'static str,
    /// Start of the violation.
    pub start_s: f64,
    /// End of the violation.
    pub end_s: f64,
    /// Time of the worst value.
    pub worst_s: f64,
    /// The worst value, in `unit`.
    pub worst: Option<f64>,
    /// The limit, in `unit`; of a collision the required clearance.
    pub limit: Option<f64>,
    /// Unit of `worst` and `limit`; empty if they have no value.
    pub unit: &'static str,
    /// Message with values and units.
    pub message: String,
}

/// Reports the result of a check.
///
/// # Arguments
/// * `program` – text of the program, from which lines are quoted
/// * `units` – of the violations and their messages
#[must_use]
pub fn cell(
    cell: &Cell,
    program: &str,
    motion: &Trajectory,
    report: &Report,
    units: DisplayUnits,
) -> CellReport {
    let robot = &cell.robot;
    let lines: Vec<&str> = program.lines().map(str::trim).collect();
    let effectors: Vec<String> = robot
        .effectors()
        .map(|id| robot.arms[id.arm].effectors[id.effector].name.clone())
        .collect();
    let axes: Vec<String> = robot.axes.iter().map(|axis| axis.name.clone()).collect();
    let share = |share: &Option<Utilization>, names: &[String]| {
        share.map(|one| ShareReport {
            name: names.get(one.index).cloned().unwrap_or_default(),
            share: one.ratio,
            time_s: one.time,
        })
    };
    let carried = handoff_deflections(cell, &motion.steps);
    let constraints = motion.limiting_constraints(cell);
    let instructions = report.by_instruction.iter().map(|row| InstructionReport {
        number: row.instruction + 1,
        line: row.place.line,
        text: lines.get(row.place.line.wrapping_sub(1)).copied().unwrap_or_default().to_owned(),
        start_s: row.start,
        duration_s: row.duration,
        steps: lasting(motion, row.steps.clone()),
        segments: segments(cell, motion, &constraints, row.steps.clone()),
        straight: straight(motion, row.steps.clone()),
        blended: blended(motion, row.steps.clone()),
        compensated: compensated(cell, &carried, row.steps.clone()),
        moving_s: row.moving_time.clone(),
        speed: share(&row.velocity, &axes),
        acceleration: share(&row.acceleration, &axes),
        jerk: share(&row.jerk, &axes),
        tilt: row.tilt,
        play: row.play,
        slip: share(&row.slip, &effectors),
        nearest: row.nearest.as_ref().map(|pair| distance(cell, pair)),
        violations: row.violations,
    });
    let moving = robot.axes.iter().zip(&report.moving_time).map(|(axis, &moving_s)| AxisReport {
        name: axis.name.clone(),
        unit: if axis.kind == AxisKind::Rotary { "deg" } else { "mm" },
        moving_s,
    });
    let model = &robot.model;
    let metric = match model.virtualization {
        BuiltIn::Polar | BuiltIn::Offset => {
            model.options.metric.characteristic_length(robot.gpr.platform()).ok().map(mm)
        }
        BuiltIn::Radial | BuiltIn::Planar => None,
    };
    let distances: Vec<DistanceReport> =
        report.distances.iter().map(|pair| distance(cell, pair)).collect();
    CellReport {
        cell: cell.name.clone(),
        robot: robot.name.clone(),
        virtualization: virtualization_name(model.virtualization),
        solver: model.options.solver.to_string(),
        metric_mm: metric,
        assumed: robot.assumed.iter().chain(&cell.assumed).cloned().collect(),
        result: match report.result {
            CheckResult::Passed => "passed",
            CheckResult::Failed => "failed",
            CheckResult::NoMotion => "no_motion",
        },
        duration_s: report.duration,
        wafers: report.wafers,
        wafers_per_hour: report.wafers_per_hour,
        schedule: schedule_report(cell, motion, &schedule(cell, motion)),
        steps: lasting(motion, 0..motion.steps.len()),
        straight: straight(motion, 0..motion.steps.len()),
        blended: blended(motion, 0..motion.steps.len()),
        compensated: compensated(cell, &carried, 0..motion.steps.len()),
        samples: report.samples,
        axes: moving.collect(),
        instructions: instructions.collect(),
        violations: report.violations.iter().map(|one| violation(cell, one, units)).collect(),
        violation_groups: violation_groups(cell, &motion.steps, &report.violations, units),
        remedies: None,
        not_checked: unmodelled(cell).into_iter().map(|part| unmodelled_name(cell, part)).collect(),
        bodies_in_zones: body_in_zone_reports(cell),
        nearest: nearest(cell, &report.distances),
        distances,
    }
}

/// Name of a part of a cell without bodies.
fn unmodelled_name(cell: &Cell, part: Unmodelled) -> String {
    match part {
        Unmodelled::Arm(arm) => format!("arm “{}”", cell.robot.arms[arm].name),
        Unmodelled::Surroundings => "surroundings of the robot".to_owned(),
    }
}

fn lasting(motion: &Trajectory, steps: Range<usize>) -> usize {
    steps.filter(|&step| motion.has_duration(step)).count()
}

fn straight(motion: &Trajectory, steps: Range<usize>) -> Option<StraightReport> {
    let lines: Vec<LineDeviation> = steps.filter_map(|step| motion.line_deviation(step)).collect();
    (!lines.is_empty()).then(|| StraightReport {
        motions: lines.len(),
        off_um: um(most(&lines, |line| line.distance)),
        off_mrad: mm(most(&lines, |line| line.angle)),
    })
}

fn blended(motion: &Trajectory, steps: Range<usize>) -> Option<BlendedReport> {
    let blends: Vec<Blend> = steps.filter_map(|step| motion.blend(step)).collect();
    (!blends.is_empty()).then(|| BlendedReport {
        motions: blends.len(),
        overlap_s: blends.iter().map(|blend| blend.overlap).sum(),
        off_mm: mm(most(&blends, |blend| blend.deviation)),
    })
}

fn compensated(
    cell: &Cell,
    carried: &[HandoffDeflection],
    steps: Range<usize>,
) -> Option<CompensatedReport> {
    // Hand-offs are sorted by step.
    let at = |step| carried.partition_point(|one| one.step < step);
    let carried = &carried[at(steps.start)..at(steps.end)];
    let (mut tilt, mut sideways, mut height) = (None::<f64>, None::<f64>, None::<f64>);
    let mut unknown = std::collections::BTreeSet::new();
    for one in carried {
        let station = &cell.stations[one.slot.station];
        let known = &station.uncertainty;
        let factor = known.coverage(cell.coverage_factor);
        let largest = |so_far: &mut Option<f64>, deviation: f64| {
            *so_far = Some(so_far.unwrap_or(0.0).max(factor * deviation));
        };
        match known.tilt_deviation() {
            Some(deviation) => largest(&mut tilt, deviation),
            None => {
                unknown.insert(station.name.clone());
            }
        }
        let [across, up] = known.lateral_and_height(&station.slot_position(one.slot.slot));
        if known.known[0] && known.known[1] {
            largest(&mut sideways, across);
        }
        if known.known[2] {
            largest(&mut height, up);
        }
    }
    (!carried.is_empty()).then(|| CompensatedReport {
        handoffs: carried.len(),
        droop_um: um(most(carried, |one| one.deflection.drop)),
        slope_mrad: mm(most(carried, |one| one.deflection.slope)),
        sag_um: um(most(carried, |one| one.sag.abs())),
        residual_um: um(most(carried, |one| one.position_residual)),
        residual_mrad: mm(most(carried, |one| one.tilt_residual)),
        residual_sag_um: um(most(carried, |one| one.rms_flatness)),
        jump_um: um(most(carried, |one| one.load_displacement)),
        taught_mrad: tilt.map(mm),
        taught_um: height.map(um),
        taught_sideways_um: sideways.map(um),
        coverage_factor: cell.coverage_factor,
        taught_unknown: unknown.into_iter().collect(),
    })
}

/// The element with the largest value; `all` must not be empty.
fn most<T>(all: &[T], of: impl Fn(&T) -> f64) -> f64 {
    all.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
}

/// A message at a place of a program, with its line and carets under the command.
///
/// # Arguments
/// * `file` – name of the program
#[must_use]
pub fn excerpt(program: &str, at: SourceLocation, message: &str, file: &str) -> String {
    let text = program.lines().nth(at.line.wrapping_sub(1)).unwrap_or_default();
    let command = text.split('#').next().unwrap_or_default().trim_end();
    let width = command.chars().count().saturating_sub(at.column.saturating_sub(1));
    let (column, text) = (at.column.max(1), text.to_owned());
    let place = place::Place { line: at.line, column, width, text };
    place::Error { place, problem: Box::new(message) }.with_excerpt(file)
}

fn violation(cell: &Cell, one: &Violation, units: DisplayUnits) -> ViolationReport {
    let (unit, worst) = in_display_unit(one, one.worst, units);
    let counts = !unit.is_empty() && one.worst.is_finite();
    ViolationReport {
        kind: one.kind.to_string(),
        entities: one.entities.iter().map(|&one| EntityReport::new(cell, one)).collect(),
        instruction: one.instruction + 1,
        line: one.place.line,
        column: one.place.column,
        phase: phase_name(one.phase),
        start_s: one.start,
        end_s: one.end,
        worst_s: one.worst_time,
        worst: counts.then_some(worst),
        limit: counts.then(|| in_display_unit(one, one.limit, units).1),
        unit,
        message: explain_violation(cell, one, units),
    }
}
