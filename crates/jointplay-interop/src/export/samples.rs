//! A motion as a table: one row per sample.

use std::f64::consts::PI;

use jointplay_cell::robot::{AxesMotion, AxisKind, ChainPose, EffectorId, FrameMotion};
use jointplay_cell::trajectory::Sample;
use jointplay_core::spatial::{Pose, Tilt, continued_quaternion, heading};

use super::error::Error;
use super::motion_export::MotionExport;
use super::sample_columns::{
    DEFAULT_COLUMNS, Derivative, FrameQuantity, Quantity, RobotFrame, SampleColumn, robot_frames,
    sample_columns,
};
use jointplay_format::place::nearest;
use jointplay_format::units::{deg, mm, um};
use jointplay_report::table::{Column, Values};

/// Rows and columns of a table of samples.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleOptions {
    /// Number of rows per second; the last row of a motion is its end (Hz).
    pub rate: f64,
    /// Additional rows, so that lines from row to row represent the motion: at the ends of steps, at peaks of velocities and where accelerations have a corner.
    pub peaks: bool,
    /// First and last time; rows outside are omitted (s).
    pub window: Option<[f64; 2]>,
    /// Columns in their order; `None` for the default ones. The number of violations follows if there are any.
    pub columns: Option<Vec<SampleColumn>>,
}

impl SampleOptions {
    /// The default columns at a sampling rate (Hz).
    #[must_use]
    pub fn at_rate(rate: f64) -> Self {
        Self { rate, peaks: false, window: None, columns: None }
    }
}

/// The table of a motion with the default columns: time, line of the program, step; position, velocity and acceleration of each axis; the wafer centre of each effector; the number of violations, if there are any.
///
/// # Arguments
/// * `rate` – number of rows per second; the last row is the end of the motion (Hz)
///
/// # Errors
/// As [`samples_with`].
pub fn samples(motion_export: &MotionExport<'_>, rate: f64) -> Result<Vec<Column>, Error> {
    samples_with(motion_export, &SampleOptions::at_rate(rate))
}

/// The table of a motion with chosen rows and columns.
///
/// # Errors
/// [`Error::Rate`], [`Error::TooManySamples`], [`Error::Window`], [`Error::Placing`]
pub fn samples_with(
    motion_export: &MotionExport<'_>,
    options: &SampleOptions,
) -> Result<Vec<Column>, Error> {
    let mut table = Table::new(motion_export, options);
    let times = times(motion_export, options)?;
    table.continue_quaternions(options)?;
    table.rows(times)
}

/// Number of rows that are kept in memory.
const PART: usize = 1 << 16;

/// The table of [`samples_with`] in parts of limited size; at least one row.
///
/// # Arguments
/// * `take` – receives the next rows, as columns that are the same in all parts
///
/// # Errors
/// As [`samples_with`], [`Error::NoSamples`], and those of `take`.
pub fn samples_in_parts<E: From<Error>>(
    motion_export: &MotionExport<'_>,
    options: &SampleOptions,
    mut take: impl FnMut(&[Column]) -> Result<(), E>,
) -> Result<(), E> {
    let mut table = Table::new(motion_export, options);
    let mut times = times(motion_export, options)?.peekable();
    table.continue_quaternions(options)?;
    if let (None, Some([from, to])) = (times.peek(), options.window) {
        return Err(Error::NoSamples { rate: options.rate, from, to }.into());
    }
    while times.peek().is_some() {
        take(&table.rows(times.by_ref().take(PART))?)?;
    }
    Ok(())
}

/// Poses of a frame of the robot in the base frame at the rows of a table: `base_from_frame`.
///
/// # Arguments
/// * `name` – name of a rod, `platform`, name of a link such as `upper link 1`, or of an effector, whose frame is that of its wafer
/// * `options` – columns are ignored
///
/// # Errors
/// [`Error::UnknownFrame`], and those of [`samples_with`].
pub fn frame_poses(
    motion_export: &MotionExport<'_>,
    name: &str,
    options: &SampleOptions,
) -> Result<Vec<Pose>, Error> {
    let cell = motion_export.cell;
    let frames = robot_frames(cell);
    let Some((_, frame)) = frames.iter().find(|(known, _)| known == name) else {
        let known: Vec<String> = frames.into_iter().map(|(name, _)| name).collect();
        let nearest = nearest(name, known.iter().map(String::as_str));
        return Err(Error::UnknownFrame { found: name.to_owned(), nearest, known });
    };
    let pose = |time: f64| {
        let sample = motion_export.motion.sample_at(time);
        let loaded = loaded(motion_export, sample.step);
        Ok(frame.of(cell, &placed(motion_export, time, &sample.positions, loaded)?))
    };
    times(motion_export, options)?.map(pose).collect()
}

