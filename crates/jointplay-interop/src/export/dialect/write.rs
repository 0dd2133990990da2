//! Text of a motion in a dialect.

use jointplay_cell::program::{Handoff, Path};
use jointplay_cell::robot::AxisKind;
use jointplay_format::program::phase_name;

use super::template::Template;
use super::{Dialect, Motions};
use crate::export::error::Error;
use crate::export::motion_export::MotionExport;

/// Length of the text that is kept in memory (bytes).
const PART: usize = 1 << 20;

impl Dialect {
    /// A motion in this dialect.
    ///
    /// Durations add up to the duration of the motion: each is the difference of two rounded times.
    ///
    /// # Arguments
    /// * `rate` – number of points per second, for dialects with points (Hz)
    ///
    /// # Errors
    /// [`Error::Rate`], [`Error::TooManySamples`]
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
        let mut pass_on = |text: &mut String, least: usize| {
            if text.len() > least {
                take(text)?;
                text.clear();
            }
            Ok::<_, E>(())
        };
        let MotionExport { cell, motion, .. } = *motion_export;
        let mut text = String::new();
        if let Some(warning) = motion_export.warning() {
            self.push_comment(&mut text, &warning);
            for violation_note in motion_export.violation_notes {
                let when = self.time(violation_note.from);
                self.push_comment(&mut text, &format!("{when} s: {}", violation_note.message));
            }
        }
        let ends = |time: f64, positions: &[f64]| {
            let axes = cell.robot.axes.iter().map(|axis| axis.name.clone());
            let names = axes.collect::<Vec<_>>().join(&self.between);
            let (time, positions) = (self.time(time), self.values(motion_export, positions));
            move |name: &str| match name {
                "cell" => one_line(&cell.name),
                "robot" => one_line(&cell.robot.name),
                "axes" => names.clone(),
                "positions" => positions.clone(),
                _ => time.clone(),
            }
        };
        push(&mut text, &self.begin, ends(0.0, &motion.sample_at(0.0).positions));
        let mut points = match self.motion {
            Motions::Points(_) => Some(motion.samples(rate).enumerate().peekable()),
            Motions::Steps { .. } => None,
        };
        for (k, step) in motion.steps.iter().enumerate() {
            if k == 0 || motion.steps[k - 1].instruction != step.instruction {
                push(&mut text, &self.instruction, |name| match name {
                    "number" => (step.instruction + 1).to_string(),
                    "line" => step.place.line.to_string(),
                    _ => one_line(motion_export.line(k)),
                });
            }
            let (start, end) = (motion.times[k], motion.times[k + 1]);
            match &self.motion {
                Motions::Steps { .. } if !motion.has_duration(k) => {}
                Motions::Steps { axes, line, still } => {
                    let (lines, effector) = match step.path {
                        Path::PointToPoint => (axes, String::new()),
                        Path::Line(id) => (line, motion_export.effector_name(id).to_owned()),
                        Path::Dwell(_) | Path::ProcessDwell { .. } => (still, String::new()),
                    };
                    push(&mut text, lines, |name| match name {
                        "number" => (k + 1).to_string(),
                        "phase" => phase_name(step.phase).to_owned(),
                        "time" => self.time(start),
                        "duration" => self.duration(start, end),
                        "positions" => self.values(motion_export, &step.to),
                        _ => effector.clone(),
                    });
                }
                Motions::Points(lines) => {
                    let last = k + 1 == motion.steps.len();
                    while let Some((number, point)) = points
                        .as_mut()
                        .and_then(|points| points.next_if(|(_, at)| at.time < end || last))
                    {
                        push(&mut text, lines, |name| match name {
                            "number" => (number + 1).to_string(),
                            "time" => self.time(point.time),
                            "positions" => self.values(motion_export, &point.positions),
                            _ => self.values(motion_export, &point.velocities),
                        });
                        pass_on(&mut text, PART)?;
                    }
                }
            }
            if let Some(blend) = motion.blend(k) {
                push(&mut text, &self.blend, |_| self.time(blend.overlap));
            }
            let (lines, id, slot) = match step.handoff {
                Some(Handoff::Picked(id, slot)) => (&self.taken, id, slot),
                Some(Handoff::Placed(id, slot)) => (&self.left, id, slot),
                None => continue,
            };
            push(&mut text, lines, |name| match name {
                "effector" => motion_export.effector_name(id).to_owned(),
                "station" => cell.stations[slot.station].name.clone(),
                _ => slot.slot.to_string(),
            });
        }
        let duration = motion.duration();
        push(&mut text, &self.end, ends(duration, &motion.sample_at(duration).positions));
        pass_on(&mut text, 0)
    }

    fn push_comment(&self, text: &mut String, what: &str) {
        text.push_str(&self.comment.fill(|_| one_line(what)));
        text.push('\n');
    }

    /// A value for each axis, in the units of the dialect.
    fn values(&self, motion_export: &MotionExport<'_>, values: &[f64]) -> String {
        let axes = motion_export.cell.robot.axes.iter().zip(values).enumerate();
        let values = axes.map(|(k, (axis, &value))| {
            let value = match axis.kind {
                AxisKind::Linear => self.length.from_meters(value),
                AxisKind::Rotary => self.angle.from_radians(value),
            };
            self.axis.fill(|name| match name {
                "name" => axis.name.clone(),
                "value" => fixed(value, self.decimals),
                _ => (k + 1).to_string(),
            })
        });
        values.collect::<Vec<_>>().join(&self.between)
    }

    fn time(&self, time: f64) -> String {
        fixed(time, self.time_decimals)
    }

    /// The difference of two rounded times.
    fn duration(&self, start: f64, end: f64) -> String {
        let unit = 10_f64.powi(i32::try_from(self.time_decimals).unwrap_or(0));
        fixed(((end * unit).round() - (start * unit).round()) / unit, self.time_decimals)
    }
}

fn push(text: &mut String, lines: &[Template], value: impl Fn(&str) -> String) {
    for line in lines {
        text.push_str(&line.fill(&value));
        text.push('\n');
    }
}

/// A number with fixed decimals, and no minus sign before zero.
fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let zero = text.chars().all(|letter| matches!(letter, '-' | '0' | '.'));
    if zero { text.replace('-', "") } else { text }
}

/// A quoted text in one line.
fn one_line(text: &str) -> String {
    text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}
