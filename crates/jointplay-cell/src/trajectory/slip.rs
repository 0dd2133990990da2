//! Segments on which no wafer slips: slower than the limits of the axes allow.

use super::segment_motion::SegmentMotion;
use crate::program::Step;
use crate::robot::{AxesMotion, EffectorId, MAX_AXES};
use crate::workcell::Cell;

/// Number of uniform intervals of the first, coarse sampling of a segment.
const COARSE_INTERVALS: usize = 48;
/// Utilization of friction in the coarse sampling below which there is no fine sampling.
const FINE_SAMPLING_THRESHOLD: f64 = 0.8;
/// Number of uniform intervals of the fine sampling.
const FINE_INTERVALS: usize = 480;
/// Largest admissible utilization of friction in the fine sampling: the margin to 1 covers the times between samples.
const MAX_UTILIZATION: f64 = 0.999;
/// Utilization of friction for which a slowed segment is planned.
const TARGET_UTILIZATION: f64 = 0.997;
/// Utilization of friction at the collocation points of a search: the margin covers the places between them.
const CONSTRAINED_UTILIZATION: f64 = 0.99;
/// Largest time scale: a wafer that slips even at this speed slips because its effector is tilted.
const MAX_TIME_SCALE: f64 = 16.0;

/// The segment such that no wafer slips; unchanged where no speed prevents slip.
///
/// # Arguments
/// * `search` – a segment whose parameterization keeps the constraints of friction nearly: it is slow only where they bind, and not everywhere
pub(super) fn without_slip(
    cell: &Cell,
    step: &Step,
    motion: SegmentMotion,
    search: impl FnOnce() -> Option<SegmentMotion>,
) -> SegmentMotion {
    if peak(cell, step, &motion, uniform(&motion, COARSE_INTERVALS)) < FINE_SAMPLING_THRESHOLD {
        return motion;
    }
    match slowed(cell, step, &motion) {
        None => motion,
        Some(kept) if kept.duration() == motion.duration() => kept,
        Some(slow) => match search().and_then(|found| slowed(cell, step, &found)) {
            Some(found) if found.duration() < slow.duration() => found,
            _ => slow,
        },
    }
}

/// A segment, slowed as a whole until no wafer slips; `None` where no speed prevents slip.
///
/// Accelerations are inversely proportional to the square of the time scale; gravity along a tilted wafer is not, so that two or three iterations are needed.
fn slowed(cell: &Cell, step: &Step, motion: &SegmentMotion) -> Option<SegmentMotion> {
    let mut time_scale = 1.0;
    while time_scale <= MAX_TIME_SCALE {
        let slowed = if time_scale > 1.0 { motion.slowed(time_scale) } else { motion.clone() };
        // Accelerations have their peaks where the jerk is discontinuous.
        let times = uniform(&slowed, FINE_INTERVALS).chain(slowed.jerk_discontinuities());
        let found = peak(cell, step, &slowed, times);
        if found <= MAX_UTILIZATION {
            return Some(slowed);
        }
        time_scale *= (found / TARGET_UTILIZATION).sqrt().min(2.0);
    }
    None
}

/// Constraints of the friction of all held wafers at a place of a path; `None` where a wafer slips at rest, or its pose is unknown.
pub(super) fn friction_constraints(
    cell: &Cell,
    step: &Step,
    path: &AxesMotion<'_>,
) -> Option<Vec<[f64; 2]>> {
    let mut all = Vec::new();
    for &id in &step.loaded {
        all.extend(cell.friction_constraints(id, path, CONSTRAINED_UTILIZATION).ok()??);
    }
    Some(all)
}

/// Uniform times in a segment, from its start to its end (s).
fn uniform(motion: &SegmentMotion, intervals: usize) -> impl Iterator<Item = f64> + use<> {
    let duration = motion.duration();
    (0..=intervals).map(move |k| duration * k as f64 / intervals as f64)
}

/// Largest utilization of friction of the held wafers at times since the start of a segment (s).
fn peak(cell: &Cell, step: &Step, motion: &SegmentMotion, times: impl Iterator<Item = f64>) -> f64 {
    let samples = times.flat_map(|time| step.loaded.iter().map(move |&id| (id, time)));
    samples.map(|(id, time)| utilization(cell, step, motion, id, time)).fold(0.0, f64::max)
}

/// Utilization of friction of a held wafer at a time since the start of a segment (s); 0 where the motion is unknown, which the check reports.
pub(super) fn utilization(
    cell: &Cell,
    step: &Step,
    motion: &SegmentMotion,
    id: EffectorId,
    time: f64,
) -> f64 {
    let mut columns = [[0.0; MAX_AXES]; 3];
    for (axis, state) in motion.states(step, time).enumerate() {
        for (column, value) in columns.iter_mut().zip(state) {
            column[axis] = value;
        }
    }
    let [positions, velocities, accelerations] =
        columns.each_ref().map(|column| &column[..step.from.len()]);
    let motion = AxesMotion { positions, velocities, accelerations };
    cell.friction_demand(id, &motion).map_or(0.0, |margin| margin.utilization())
}