/// Times of the rows of a table.
fn times(
    motion_export: &MotionExport<'_>,
    options: &SampleOptions,
) -> Result<Box<dyn Iterator<Item = f64>>, Error> {
    let (motion, rate) = (motion_export.motion, options.rate);
    let duration = motion.duration();
    let [from, to] = options.window.unwrap_or([0.0, duration]);
    // Also refuses NaN.
    if !(from >= 0.0 && from <= to && from <= duration) {
        return Err(Error::Window { from, to, duration });
    }
    motion_export.check_samples(rate, to.min(duration) - from)?;
    if options.peaks {
        // Between these times velocities and accelerations are linear, within a share of the limits without a wafer.
        let limits = motion_export.cell.robot.axes.iter().map(|axis| &axis.empty);
        return Ok(Box::new(motion.plot_times(rate, [from, to], limits).into_iter()));
    }
    let sampling = motion.sample_times(rate).iter();
    Ok(Box::new(sampling.skip_while(move |&time| time < from).take_while(move |&time| time <= to)))
}

/// The columns of a table, and the motion that they show.
struct Table<'a> {
    motion_export: &'a MotionExport<'a>,
    columns: Vec<SampleColumn>,
    /// Whether a column needs the poses of the robot.
    has_poses: bool,
    /// Frames whose quaternion is in columns, with that of the last row.
    quaternions: Vec<(RobotFrame, Option<[f64; 4]>)>,
}

/// The state of the cell at one time.
struct Row<'a> {
    sample: Sample,
    loaded: &'a [EffectorId],
    /// Poses of the robot, where a column needs them.
    pose: Option<ChainPose>,
}

impl<'a> Table<'a> {
    fn new(motion_export: &'a MotionExport<'a>, options: &SampleOptions) -> Self {
        let mut columns = options.columns.clone().unwrap_or_else(|| {
            let mut columns = sample_columns(motion_export.cell);
            columns.retain(|column| column.groups.iter().any(|group| group == DEFAULT_COLUMNS));
            columns
        });
        let counts = |column: &SampleColumn| column.quantity == Quantity::Violations;
        if !motion_export.violation_notes.is_empty() && !columns.iter().any(counts) {
            columns.extend(sample_columns(motion_export.cell).into_iter().filter(counts));
        }
        let poses = |column: &SampleColumn| {
            matches!(
                column.quantity,
                Quantity::Frame { .. }
                    | Quantity::Quaternion { .. }
                    | Quantity::VirtualDisplacement
                    | Quantity::TiltShare
            )
        };
        let has_poses = columns.iter().any(poses);
        let mut quaternions: Vec<(RobotFrame, Option<[f64; 4]>)> = Vec::new();
        for column in &columns {
            if let Quantity::Quaternion { frame, .. } = column.quantity
                && quaternions.iter().all(|(other, _)| *other != frame)
            {
                quaternions.push((frame, None));
            }
        }
        Self { motion_export, columns, has_poses, quaternions }
    }

    /// Follows the signs of quaternions to the start of a window, so that they are those of the whole table.
    fn continue_quaternions(&mut self, options: &SampleOptions) -> Result<(), Error> {
        if let (Some([from, _]), false) = (options.window, self.quaternions.is_empty()) {
            let times = self.motion_export.motion.sample_times(options.rate);
            for time in times.iter().take_while(|&time| time < from) {
                let sample = self.motion_export.motion.sample_at(time);
                let loaded = loaded(self.motion_export, sample.step);
                let pose = placed(self.motion_export, time, &sample.positions, loaded)?;
                self.turn(&pose);
            }
        }
        Ok(())
    }

    /// The quaternions of a pose of the robot, with signs that continue those before them.
    fn turn(&mut self, pose: &ChainPose) {
        for (frame, last) in &mut self.quaternions {
            let rotation = frame.of(self.motion_export.cell, pose).rotation;
            *last = Some(continued_quaternion(&rotation, last.as_ref()));
        }
    }

    /// The rows at given times.
    fn rows(&mut self, times: impl Iterator<Item = f64>) -> Result<Vec<Column>, Error> {
        let values = |column: &SampleColumn| match column.quantity {
            Quantity::Line | Quantity::Step | Quantity::Loaded(_) | Quantity::Violations => {
                Values::Count(Vec::new())
            }
            _ => Values::Real(Vec::new()),
        };
        let mut all: Vec<Values> = self.columns.iter().map(values).collect();
        for time in times {
            let sample = self.motion_export.motion.sample_at(time);
            let loaded = loaded(self.motion_export, sample.step);
            let pose = match self.has_poses {
                true => Some(placed(self.motion_export, time, &sample.positions, loaded)?),
                false => None,
            };
            if let Some(pose) = &pose {
                self.turn(pose);
            }
            let row = Row { sample, loaded, pose };
            for (column, values) in self.columns.iter().zip(&mut all) {
                match values {
                    Values::Real(values) => values.push(self.number(&row, column.quantity)?),
                    Values::Count(values) => {
                        let count = self.count(&row, column.quantity);
                        values.push(u32::try_from(count).unwrap_or(u32::MAX));
                    }
                }
            }
        }
        let named = |(column, values): (&SampleColumn, Values)| {
            let name = column.name.clone();
            Column { name, values }
        };
        Ok(self.columns.iter().zip(all).map(named).collect())
    }

