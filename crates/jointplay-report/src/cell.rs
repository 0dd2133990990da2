//! What a program does in a cell, and what is wrong with it.

use std::ops::Range;

use jointplay_cell::check::{Report, Share, Verdict, Violation};
use jointplay_cell::program::{HandoverDeflection, Place, handover_deflections};
use jointplay_cell::robot::AxisKind;
use jointplay_cell::station::Origin;
use jointplay_cell::trajectory::{Blend, LineDeviation, Trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_core::virtualization::BuiltIn;
use serde::Serialize;

use crate::distance::{DistanceReport, distance};
use crate::nearest::{NearestReport, nearest};
use crate::violation::{explain_violation, in_display_unit};
use jointplay_format::cell::robot::virtualization_name;
use jointplay_format::place;
use jointplay_format::units::{mm, um};

/// What `cell check` and `cell run` answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct CellReport {
    /// What the cell is called.
    pub cell: String,
    /// What its robot is called.
    pub robot: String,
    /// Virtualization by which its platform sits over the rods.
    pub virtualization: &'static str,
    /// How the displacements of that are found.
    pub solver: String,
    /// What an angle of the virtualization is multiplied by before it is added to lengths; none where it has no angles.
    pub metric_mm: Option<f64>,
    /// What of cell and robot is assumed rather than known.
    pub assumed: Vec<String>,
    /// `sound` or `broken`.
    pub verdict: &'static str,
    /// How long the motion takes.
    pub duration_s: f64,
    /// Different wafers that are laid into a slot.
    pub wafers: usize,
    /// Wafers an hour where the program is repeated.
    pub wafers_per_hour: Option<f64>,
    /// How many motions the program comes to; a wait that takes no time is none.
    pub steps: usize,
    /// Motions along straight lines, where there are some.
    pub straight: Option<StraightReport>,
    /// Motions that run into the next, where there are some.
    pub blended: Option<BlendedReport>,
    /// Carried wafers where they change hands, where some do.
    pub compensated: Option<CompensatedReport>,
    /// Samples that were looked at.
    pub samples: usize,
    /// Axes, rods first.
    pub axes: Vec<AxisReport>,
    /// A row for each instruction, in the order of running.
    pub instructions: Vec<InstructionReport>,
    /// All that is broken, by time.
    pub violations: Vec<ViolationReport>,
    /// How near bodies come, nearest first.
    pub distances: Vec<DistanceReport>,
    /// The nearest of them, all wafers taken for one.
    pub nearest: Vec<NearestReport>,
}

/// Motions along straight lines.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct StraightReport {
    /// How many.
    pub motions: usize,
    /// Largest distance of a wafer's centre from its line.
    pub off_um: f64,
    /// Largest angle of its plane from the one that turns evenly.
    pub off_mrad: f64,
}

/// Motions that run into the next.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct BlendedReport {
    /// How many.
    pub motions: usize,
    /// How long two run at once, all together.
    pub overlap_s: f64,
    /// Largest distance of a wafer's centre from the way without it, at most.
    pub off_mm: f64,
}

/// Carried wafers where they change hands: what of droop and sag is made up for, and what is left.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct CompensatedReport {
    /// How often a wafer changes hands.
    pub handovers: usize,
    /// Largest drop of a loaded arm, which is made up for.
    pub drop_um: f64,
    /// Largest slope of a loaded arm, which is made up for.
    pub slope_mrad: f64,
    /// Largest distance of a wafer's mean plane from its supports by its own sag, which is made up for.
    pub sag_um: f64,
    /// Largest distance of that plane's centre from where it should be by the slot.
    pub left_um: f64,
    /// Largest angle of that plane to the slot's.
    pub left_mrad: f64,
    /// What no platform removes: the largest root of the mean square of a wafer's distance from its mean plane.
    pub bent_um: f64,
    /// Largest distance by which an effector moves as its arm takes a wafer's weight or gives it up; poses jump by it at the handover.
    pub jump_um: f64,
    /// Tilt by which the taught planes of these slots may be off with 95 % confidence, the largest; none where no such plane is taught.
    pub taught_mrad: Option<f64>,
    /// Height by which these slots may be off by that, with 95 % confidence, the largest.
    pub taught_um: Option<f64>,
    /// Stations among them whose taught planes have an unknown uncertainty: three points of unknown noise.
    pub taught_unknown: Vec<String>,
}

