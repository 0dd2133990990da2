//! Successive moves run into each other, so that the axes do not come to rest between them.

use super::Way;
use super::limits::dynamics;
use crate::cell::Cell;
use crate::program::{Phase, Step};
use crate::robot::{EffectorId, HybridRobot};

/// How a step runs into the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    /// How long both run at the same time [s].
    pub overlap: f64,
    /// Largest distance of a wafer's centre from the way without blending, at most [m].
    pub deviation: f64,
}

/// Halvings by which the longest overlap is found.
const HALVINGS: usize = 12;
/// Times within an overlap that are held against limits and radius.
const PROBES: usize = 60;
/// Slack left below each limit for what lies between the probes, as a share.
const SLACK: f64 = 5e-3;

/// The longest overlap of two steps that keeps every limit of both and stays within a radius of the way without it; `None` where they are not to be blended.
///
/// ```text
///    q(t)  =  q_1(t) + q_2(t) − corner
/// ```
/// Only moves of the axes run into each other: at a handover, in a slot and along a line the way matters.
pub(super) fn blend(cell: &Cell, steps: [&Step; 2], ways: [&Way; 2], radius: f64) -> Option<Blend> {
    let free = |step: &Step| {
        step.handover.is_none()
            && step.slot.is_none()
            && !matches!(step.phase, Phase::Lift | Phase::Lower | Phase::Wait)
    };
    let [Way::Axes(_), Way::Axes(_)] = ways else { return None };
    if radius <= 0.0 || !free(steps[0]) || !free(steps[1]) || steps[0].loaded != steps[1].loaded {
        return None;
    }
    let most = 0.5 * ways[0].duration().min(ways[1].duration());
    let effectors: Vec<EffectorId> = cell.robot.effectors().collect();
    let fits = |overlap: f64| fits(cell, steps, ways, &effectors, overlap, radius);
    let (mut low, mut high) = (0.0, most);
    let mut deviation = 0.0;
    if let Some(found) = fits(most) {
        (low, deviation) = (most, found);
    } else {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match fits(middle) {
                Some(found) => (low, deviation) = (middle, found),
                None => high = middle,
            }
        }
    }
    (low > 0.0).then_some(Blend { overlap: low, deviation })
}

/// How far wafers' centres stray with an overlap; `None` where a limit or the radius is exceeded.
fn fits(
    cell: &Cell,
    steps: [&Step; 2],
    ways: [&Way; 2],
    effectors: &[EffectorId],
    overlap: f64,
    radius: f64,
) -> Option<f64> {
    let robot: &HybridRobot = &cell.robot;
    let begin = ways[0].duration() - overlap;
    let count = robot.axes.len();
    let corner = &steps[0].to;
    let limits: Vec<_> = (0..count)
        .map(|axis| [dynamics(robot, axis, steps[0]), dynamics(robot, axis, steps[1])])
        .collect();
    let mut deviation = 0.0_f64;
    for probe in 1..PROBES {
        let since = overlap * probe as f64 / PROBES as f64;
        let mut positions = [corner.clone(), corner.clone(), corner.clone()];
        for axis in 0..count {
            let first = ways[0].state(steps[0], axis, begin + since);
            let second = ways[1].state(steps[1], axis, since);
            positions[0][axis] = first[0];
            positions[1][axis] = second[0];
            positions[2][axis] = first[0] + second[0] - corner[axis];
            for limits in &limits[axis] {
                let most = [limits.velocity, limits.acceleration, limits.jerk];
                for (order, most) in most.iter().enumerate() {
                    if (first[order + 1] + second[order + 1]).abs() > (1.0 - SLACK) * most {
                        // Where one of them stands, the other is within its own limits.
                        if first[order + 1] != 0.0 && second[order + 1] != 0.0 {
                            return None;
                        }
                    }
                }
            }
        }
        for &id in effectors {
            let center = |positions: &[f64]| {
                cell.robot.effector_pose(positions, id).ok().map(|pose| pose.translation.vector)
            };
            let blended = center(&positions[2])?;
            let off = (blended - center(&positions[0])?)
                .norm()
                .min((blended - center(&positions[1])?).norm());
            deviation = deviation.max(off);
        }
        if deviation > radius {
            return None;
        }
    }
    Some(deviation)
}
