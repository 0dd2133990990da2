//! Report on the segments of an instruction.

use std::ops::Range;

use jointplay_cell::program::Path;
use jointplay_cell::trajectory::{LimitingConstraint, MotionLimit, Trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_format::program::phase_name;
use serde::Serialize;

/// A segment that moves.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SegmentReport {
    /// Phase of the instruction, such as `extend`.
    pub phase: &'static str,
    /// `line` or `joint`: a straight line of the wafer, or a joint move.
    pub path: &'static str,
    /// Start time.
    pub start_s: f64,
    /// Duration.
    pub duration_s: f64,
    /// Whether it is blended with the segment before or after it.
    pub blended: bool,
    /// What determines the duration; none where limits are reached for less than 1 % of it, as in segments that are slower for a longer blend.
    pub limited_by: Option<LimitingReport>,
}

/// The limit that determines the duration of a segment.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct LimitingReport {
    /// `speed`, `acceleration`, `jerk`, `line speed` or `slip`.
    pub limit: &'static str,
    /// Name of the axis or effector; none for the speed of a line.
    pub name: Option<String>,
    /// Share of the segment's duration in which the limit is reached.
    pub time_share: f64,
    /// Share of the path at which the limit is reached first.
    pub from_share: f64,
    /// Share of the path at which the limit is reached last.
    pub to_share: f64,
}

/// Reports the segments of steps that move.
pub(crate) fn segments(
    cell: &Cell,
    motion: &Trajectory,
    constraints: &[Option<LimitingConstraint>],
    steps: Range<usize>,
) -> Vec<SegmentReport> {
    let moving = steps.filter(|&step| !motion.is_dwell(step));
    let report = |step: usize| SegmentReport {
        phase: phase_name(motion.steps[step].phase),
        path: if matches!(motion.steps[step].path, Path::Line(_)) { "line" } else { "joint" },
        start_s: motion.times[step],
        duration_s: motion.step_duration(step),
        blended: [step.checked_sub(1), Some(step)]
            .into_iter()
            .flatten()
            .any(|first| motion.blend(first).is_some()),
        limited_by: constraints[step].map(|one| limiting(cell, &one)),
    };
    moving.map(report).collect()
}

fn limiting(cell: &Cell, constraint: &LimitingConstraint) -> LimitingReport {
    let axis = |axis: usize| Some(cell.robot.axes[axis].name.clone());
    let (limit, name) = match constraint.limit {
        MotionLimit::Velocity(index) => ("speed", axis(index)),
        MotionLimit::Acceleration(index) => ("acceleration", axis(index)),
        MotionLimit::Jerk(index) => ("jerk", axis(index)),
        MotionLimit::LineSpeed => ("line speed", None),
        MotionLimit::Friction(id) => {
            ("slip", Some(cell.robot.arms[id.arm].effectors[id.effector].name.clone()))
        }
    };
    let LimitingConstraint { time_fraction: time_share, path_fractions, .. } = *constraint;
    let [from_share, to_share] = path_fractions;
    LimitingReport { limit, name, time_share, from_share, to_share }
}
