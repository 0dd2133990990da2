//! Text of a motion in a dialect.

use jointplay_cell::program::{Handoff, Path, Step};
use jointplay_cell::trajectory::Sample;
use jointplay_format::number::fixed;
use jointplay_format::place;
use jointplay_format::program::phase_name;

use super::language::{Dialect, Motions};
use crate::controller_text::{Codes, Output, Problem, Template, Value, count, one_line};
use crate::export::error::Error;
use crate::export::motion_export::MotionExport;

/// Length of the text that is kept in memory (bytes).
const PART: usize = 1 << 20;

impl Dialect {
    /// Whether its text has points at a rate, rather than a line for each step.
    #[must_use]
    pub fn has_points(&self) -> bool {
        matches!(self.motion, Motions::Points(_))
    }

    /// A motion in this dialect.
    ///
    /// Durations add up to the duration of the motion: each is the difference of two rounded times.
    ///
    /// # Arguments
    /// * `rate` – number of points per second, for dialects with points (Hz)
    ///
    /// # Errors
    /// [`Error::Rate`], [`Error::TooManySamples`], [`Error::Dialect`]
    pub fn write(&self, motion_export: &MotionExport<'_>, rate: f64) -> Result<String, Error> {
        let mut whole = String::new();
        self.write_in_parts(motion_export, rate, |part| {
            whole.push_str(part);
            Ok::<_, Error>(())
        })?;
        Ok(whole)
    }

