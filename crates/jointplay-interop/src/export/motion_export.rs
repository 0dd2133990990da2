//! A motion to export.

use jointplay_cell::robot::EffectorId;
use jointplay_cell::trajectory::Trajectory;
use jointplay_cell::workcell::Cell;

use super::error::Error;
use super::violation_note::ViolationNote;

/// The most samples that one export may have: a day at 1 kHz is less.
pub const MOST_SAMPLES: f64 = 1e8;

/// A motion with all that is told of it.
#[derive(Debug, Clone, Copy)]
pub struct MotionExport<'a> {
    /// What moves, and among what.
    pub cell: &'a Cell,
    /// How it moves.
    pub motion: &'a Trajectory,
    /// Text of the program, of which lines are quoted; empty for none.
    pub program: &'a str,
    /// What is wrong with the motion; empty where nothing is.
    pub violation_notes: &'a [ViolationNote],
}

impl MotionExport<'_> {
    /// Why nothing of this should be run: one line; `None` where nothing is wrong.
    #[must_use]
    pub fn warning(&self) -> Option<String> {
        let first = self.violation_notes.first()?;
        let count = self.violation_notes.len();
        let what = if count == 1 { "violation" } else { "violations" };
        Some(format!("NOT SAFE TO RUN: {count} {what}, the first: {}", first.message))
    }

    /// The line of the program that a step comes from, as it is written.
    pub(crate) fn line(&self, step: usize) -> &str {
        let line = self.motion.steps.get(step).map_or(0, |step| step.place.line);
        self.program.lines().nth(line.wrapping_sub(1)).map_or("", str::trim)
    }

    pub(crate) fn effector_name(&self, id: EffectorId) -> &str {
        &self.cell.robot.arms[id.arm].effectors[id.effector].name
    }

    /// Whether there can be so many samples a second.
    pub(crate) fn check_rate(&self, rate: f64) -> Result<(), Error> {
        let samples = self.motion.duration() * rate;
        if !(rate.is_finite() && rate > 0.0) {
            return Err(Error::Rate { rate });
        }
        if samples > MOST_SAMPLES {
            return Err(Error::TooManySamples { found: samples, allowed: MOST_SAMPLES });
        }
        Ok(())
    }
}
