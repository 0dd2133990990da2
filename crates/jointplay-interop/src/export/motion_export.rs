//! A motion to export.

use jointplay_cell::robot::EffectorId;
use jointplay_cell::trajectory::Trajectory;
use jointplay_cell::workcell::Cell;

use super::error::Error;
use super::violation_note::ViolationNote;

/// Largest number of samples of an export; a day at 1 kHz has fewer.
pub const MOST_SAMPLES: f64 = 1e8;

/// A motion with its cell, program and violations.
#[derive(Debug, Clone, Copy)]
pub struct MotionExport<'a> {
    /// The cell that moves.
    pub cell: &'a Cell,
    /// The trajectory.
    pub motion: &'a Trajectory,
    /// Text of the program, from which lines are quoted; may be empty.
    pub program: &'a str,
    /// Violations of the motion.
    pub violation_notes: &'a [ViolationNote],
}

impl MotionExport<'_> {
    /// A warning in one line against execution of the motion; `None` without violations.
    #[must_use]
    pub fn warning(&self) -> Option<String> {
        let first = self.violation_notes.first()?;
        let count = self.violation_notes.len();
        let what = if count == 1 { "violation" } else { "violations" };
        Some(format!("NOT SAFE TO RUN: {count} {what}, the first: {}", first.message))
    }

    /// The end of the names of its files, without the extension: a warning against execution, or nothing without violations.
    #[must_use]
    pub fn name_warning(&self) -> &'static str {
        if self.violation_notes.is_empty() { "" } else { "-not-safe-to-run" }
    }

    /// The program line of a step.
    pub(crate) fn line(&self, step: usize) -> &str {
        let line = self.motion.steps.get(step).map_or(0, |step| step.place.line);
        self.program.lines().nth(line.wrapping_sub(1)).map_or("", str::trim)
    }

    pub(crate) fn effector_name(&self, id: EffectorId) -> &str {
        &self.cell.robot.arms[id.arm].effectors[id.effector].name
    }

    /// Checks that the sampling rate is positive and the number of samples of the motion allowed.
    pub(crate) fn check_rate(&self, rate: f64) -> Result<(), Error> {
        self.check_samples(rate, self.motion.duration())
    }

    /// Checks that the sampling rate is positive and the number of samples of a duration (s) allowed.
    pub(crate) fn check_samples(&self, rate: f64, duration: f64) -> Result<(), Error> {
        let samples = duration * rate;
        if !(rate.is_finite() && rate > 0.0) {
            return Err(Error::Rate { rate });
        }
        if samples > MOST_SAMPLES {
            return Err(Error::TooManySamples { found: samples, allowed: MOST_SAMPLES });
        }
        Ok(())
    }
}
