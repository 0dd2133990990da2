//! Successive moves run into each other, so that the axes do not come to rest between them.

use super::Way;
use super::cubic::State;
use super::limits::dynamics;
use crate::cell::Cell;
use crate::program::{Phase, Step};
use crate::robot::{Dynamics, EffectorId};

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
/// Times within an overlap that are held against limits and radius, beside those at which a jerk changes.
const PROBES: usize = 60;
/// Slack left below each limit for what lies between the probes, as a share.
const SLACK: f64 = 5e-3;
/// The same where only one of both moves, which has its limits as they are.
const ROUND_OFF: f64 = 1e-12;

/// The longest overlap of two steps that keeps every limit and stays within the radius of both of the way without it; `None` where they are not to be blended.
///
/// ```text
///    q(t)  =  q_1(t) + q_2(t) − corner
/// ```
/// Where a wafer changes hands, and up and down in a slot, the robot comes to rest.
pub(super) fn blend(cell: &Cell, steps: [&Step; 2], ways: [&Way; 2]) -> Option<Blend> {
    let radius = steps[0].blend.min(steps[1].blend);
    let runs_on = |step: &Step, way: &Way| {
        step.handover.is_none()
            && !matches!(step.phase, Phase::Lift | Phase::Lower | Phase::Wait)
            && !matches!(way, Way::Still { .. })
    };
    if radius <= 0.0
        || !runs_on(steps[0], ways[0])
        || !runs_on(steps[1], ways[1])
        || steps[0].loaded != steps[1].loaded
    {
        return None;
    }
    let corner = Corner {
        cell,
        steps,
        ways,
        radius,
        limits: steps.map(|step| {
            (0..cell.robot.axes.len()).map(|axis| dynamics(&cell.robot, axis, step)).collect()
        }),
        effectors: cell.robot.effectors().collect(),
    };
    let most = 0.5 * ways[0].duration().min(ways[1].duration());
    if let Some(deviation) = corner.strays(most) {
        return Some(Blend { overlap: most, deviation });
    }
    let (mut low, mut high, mut deviation) = (0.0, most, 0.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match corner.strays(middle) {
            Some(found) => (low, deviation) = (middle, found),
            None => high = middle,
        }
    }
    (low > 0.0).then_some(Blend { overlap: low, deviation })
}

/// Two steps where they meet.
struct Corner<'a> {
    cell: &'a Cell,
    steps: [&'a Step; 2],
    ways: [&'a Way; 2],
    radius: f64,
    /// Of each axis in either step.
    limits: [Vec<Dynamics>; 2],
    effectors: Vec<EffectorId>,
}

impl Corner<'_> {
    /// How far wafers' centres stray with an overlap; `None` where a limit or the radius is exceeded.
    fn strays(&self, overlap: f64) -> Option<f64> {
        let at = &self.steps[1].from;
        let mut positions = [at.clone(), at.clone(), at.clone()];
        let mut deviation = 0.0_f64;
        for since in self.times(overlap) {
            // Half of the overlap belongs to either step, and is held against its limits.
            let owner = usize::from(since >= 0.5 * overlap);
            for (axis, corner) in at.iter().enumerate() {
                let states = self.states(axis, overlap, since);
                if !within(&self.limits[owner][axis], states, owner) {
                    return None;
                }
                let [first, second] = states.map(|state| state[0]);
                positions[0][axis] = first;
                positions[1][axis] = second;
                positions[2][axis] = first + second - corner;
            }
            for &id in &self.effectors {
                let center = |positions: &[f64]| {
                    let pose = self.cell.robot.effector_pose(positions, id).ok()?;
                    Some(pose.translation.vector)
                };
                let blended = center(&positions[2])?;
                let [first, second] = [center(&positions[0])?, center(&positions[1])?];
                deviation = deviation.max((blended - first).norm().min((blended - second).norm()));
            }
            if deviation > self.radius {
                return None;
            }
        }
        Some(deviation)
    }

    /// Times of an overlap to look at, from its start [s].
    fn times(&self, overlap: f64) -> Vec<f64> {
        let begin = self.ways[0].duration() - overlap;
        let mut times: Vec<f64> =
            (0..PROBES).map(|probe| overlap * probe as f64 / PROBES as f64).collect();
        times.extend(self.ways[0].breaks().iter().map(|time| time - begin));
        times.extend(self.ways[1].breaks());
        times.retain(|time| (0.0..overlap).contains(time));
        times
    }

    fn states(&self, axis: usize, overlap: f64, since: f64) -> [State; 2] {
        let begin = self.ways[0].duration() - overlap;
        let [first, second] = self.steps;
        [
            self.ways[0].state(first, axis, begin + since),
            self.ways[1].state(second, axis, since),
        ]
    }
}

/// Whether two motions at once keep to the limits of one of them.
fn within(limits: &Dynamics, states: [State; 2], owner: usize) -> bool {
    let most = [limits.velocity, limits.acceleration, limits.jerk];
    most.iter().zip(1..).all(|(most, order)| {
        let [own, other] = [owner, 1 - owner].map(|which| states[which][order]);
        // What one does alone was planned for, by the owner for these limits.
        let slack = if own == 0.0 { -ROUND_OFF } else { SLACK };
        other == 0.0 || (own + other).abs() <= (1.0 - slack) * most
    })
}