/// An axis in a motion.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct AxisReport {
    /// What it is called.
    pub name: String,
    /// `mm` or `deg`.
    pub unit: &'static str,
    /// How long it moves.
    pub moving_s: f64,
}

/// How near a limit something comes.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ShareReport {
    /// Which axis or effector.
    pub name: String,
    /// As a share of the limit: above 1 it is broken.
    pub share: f64,
    /// When.
    pub time_s: f64,
}

/// An instruction as it runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct InstructionReport {
    /// Counted from 1, in the order of running.
    pub number: usize,
    /// Where it is written.
    pub line: usize,
    /// As it is written.
    pub text: String,
    /// When it starts.
    pub start_s: f64,
    /// How long it takes.
    pub duration_s: f64,
    /// How many motions it comes to; a wait that takes no time is none.
    pub steps: usize,
    /// Motions of it along straight lines, where there are some.
    pub straight: Option<StraightReport>,
    /// Motions of it that run into the next, where there are some.
    pub blended: Option<BlendedReport>,
    /// Carried wafers where they change hands in it, where some do.
    pub compensated: Option<CompensatedReport>,
    /// How long each axis moves in it, in the order of `axes`.
    pub moving_s: Vec<f64>,
    /// Axis that comes nearest to its speed limit.
    pub speed: Option<ShareReport>,
    /// Axis that comes nearest to its acceleration limit.
    pub acceleration: Option<ShareReport>,
    /// Axis that comes nearest to its jerk limit.
    pub jerk: Option<ShareReport>,
    /// Share of the tilt limit.
    pub tilt: f64,
    /// Share of the play budget.
    pub play: f64,
    /// Effector whose wafer comes nearest to slipping.
    pub slip: Option<ShareReport>,
    /// The two bodies that come nearest.
    pub nearest: Option<DistanceReport>,
    /// How many violations begin in it.
    pub violations: usize,
}

/// Something that is broken for a stretch of time.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ViolationReport {
    /// Such as `speed limit` or `collision`.
    pub kind: String,
    /// Axis, effector or bodies that it is about.
    pub names: Vec<String>,
    /// Number of the instruction, from 1.
    pub instruction: usize,
    /// Where that is written.
    pub line: usize,
    /// And in which column.
    pub column: usize,
    /// First time at which it is broken.
    pub start_s: f64,
    /// Last time at which it is broken.
    pub end_s: f64,
    /// When it is worst.
    pub worst_s: f64,
    /// The worst value, in `unit`.
    pub worst: Option<f64>,
    /// What is allowed, in `unit`.
    pub limit: Option<f64>,
    /// Unit of both; empty where there is nothing to count.
    pub unit: &'static str,
    /// The same in words.
    pub message: String,
}