    /// The text of [`Self::write`] in parts of limited size.
    ///
    /// # Arguments
    /// * `rate` – number of points per second, for dialects with points (Hz)
    /// * `take` – receives the next part
    ///
    /// # Errors
    /// As [`Self::write`], and those of `take`.
    pub fn write_in_parts<E: From<Error>>(
        &self,
        motion_export: &MotionExport<'_>,
        rate: f64,
        mut take: impl FnMut(&str) -> Result<(), E>,
    ) -> Result<(), E> {
        motion_export.check_rate(rate)?;
        self.check_codes(motion_export)?;
        let mut output = Output::new(&self.output);
        let mut pass_on = |output: &mut Output<'_>, least: usize| {
            if output.text.len() > least {
                take(&output.text)?;
                output.text.clear();
            }
            Ok::<_, E>(())
        };
        let MotionExport { cell, motion, .. } = *motion_export;
        if let Some(warning) = motion_export.warning() {
            self.push_comment(&mut output, &warning)?;
            for violation_note in motion_export.violation_notes {
                let when = fixed(violation_note.from, self.time_decimals);
                self.push_comment(&mut output, &format!("{when} s: {}", violation_note.message))?;
            }
        }
        let ends = |output: &mut Output<'_>, lines: &[Template], time: f64| {
            let axes = cell.robot.axes.iter().map(|axis| axis.name.clone());
            let names = axes.collect::<Vec<_>>().join(&self.axis.between);
            let sample = motion.sample_at(time);
            let positions = self.values(motion_export, &sample.positions)?;
            let pose = self.chain_pose(motion_export, lines, &sample)?;
            let poses = self.poses(motion_export, pose.as_ref(), lines)?;
            push(output, lines, |name| match name {
                "cell" => Value::Text(one_line(&cell.name)),
                "robot" => Value::Text(one_line(&cell.robot.name)),
                "axes" => Value::Text(names.clone()),
                "positions" => Value::Text(positions.clone()),
                "poses" => Value::Text(poses.clone()),
                _ => Value::Real(time),
            })
        };
        ends(&mut output, &self.begin, 0.0)?;
        let mut points = match self.motion {
            Motions::Points(_) => Some(motion.samples(rate).enumerate().peekable()),
            Motions::Steps { .. } => None,
        };
        for (k, step) in motion.steps.iter().enumerate() {
            if k == 0 || motion.steps[k - 1].instruction != step.instruction {
                push(&mut output, &self.instruction, |name| match name {
                    "number" => count(step.instruction + 1),
                    "line" => count(step.place.line),
                    _ => Value::Text(one_line(motion_export.line(k))),
                })?;
            }
            let (start, end) = (motion.times[k], motion.times[k + 1]);
            match &self.motion {
                Motions::Steps { .. } if !motion.has_duration(k) => {}
                Motions::Steps { axes, line, still } => {
                    let (lines, effector) = match step.path {
                        Path::PointToPoint => (axes, None),
                        Path::Line(id) => (line, Some(id)),
                        Path::Dwell(_) | Path::ProcessDwell { .. } => (still, None),
                    };
                    let positions = self.values(motion_export, &step.to)?;
                    let pose = self.chain_pose(motion_export, lines, &target(step, k, end))?;
                    let poses = self.poses(motion_export, pose.as_ref(), lines)?;
                    let of_pose = |name: &str| self.pose_value(pose.as_ref(), effector?, name);
                    let effector = effector.map_or("", |id| motion_export.effector_name(id));
                    push(&mut output, lines, |name| match name {
                        "number" => count(k + 1),
                        "poses" => Value::Text(poses.clone()),
                        "phase" => Value::Text(phase_name(step.phase).to_owned()),
                        "time" => Value::Real(start),
                        "duration" => Value::Real(self.duration(start, end)),
                        "positions" => Value::Text(positions.clone()),
                        _ => of_pose(name).unwrap_or_else(|| Value::Text(effector.to_owned())),
                    })?;
                    pass_on(&mut output, PART)?;
                }
                Motions::Points(lines) => {
                    let last = k + 1 == motion.steps.len();
                    while let Some((number, point)) = points
                        .as_mut()
                        .and_then(|points| points.next_if(|(_, at)| at.time < end || last))
                    {
                        let positions = self.values(motion_export, &point.positions)?;
                        let velocities = self.values(motion_export, &point.velocities)?;
                        let pose = self.chain_pose(motion_export, lines, &point)?;
                        let poses = self.poses(motion_export, pose.as_ref(), lines)?;
                        push(&mut output, lines, |name| match name {
                            "number" => count(number + 1),
                            "time" => Value::Real(point.time),
                            "positions" => Value::Text(positions.clone()),
                            "poses" => Value::Text(poses.clone()),
                            _ => Value::Text(velocities.clone()),
                        })?;
                        pass_on(&mut output, PART)?;
                    }
                }
            }
            if let Some(blend) = motion.blend(k) {
                push(&mut output, &self.blend, |_| Value::Real(blend.overlap))?;
            }
            let (lines, id, slot) = match step.handoff {
                Some(Handoff::Picked(id, slot)) => (&self.taken, id, slot),
                Some(Handoff::Placed(id, slot)) => (&self.left, id, slot),
                None => continue,
            };
            let (effector, station) =
                (motion_export.effector_name(id), &cell.stations[slot.station].name);
            let pose = self.chain_pose(motion_export, lines, &target(step, k, end))?;
            push(&mut output, lines, |name| match name {
                "effector" => Value::Text(effector.to_owned()),
                "station" => Value::Text(station.clone()),
                "effector_code" => self.effector_code(effector),
                "station_code" => code(self.station_codes.as_ref(), station),
                name => {
                    self.pose_value(pose.as_ref(), id, name).unwrap_or_else(|| count(slot.slot))
                }
            })?;
        }
        ends(&mut output, &self.end, motion.duration())?;
        output.finish().map_err(invalid)?;
        pass_on(&mut output, 0)
    }

    /// Checks that every station and effector of a hand-off has the code that a template needs.
    fn check_codes(&self, motion_export: &MotionExport<'_>) -> Result<(), Error> {
        let MotionExport { cell, motion, .. } = *motion_export;
        let needs = |name: &str| self.taken.iter().chain(&self.left).any(|one| one.uses(name));
        let poses_need_codes = self.pose.as_ref().is_some_and(|one| one.uses("effector_code"));
        let handoffs = || {
            motion.steps.iter().filter_map(|step| match step.handoff? {
                Handoff::Picked(id, slot) | Handoff::Placed(id, slot) => Some((id, slot)),
            })
        };
        let mut errors = Vec::new();
        if let (Some(codes), true) = (&self.station_codes, needs("station_code")) {
            let names = handoffs().map(|(_, slot)| cell.stations[slot.station].name.as_str());
            errors.extend(codes.missing(names));
        }
        if let (Some(codes), true) = (&self.effector_codes, poses_need_codes) {
            let names = cell.robot.effectors().map(|id| motion_export.effector_name(id));
            errors.extend(codes.missing(names));
        } else if let (Some(codes), true) = (&self.effector_codes, needs("effector_code")) {
            let names = handoffs().map(|(id, _)| motion_export.effector_name(id));
            errors.extend(codes.missing(names));
        }
        if errors.is_empty() { Ok(()) } else { Err(Error::Dialect(errors.into())) }
    }

    /// The code of an effector; empty without codes.
    pub(super) fn effector_code(&self, name: &str) -> Value {
        code(self.effector_codes.as_ref(), name)
    }

    fn push_comment(&self, output: &mut Output<'_>, what: &str) -> Result<(), Error> {
        let comment = std::slice::from_ref(&self.comment);
        push(output, comment, |_| Value::Text(one_line(what)))
    }

    /// A value for each axis.
    fn values(&self, motion_export: &MotionExport<'_>, values: &[f64]) -> Result<String, Error> {
        self.axis.values(&motion_export.cell.robot, values).map_err(invalid)
    }

    /// The difference of two rounded times.
    fn duration(&self, start: f64, end: f64) -> f64 {
        let unit = 10_f64.powi(i32::try_from(self.time_decimals).unwrap_or(0));
        ((end * unit).round() - (start * unit).round()) / unit
    }
}

fn push(
    output: &mut Output<'_>,
    lines: &[Template],
    value: impl Fn(&str) -> Value,
) -> Result<(), Error> {
    for line in lines {
        let text = line.fill(&value).map_err(invalid)?;
        output.push(&text).map_err(invalid)?;
    }
    Ok(())
}

/// The error of a template that has no text for this motion.
pub(super) fn invalid(error: place::Error<Problem>) -> Error {
    Error::Dialect(vec![error].into())
}

fn code(codes: Option<&Codes>, name: &str) -> Value {
    codes.map_or(Value::Text(String::new()), |codes| codes.code(name))
}

/// The robot at rest at the end of a step, its wafers as during the step.
fn target(step: &Step, index: usize, end: f64) -> Sample {
    Sample { time: end, step: index, positions: step.to.clone(), ..Sample::default() }
}
