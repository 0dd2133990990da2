//! A motion as a table: one row per sample.

use jointplay_cell::robot::{AxisKind, ChainPose, EffectorId};
use jointplay_cell::trajectory::Sample;

use super::error::Error;
use super::motion_export::MotionExport;
use jointplay_format::units::{deg, mm};
use jointplay_report::table::{Column, Values};

/// All columns: time, line of the program, step; position, velocity and acceleration of each axis; the wafer centre of each effector; the number of violations, if there are any.
///
/// # Arguments
/// * `rate` – number of rows per second; the last row is the end of the motion (Hz)
///
/// # Errors
/// [`Error::Rate`], [`Error::TooManySamples`], [`Error::Placing`]
pub fn samples(motion_export: &MotionExport<'_>, rate: f64) -> Result<Vec<Column>, Error> {
    motion_export.check_rate(rate)?;
    table(motion_export, motion_export.motion.samples(rate))
}

/// Number of rows that are kept in memory.
const PART: usize = 1 << 16;

/// The table of [`samples`] in parts of limited size.
///
/// # Arguments
/// * `rate` – number of rows per second; the last row is the end of the motion (Hz)
/// * `take` – receives the next rows, as columns that are the same in all parts
///
/// # Errors
/// As [`samples`], and those of `take`.
pub fn samples_in_parts<E: From<Error>>(
    motion_export: &MotionExport<'_>,
    rate: f64,
    mut take: impl FnMut(&[Column]) -> Result<(), E>,
) -> Result<(), E> {
    motion_export.check_rate(rate)?;
    let mut samples = motion_export.motion.samples(rate).peekable();
    while samples.peek().is_some() {
        take(&table(motion_export, samples.by_ref().take(PART))?)?;
    }
    Ok(())
}

/// The table of [`samples`] with additional rows, so that lines from row to row represent the motion: at the ends of steps, at peaks of velocities and where accelerations have a corner.
///
/// # Arguments
/// * `rate` – least number of rows per second (Hz)
///
/// # Errors
/// As [`samples`].
pub fn samples_with_peaks(
    motion_export: &MotionExport<'_>,
    rate: f64,
) -> Result<Vec<Column>, Error> {
    motion_export.check_rate(rate)?;
    let times = plot_times(motion_export, rate, [0.0, motion_export.motion.duration()]);
    table(motion_export, times.into_iter().map(|time| motion_export.motion.sample_at(time)))
}

/// [`samples`], or [`samples_with_peaks`], of an interval of time.
///
/// # Arguments
/// * `rate` – least number of rows per second (Hz)
/// * `peaks` – whether to add rows at peaks
/// * `from`, `to` – first and last time; rows outside are omitted (s)
///
/// # Errors
/// As [`samples`].
pub fn samples_within(
    motion_export: &MotionExport<'_>,
    rate: f64,
    peaks: bool,
    [from, to]: [f64; 2],
) -> Result<Vec<Column>, Error> {
    motion_export.check_rate(rate)?;
    let motion = motion_export.motion;
    if peaks {
        let times = plot_times(motion_export, rate, [from, to]);
        return table(motion_export, times.into_iter().map(|time| motion.sample_at(time)));
    }
    let times = motion.sample_times(rate).iter().filter(|time| (from..=to).contains(time));
    table(motion_export, times.map(|time| motion.sample_at(time)))
}

/// Sample times between which velocities and accelerations are linear, within a share of the limits without a wafer (s).
fn plot_times(motion_export: &MotionExport<'_>, rate: f64, interval: [f64; 2]) -> Vec<f64> {
    let limits = motion_export.cell.robot.axes.iter().map(|axis| &axis.empty);
    motion_export.motion.plot_times(rate, interval, limits)
}