/// Tells what a check finds.
///
/// # Arguments
/// * `program` – its text, of which lines are quoted
#[must_use]
pub fn cell(cell: &Cell, program: &str, motion: &Trajectory, report: &Report) -> CellReport {
    let robot = &cell.robot;
    let lines: Vec<&str> = program.lines().map(str::trim).collect();
    let effectors: Vec<String> = robot
        .effectors()
        .map(|id| robot.arms[id.arm].effectors[id.effector].name.clone())
        .collect();
    let axes: Vec<String> = robot.axes.iter().map(|axis| axis.name.clone()).collect();
    let share = |share: &Option<Share>, names: &[String]| {
        share.map(|one| ShareReport {
            name: names.get(one.of).cloned().unwrap_or_default(),
            share: one.share,
            time_s: one.time,
        })
    };
    let carried = handover_deflections(cell, &motion.steps);
    let instructions = report.by_instruction.iter().map(|row| InstructionReport {
        number: row.instruction + 1,
        line: row.place.line,
        text: lines.get(row.place.line.wrapping_sub(1)).copied().unwrap_or_default().to_owned(),
        start_s: row.start,
        duration_s: row.duration,
        steps: lasting(motion, row.steps.clone()),
        straight: straight(motion, row.steps.clone()),
        blended: blended(motion, row.steps.clone()),
        compensated: compensated(cell, &carried, row.steps.clone()),
        moving_s: row.moving.clone(),
        speed: share(&row.velocity, &axes),
        acceleration: share(&row.acceleration, &axes),
        jerk: share(&row.jerk, &axes),
        tilt: row.tilt,
        play: row.play,
        slip: share(&row.slip, &effectors),
        nearest: row.nearest.as_ref().map(|pair| distance(cell, pair)),
        violations: row.violations,
    });
    let moving = robot.axes.iter().zip(&report.moving).map(|(axis, &moving_s)| AxisReport {
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
        verdict: match report.verdict {
            Verdict::Sound => "sound",
            Verdict::Broken => "broken",
        },
        duration_s: report.duration,
        wafers: report.wafers,
        wafers_per_hour: report.wafers_per_hour,
        steps: lasting(motion, 0..motion.steps.len()),
        straight: straight(motion, 0..motion.steps.len()),
        blended: blended(motion, 0..motion.steps.len()),
        compensated: compensated(cell, &carried, 0..motion.steps.len()),
        samples: report.samples,
        axes: moving.collect(),
        instructions: instructions.collect(),
        violations: report.violations.iter().map(|one| violation(cell, one)).collect(),
        nearest: nearest(cell, &report.distances),
        distances,
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
    carried: &[HandoverDeflection],
    steps: Range<usize>,
) -> Option<CompensatedReport> {
    // They come in order.
    let at = |step| carried.partition_point(|one| one.step < step);
    let carried = &carried[at(steps.start)..at(steps.end)];
    let (mut tilt, mut height) = (None::<f64>, None::<f64>);
    let mut unknown = std::collections::BTreeSet::new();
    for one in carried {
        let station = &cell.stations[one.slot.station];
        let Origin::Taught(fit) = &station.origin else { continue };
        let Some(known) = &fit.uncertainty else {
            unknown.insert(station.name.clone());
            continue;
        };
        let place = station.slot_frame(one.slot.slot).translation.vector;
        tilt = Some(tilt.unwrap_or(0.0).max(known.tilt_95));
        height = Some(height.unwrap_or(0.0).max(known.height_95(&place)));
    }
    (!carried.is_empty()).then(|| CompensatedReport {
        handovers: carried.len(),
        drop_um: um(most(carried, |one| one.deflection.drop)),
        slope_mrad: mm(most(carried, |one| one.deflection.slope)),
        sag_um: um(most(carried, |one| one.sag.abs())),
        left_um: um(most(carried, |one| one.left)),
        left_mrad: mm(most(carried, |one| one.left_tilt)),
        bent_um: um(most(carried, |one| one.bent)),
        jump_um: um(most(carried, |one| one.jump)),
        taught_mrad: tilt.map(mm),
        taught_um: height.map(um),
        taught_unknown: unknown.into_iter().collect(),
    })
}

/// The largest of some, of which there is one at least.
fn most<T>(all: &[T], of: impl Fn(&T) -> f64) -> f64 {
    all.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
}

/// A message at a place of a program, with its line and carets under the command.
///
/// # Arguments
/// * `file` – what the program is called
#[must_use]
pub fn excerpt(program: &str, at: Place, message: &str, file: &str) -> String {
    let text = program.lines().nth(at.line.wrapping_sub(1)).unwrap_or_default();
    let command = text.split('#').next().unwrap_or_default().trim_end();
    let width = command.chars().count().saturating_sub(at.column.saturating_sub(1));
    let (column, text) = (at.column.max(1), text.to_owned());
    let place = place::Place { line: at.line, column, width, text };
    place::Error { place, problem: Box::new(message) }.with_excerpt(file)
}

fn violation(cell: &Cell, one: &Violation) -> ViolationReport {
    let (unit, worst) = in_display_unit(one, one.worst);
    let counts = !unit.is_empty() && one.worst.is_finite();
    ViolationReport {
        kind: one.kind.to_string(),
        names: one.entities.iter().map(|&one| cell.entity_name(one)).collect(),
        instruction: one.instruction + 1,
        line: one.place.line,
        column: one.place.column,
        start_s: one.start,
        end_s: one.end,
        worst_s: one.worst_time,
        worst: counts.then_some(worst),
        limit: counts.then(|| in_display_unit(one, one.limit).1),
        unit,
        message: explain_violation(cell, one),
    }
}
