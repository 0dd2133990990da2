//! Slowdown of segments on which a wafer would slip.

use super::segment::Segment;
use crate::program::Step;
use crate::robot::{AxesMotion, EffectorId};
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
const TARGET_UTILIZATION: f64 = 0.99;
/// Largest time scale: a wafer that slips even at this speed slips because its effector is tilted.
const MAX_TIME_SCALE: f64 = 16.0;

/// The segment, slowed so that no wafer slips; unchanged where no speed prevents slip.
///
/// Accelerations are inversely proportional to the square of the time scale; gravity along a tilted wafer is not, so that two or three iterations are needed.
pub(super) fn slowed_for_slip(cell: &Cell, step: &Step, segment: Segment) -> Segment {
    let largest = |segment: &Segment, intervals: usize| -> f64 {
        let peaks = step.loaded.iter().map(|&id| peak(cell, step, segment, id, intervals));
        peaks.fold(0.0, f64::max)
    };
    if largest(&segment, COARSE_INTERVALS) < FINE_SAMPLING_THRESHOLD {
        return segment;
    }
    let mut time_scale = 1.0;
    while time_scale <= MAX_TIME_SCALE {
        let slowed = if time_scale > 1.0 { segment.slowed(time_scale) } else { segment.clone() };
        let found = largest(&slowed, FINE_INTERVALS);
        if found <= MAX_UTILIZATION {
            return slowed;
        }
        time_scale *= (found / TARGET_UTILIZATION).sqrt().min(2.0);
    }
    segment
}

/// Largest utilization of friction of a held wafer at uniform samples of a segment.
fn peak(cell: &Cell, step: &Step, segment: &Segment, id: EffectorId, intervals: usize) -> f64 {
    let times = (0..=intervals).map(|k| segment.duration() * k as f64 / intervals as f64);
    times.map(|time| utilization(cell, step, segment, id, time)).fold(0.0, f64::max)
}

/// Utilization of friction of a held wafer at a time since the start of a segment (s); 0 where the motion is unknown, which the check reports.
pub(super) fn utilization(
    cell: &Cell,
    step: &Step,
    segment: &Segment,
    id: EffectorId,
    time: f64,
) -> f64 {
    let states: Vec<_> = (0..step.from.len()).map(|axis| segment.state(step, axis, time)).collect();
    let [positions, velocities, accelerations] =
        [0, 1, 2].map(|order| states.iter().map(|state| state[order]).collect::<Vec<f64>>());
    let motion = AxesMotion {
        positions: &positions,
        velocities: &velocities,
        accelerations: &accelerations,
    };
    cell.friction_demand(id, &motion).map_or(0.0, |margin| margin.utilization())
}