    /// A quantity that is counted.
    fn count(&self, row: &Row<'_>, quantity: Quantity) -> usize {
        let (step, time) = (row.sample.step, row.sample.time);
        match quantity {
            Quantity::Line => {
                self.motion_export.motion.steps.get(step).map_or(0, |step| step.place.line)
            }
            Quantity::Step => step + 1,
            Quantity::Loaded(effector) => usize::from(row.loaded.contains(&effector)),
            _ => {
                let notes = self.motion_export.violation_notes.iter();
                notes.filter(|note| note.from <= time && time <= note.to).count()
            }
        }
    }

    /// A quantity that is a number, in the unit of its column.
    fn number(&self, row: &Row<'_>, quantity: Quantity) -> Result<f64, Error> {
        let Row { sample, pose, .. } = row;
        let cell = self.motion_export.cell;
        let of_pose = |number: &dyn Fn(&ChainPose) -> f64| pose.as_ref().map_or(f64::NAN, number);
        Ok(match quantity {
            Quantity::Axis { axis, derivative } => {
                let values = match derivative {
                    Derivative::Position => &sample.positions,
                    Derivative::Velocity => &sample.velocities,
                    Derivative::Acceleration => &sample.accelerations,
                    Derivative::Jerk => &sample.jerks,
                };
                let turns = turns(cell.robot.axes[axis].kind);
                if turns { deg(values[axis]) } else { mm(values[axis]) }
            }
            Quantity::Frame { frame, quantity } => {
                of_pose(&|pose| frame_value(&frame.of(cell, pose), quantity))
            }
            Quantity::Quaternion { frame, part } => {
                let mut turns = self.quaternions.iter().filter(|(other, _)| *other == frame);
                turns.next().and_then(|(_, turn)| *turn).map_or(f64::NAN, |turn| turn[part])
            }
            Quantity::VirtualDisplacement => {
                of_pose(&|pose| um(cell.robot.model.displacement(&cell.robot.gpr, &pose.platform)))
            }
            Quantity::TiltShare => of_pose(&|pose| {
                let base_from_platform = &pose.platform.base_from_platform;
                let tilt = frame_quantity(base_from_platform, FrameQuantity::Tilt);
                100.0 * tilt / cell.robot.gpr.limits().tilt_max
            }),
            Quantity::FrictionShare(effector) => self.friction_share(row, effector),
            Quantity::Speed(effector) => mm(self.wafer_motion(row, effector)?.velocity.norm()),
            Quantity::Acceleration(effector) => {
                mm(self.wafer_motion(row, effector)?.acceleration.norm())
            }
            _ => sample.time,
        })
    }

    /// Motion of an effector's wafer; where the droop is unknown, as the poses, that of the rigid arm.
    fn wafer_motion(&self, row: &Row<'_>, effector: EffectorId) -> Result<FrameMotion, Error> {
        let Sample { time, positions, velocities, accelerations, .. } = &row.sample;
        let cell = self.motion_export.cell;
        let motion = AxesMotion { positions, velocities, accelerations };
        let failed = |source| Error::Placing { time: *time, source: Box::new(source) };
        match cell.wafer_motion(effector, &motion, row.loaded.contains(&effector)) {
            Ok(found) => Ok(found),
            Err(_) => cell.robot.effector_motion(&motion, effector).map_err(failed),
        }
    }

    /// Share of the available friction that a held wafer needs; 0 for an effector without a wafer, NaN where the droop of its arm is unknown (%).
    fn friction_share(&self, row: &Row<'_>, effector: EffectorId) -> f64 {
        if !row.loaded.contains(&effector) {
            return 0.0;
        }
        let Sample { positions, velocities, accelerations, .. } = &row.sample;
        let motion = AxesMotion { positions, velocities, accelerations };
        let demand = self.motion_export.cell.friction_demand(effector, &motion);
        demand.map_or(f64::NAN, |demand| 100.0 * demand.utilization())
    }
}

/// A number of a frame in the base frame, in mm or degrees.
fn frame_value(base_from_frame: &Pose, quantity: FrameQuantity) -> f64 {
    let value = frame_quantity(base_from_frame, quantity);
    match quantity {
        FrameQuantity::X | FrameQuantity::Y | FrameQuantity::Z => mm(value),
        FrameQuantity::Heading | FrameQuantity::Tilt | FrameQuantity::TiltAzimuth => deg(value),
    }
}

/// A number of a frame in the base frame (m or rad).
pub(super) fn frame_quantity(base_from_frame: &Pose, quantity: FrameQuantity) -> f64 {
    let origin = &base_from_frame.translation.vector;
    let normal = base_from_frame.rotation.matrix().column(2).into_owned();
    match quantity {
        FrameQuantity::X => origin.x,
        FrameQuantity::Y => origin.y,
        FrameQuantity::Z => origin.z,
        FrameQuantity::Heading => match heading(base_from_frame) {
            // Round-off decides between −180° and 180°.
            angle if angle < -PI + 2e-11 => PI,
            angle => angle,
        },
        FrameQuantity::Tilt => Tilt::from_normal(&normal).angle,
        FrameQuantity::TiltAzimuth => Tilt::from_normal(&normal).azimuth,
    }
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
