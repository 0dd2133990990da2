//! A cell's motion for other programs, as text or bytes.
//!
//! | to… | use | units |
//! | --- | --- | --- |
//! | a spreadsheet or a data frame | [`samples`](fn@samples), then [`crate::table::csv`] or [`crate::table::parquet`] | mm, degrees, in the names of the columns |
//! | a viewer that shows a part of a long motion | [`Timeline`]: windows of steps, each by itself | m, rad |
//! | a 3D viewer | [`gltf`](fn@gltf): one binary file with an animation | m, y up |
//! | Foxglove, PlotJuggler or ROS 2 | `mcap::write`: JointState, JointTrajectory and transforms | m, rad |
//! | SolidWorks | [`solidworks`](fn@solidworks): a file for each motor, and a macro that loads them | mm, degrees |
//! | a controller | [`dialect::Dialect`]: lines from templates | those of the dialect |
//!
//! Each begins at 0 and ends at the very duration of the motion.
//! What is wrong with the motion is told in each of them.

mod channel;
pub mod dialect;
mod error;
mod gltf;
#[cfg(feature = "mcap")]
pub mod mcap;
mod peaks;
mod samples;
mod scene;
mod segment;
mod solidworks;
mod timeline;

use jointplay_cell::robot::EffectorId;
use jointplay_cell::trajectory::Trajectory;
use jointplay_cell::workcell::Cell;

pub use error::Error;
pub use gltf::gltf;
pub use samples::{samples, samples_in_parts, samples_with_peaks, samples_within, tracks};
pub use scene::{Frame, frames};
pub use solidworks::{MACRO, loader, motor, motors, solidworks, solidworks_names};
pub use timeline::{Envelope, HeldAt, Timeline, Window, wafers_at_start};

/// The most samples that one export may have: a day at 1 kHz is less.
pub const MOST_SAMPLES: f64 = 1e8;

/// A motion with all that is told of it.
#[derive(Debug, Clone, Copy)]
pub struct Recording<'a> {
    /// What moves, and among what.
    pub cell: &'a Cell,
    /// How it moves.
    pub motion: &'a Trajectory,
    /// Text of the program, of which lines are quoted; empty for none.
    pub program: &'a str,
    /// What is wrong with the motion; empty where nothing is.
    pub flaws: &'a [Flaw],
}

/// Something that is wrong with a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Flaw {
    /// From when on [s].
    pub from: f64,
    /// Until when [s].
    pub to: f64,
    /// What it is.
    pub message: String,
}

impl Recording<'_> {
    /// Why nothing of this should be run: one line; `None` where nothing is wrong.
    #[must_use]
    pub fn warning(&self) -> Option<String> {
        let first = self.flaws.first()?;
        let count = self.flaws.len();
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
    fn check_rate(&self, rate: f64) -> Result<(), Error> {
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
