//! Slowdown of segments on which a wafer would slip.

use super::segment::Segment;
use crate::program::Step;
use crate::robot::{AxesMotion, EffectorId};
use crate::workcell::Cell;

/// Number of equal intervals of a segment at whose ends the friction is evaluated first.
const COARSE: usize = 48;
/// Utilization of friction at these times below which the segment is not sampled more finely.
const NEAR: f64 = 0.8;
/// Number of equal intervals of the finer sampling.
const FINE: usize = 480;
/// Largest utilization of friction at these times: the share that is left covers the times between them.
const ALLOWED: f64 = 0.999;
/// Utilization of friction that a slowed segment is planned to.
const TARGET: f64 = 0.99;
/// Largest factor of time: a wafer that slips even at this speed slips by the tilt of its effector.
const SLOWEST: f64 = 16.0;

/// The segment, slowed so that no wafer slips on it; unchanged where no speed would prevent it.
///
/// Accelerations fall with the square of the factor of time, so that two or three iterations suffice; gravity along a tilted wafer makes it more than one.
pub(super) fn slowed_for_slip(cell: &Cell, step: &Step, segment: Segment) -> Segment {
    let utilization = |segment: &Segment, intervals: usize| -> f64 {
        let each = step.loaded.iter().map(|&id| peak(cell, step, segment, id, intervals));
        each.fold(0.0, f64::max)
    };
    if utilization(&segment, COARSE) < NEAR {
        return segment;
    }
    let mut factor = 1.0;
    while factor <= SLOWEST {
        let slowed = if factor > 1.0 { segment.slowed(factor) } else { segment.clone() };
        let now = utilization(&slowed, FINE);
        if now <= ALLOWED {
            return slowed;
        }
        factor *= (now / TARGET).sqrt().min(2.0);
    }
    segment
}

/// Largest utilization of friction of a held wafer at equal times of a segment; times at which the motion is unknown are left to the check of the trajectory.
fn peak(cell: &Cell, step: &Step, segment: &Segment, id: EffectorId, intervals: usize) -> f64 {
    let mut peak = 0.0_f64;
    let count = step.from.len();
    for k in 0..=intervals {
        let time = segment.duration() * k as f64 / intervals as f64;
        let states: Vec<_> = (0..count).map(|axis| segment.state(step, axis, time)).collect();
        let [positions, velocities, accelerations] =
            [0, 1, 2].map(|order| states.iter().map(|state| state[order]).collect::<Vec<f64>>());
        let motion = AxesMotion {
            positions: &positions,
            velocities: &velocities,
            accelerations: &accelerations,
        };
        if let Ok(margin) = cell.friction_margin(id, &motion) {
            peak = peak.max(margin.utilization());
        }
    }
    peak
}