fn table(
    motion_export: &MotionExport<'_>,
    samples: impl Iterator<Item = Sample>,
) -> Result<Vec<Column>, Error> {
    let MotionExport { cell, motion, violation_notes, .. } = *motion_export;
    let axes = &cell.robot.axes;
    let effectors: Vec<_> = cell.robot.effectors().collect();
    let mut time = Vec::new();
    let (mut line, mut step) = (Vec::new(), Vec::new());
    let mut violations = Vec::new();
    let mut states: Vec<[Vec<f64>; 3]> = vec![Default::default(); axes.len()];
    let mut centers: Vec<[Vec<f64>; 3]> = vec![Default::default(); effectors.len()];
    for sample in samples {
        let pose = placed(
            motion_export,
            sample.time,
            &sample.positions,
            loaded(motion_export, sample.step),
        )?;
        time.push(sample.time);
        let count = |value: usize| u32::try_from(value).unwrap_or(u32::MAX);
        line.push(count(motion.steps.get(sample.step).map_or(0, |step| step.place.line)));
        step.push(count(sample.step + 1));
        let here = |violation_note: &&super::violation_note::ViolationNote| {
            violation_note.from <= sample.time && sample.time <= violation_note.to
        };
        violations.push(count(violation_notes.iter().filter(here).count()));
        let state = [&sample.positions, &sample.velocities, &sample.accelerations];
        for (axis, columns) in states.iter_mut().enumerate() {
            let unit: fn(f64) -> f64 = if turns(axes[axis].kind) { deg } else { mm };
            for (column, values) in columns.iter_mut().zip(state) {
                column.push(unit(values[axis]));
            }
        }
        for (columns, id) in centers.iter_mut().zip(&effectors) {
            let center = pose.base_from_wafer[id.arm][id.effector].translation.vector;
            for (column, &value) in columns.iter_mut().zip(center.iter()) {
                column.push(mm(value));
            }
        }
    }
    let real = |name: String, values| Column { name, values: Values::Real(values) };
    let count =
        |name: &str, values| Column { name: name.to_owned(), values: Values::Count(values) };
    let mut columns =
        vec![real("time_s".to_owned(), time), count("line", line), count("step", step)];
    for (axis, state) in axes.iter().zip(states) {
        let unit = if turns(axis.kind) { "deg" } else { "mm" };
        for (end, values) in ["", "_per_s", "_per_s2"].iter().zip(state) {
            columns.push(real(format!("{}_{unit}{end}", axis.name), values));
        }
    }
    for (&id, center) in effectors.iter().zip(centers) {
        for (axis, values) in ["x", "y", "z"].iter().zip(center) {
            columns.push(real(format!("{}_{axis}_mm", motion_export.effector_name(id)), values));
        }
    }
    if !violation_notes.is_empty() {
        columns.push(count("violations", violations));
    }
    Ok(columns)
}

/// Tracks of the wafer centres of all effectors: x and y in the base frame at equal intervals of time (m).
///
/// # Arguments
/// * `rate` – number of points per second (Hz)
///
/// # Errors
/// As [`samples`].
pub fn tracks(motion_export: &MotionExport<'_>, rate: f64) -> Result<Vec<Vec<[f64; 2]>>, Error> {
    motion_export.check_rate(rate)?;
    let effectors: Vec<_> = motion_export.cell.robot.effectors().collect();
    let mut tracks = vec![Vec::new(); effectors.len()];
    for sample in motion_export.motion.samples(rate) {
        let pose = placed(
            motion_export,
            sample.time,
            &sample.positions,
            loaded(motion_export, sample.step),
        )?;
        for (track, id) in tracks.iter_mut().zip(&effectors) {
            let center = pose.base_from_wafer[id.arm][id.effector].translation.vector;
            track.push([center.x, center.y]);
        }
    }
    Ok(tracks)
}

/// Poses of all parts of the robot for positions of all axes, with droop.
pub(super) fn placed(
    motion_export: &MotionExport<'_>,
    time: f64,
    positions: &[f64],
    loaded: &[EffectorId],
) -> Result<ChainPose, Error> {
    let failed = |source| Error::Placing { time, source: Box::new(source) };
    motion_export.cell.forward_with_deflection(positions, loaded).map_err(failed)
}

/// Effectors that carry a wafer in a step.
pub(super) fn loaded<'a>(motion_export: &MotionExport<'a>, step: usize) -> &'a [EffectorId] {
    motion_export.motion.steps.get(step).map_or(&[], |step| &step.loaded)
}

pub(super) fn turns(kind: AxisKind) -> bool {
    kind == AxisKind::Rotary
}
