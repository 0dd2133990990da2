//! Successive moves run into each other, so that the axes do not come to rest between them.

use std::convert::Infallible;
use std::sync::Arc;

use super::Way;
use super::cubic::State;
use super::limits::dynamics;
use super::plan::key;
use crate::cell::Cell;
use crate::memory::{Kept, Key, extend};
use crate::program::{Phase, Step};
use crate::robot::{AxesMotion, Dynamics, EffectorId};

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
/// Even stretches of an overlap, an even number, that are held against limits and radius, beside those between jumps of a jerk.
const PROBES: usize = 30;
/// How much of the time to a jump has passed just before it.
const BEFORE: f64 = 1.0 - 1e-6;
/// Slack left below each limit for what lies between the probes, as a share.
const SLACK: f64 = 5e-3;
/// The same where only one of both moves, which has its limits as they are.
const ROUND_OFF: f64 = 1e-12;

/// How much slower two steps may be so that they run into each other for longer: where both keep an axis busy, its limits leave room only so.
const SLOWER: [f64; 5] = [1.0, 1.01, 1.03, 1.08, 1.2];

/// How the steps of the last motion run into each other, by what that depends on.
#[derive(Default)]
pub(super) struct Blends {
    /// By how much the steps at a corner are slowed.
    slower: Kept<f64>,
    slowed: Kept<Way>,
    blends: Kept<Option<Blend>>,
}

impl Blends {
    pub(super) fn begin(&mut self, shared: &str) {
        self.slower.begin(shared);
        self.slowed.begin(shared);
        self.blends.begin(shared);
    }

    pub(super) fn end(&mut self) {
        self.slower.end();
        self.slowed.end();
        self.blends.end();
    }

    /// Slows the steps that then gain more by running into each other; by how much each.
    pub(super) fn slow(&mut self, cell: &Cell, steps: &[Step], ways: &mut [Arc<Way>]) -> Vec<f64> {
        let mut factors = vec![1.0_f64; steps.len()];
        let mut meets = vec![false; steps.len()];
        for (before, pair) in steps.windows(2).enumerate() {
            let two = [&pair[0], &pair[1]];
            let Some(corner) = Corner::new(cell, two, [&ways[before], &ways[before + 1]]) else {
                continue;
            };
            meets[before] = true;
            let key = corner_key(two, [1.0; 2]);
            let Ok(factor) = self.slower.get::<Infallible>(key, || Ok(corner.slower()));
            for factor_of in &mut factors[before..before + 2] {
                *factor_of = factor_of.max(*factor);
            }
        }
        // Each corner gains by its own factor; whether all do together is seen from rest to rest.
        let mut start = 0;
        for (end, runs_on) in meets.into_iter().enumerate() {
            if runs_on {
                continue;
            }
            let run = start..end + 1;
            start = run.end;
            if factors[run.clone()].iter().all(|&factor| factor == 1.0) {
                continue;
            }
            let slowed: Vec<Arc<Way>> =
                run.clone().map(|k| self.slowed(&steps[k], &ways[k], factors[k])).collect();
            let (steps, plain) = (&steps[run.clone()], vec![1.0; run.len()]);
            let fast = self.duration(cell, steps, &ways[run.clone()], &plain);
            if self.duration(cell, steps, &slowed, &factors[run.clone()]) < fast {
                ways[run].clone_from_slice(&slowed);
            } else {
                factors[run].fill(1.0);
            }
        }
        factors
    }

    fn slowed(&mut self, step: &Step, way: &Arc<Way>, factor: f64) -> Arc<Way> {
        if factor == 1.0 {
            return Arc::clone(way);
        }
        let mut key = key(step);
        extend(&mut key, &[factor]);
        let Ok(slowed) = self.slowed.get::<Infallible>(key, || Ok(way.slowed(factor)));
        slowed
    }

    /// How long steps take that run into each other [s].
    fn duration(&mut self, cell: &Cell, steps: &[Step], ways: &[Arc<Way>], factors: &[f64]) -> f64 {
        let corners = 0..steps.len() - 1;
        let blends: Vec<Option<Blend>> =
            corners.map(|before| self.at(cell, steps, ways, factors, before)).collect();
        let overlaps: f64 = blends.iter().flatten().map(|blend| blend.overlap).sum();
        ways.iter().map(|way| way.duration()).sum::<f64>() - overlaps
    }

    /// How a step runs into the next.
    pub(super) fn at(
        &mut self,
        cell: &Cell,
        steps: &[Step],
        ways: &[Arc<Way>],
        factors: &[f64],
        before: usize,
    ) -> Option<Blend> {
        let two = [&steps[before], &steps[before + 1]];
        let corner = Corner::new(cell, two, [&ways[before], &ways[before + 1]])?;
        let key = corner_key(two, [factors[before], factors[before + 1]]);
        let Ok(blend) = self.blends.get::<Infallible>(key, || Ok(corner.blend()));
        *blend
    }
}

/// What two steps, slowed by so much, come to at the corner where they meet.
fn corner_key(steps: [&Step; 2], factors: [f64; 2]) -> Key {
    let mut corner = key(steps[0]);
    corner.extend(key(steps[1]));
    extend(&mut corner, &factors);
    extend(&mut corner, &steps.map(|step| step.blend));
    corner
}

/// Two steps where they meet.
pub(super) struct Corner<'a> {
    cell: &'a Cell,
    steps: [&'a Step; 2],
    ways: [&'a Way; 2],
    /// How far a wafer may stray [m].
    radius: f64,
    /// Of each axis in either step.
    limits: [Vec<Dynamics>; 2],
    effectors: Vec<EffectorId>,
}

impl<'a> Corner<'a> {
    /// `None` where two steps are not to be blended: where a wafer changes hands, and up and down in a slot, the robot comes to rest.
    pub(super) fn new(cell: &'a Cell, steps: [&'a Step; 2], ways: [&'a Way; 2]) -> Option<Self> {
        let radius = steps[0].blend.min(steps[1].blend);
        let runs_on = |step: &Step, way: &Way| {
            step.handover.is_none()
                && !matches!(step.phase, Phase::Lift | Phase::Lower | Phase::Wait)
                && !matches!(way, Way::Still { .. })
        };
        let both = runs_on(steps[0], ways[0]) && runs_on(steps[1], ways[1]);
        if !(both && radius > 0.0 && steps[0].loaded == steps[1].loaded) {
            return None;
        }
        let axes = 0..cell.robot.axes.len();
        let limits =
            steps.map(|step| axes.clone().map(|axis| dynamics(&cell.robot, axis, step)).collect());
        let effectors = cell.robot.effectors().collect();
        Some(Self { cell, steps, ways, radius, limits, effectors })
    }

    /// By how much to slow both steps: so that what the overlap saves is more than what that costs.
    pub(super) fn slower(&self) -> f64 {
        let both: f64 = self.ways.iter().map(|way| way.duration()).sum();
        let saves = |factor: f64| {
            let ways = self.ways.map(|way| way.slowed(factor));
            let blend = self.at_pace([&ways[0], &ways[1]]);
            blend.map_or(0.0, |blend| blend.overlap) - (factor - 1.0) * both
        };
        let all = SLOWER.map(|factor| (factor, saves(factor)));
        let better = |best: (f64, f64), one: (f64, f64)| if one.1 > best.1 { one } else { best };
        all.into_iter().fold((1.0, 0.0), better).0
    }

    /// The longest overlap that keeps every limit, lets no wafer slip that would not without it, and stays within the radius of the way without it.
    ///
    /// ```text
    ///    q(t)  =  q_1(t) + q_2(t) − corner
    /// ```
    pub(super) fn blend(&self) -> Option<Blend> {
        self.at_pace(self.ways)
    }

    /// The same with other ways, which differ in their pace alone.
    fn at_pace(&self, ways: [&Way; 2]) -> Option<Blend> {
        let two = Two { corner: self, ways, breaks: ways.map(Way::breaks) };
        let most = 0.5 * ways[0].duration().min(ways[1].duration());
        if let Some(deviation) = two.stray(most) {
            return Some(Blend { overlap: most, deviation });
        }
        let (mut low, mut high, mut deviation) = (0.0, most, 0.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match two.stray(middle) {
                Some(found) => (low, deviation) = (middle, found),
                None => high = middle,
            }
        }
        (low > 0.0).then_some(Blend { overlap: low, deviation })
    }
}

/// Two motions at a corner.
struct Two<'c> {
    corner: &'c Corner<'c>,
    ways: [&'c Way; 2],
    /// Times after the start of either at which a jerk jumps [s].
    breaks: [Vec<f64>; 2],
}

impl Two<'_> {
    /// How far wafers' centres stray with an overlap; `None` where a limit or the radius is exceeded, or a wafer slips.
    fn stray(&self, overlap: f64) -> Option<f64> {
        let times = self.times(overlap);
        let axes = 0..self.corner.limits[0].len();
        for &since in &times {
            // Half of the overlap belongs to either step, its middle to both.
            let owners = usize::from(since > 0.5 * overlap)..=usize::from(since >= 0.5 * overlap);
            for axis in axes.clone() {
                let states = self.states(axis, overlap, since);
                if !owners.clone().all(|owner| self.within(axis, states, owner)) {
                    return None;
                }
            }
            if self.slips(overlap, since) {
                return None;
            }
        }
        let corner = &self.corner.steps[1].from;
        let [mut first, mut second, mut both] = [corner.clone(), corner.clone(), corner.clone()];
        let mut deviation = 0.0_f64;
        for &since in &times {
            for axis in axes.clone() {
                let [one, other] = self.states(axis, overlap, since).map(|state| state[0]);
                (first[axis], second[axis]) = (one, other);
                both[axis] = one + other - corner[axis];
            }
            for &id in &self.corner.effectors {
                let center = |positions: &[f64]| {
                    let pose = self.corner.cell.robot.effector_pose(positions, id).ok()?;
                    Some(pose.translation.vector)
                };
                let blended = center(&both)?;
                let [one, other] = [center(&first)?, center(&second)?];
                deviation = deviation.max((blended - one).norm().min((blended - other).norm()));
            }
            if deviation > self.corner.radius {
                return None;
            }
        }
        Some(deviation)
    }

    /// Times of an overlap to look at, from its start [s].
    fn times(&self, overlap: f64) -> Vec<f64> {
        let begin = self.ways[0].duration() - overlap;
        let mut times: Vec<f64> =
            (0..=PROBES).map(|probe| overlap * (probe as f64 / PROBES as f64)).collect();
        times.extend(self.breaks[0].iter().map(|time| time - begin));
        times.extend(&self.breaks[1]);
        times.retain(|time| (0.0..=overlap).contains(time));
        times.sort_by(f64::total_cmp);
        // Behind each jump, in the middle to the next, and before that.
        let between =
            |pair: &[f64]| [0.5, BEFORE].map(|share| pair[0] + share * (pair[1] - pair[0]));
        let more: Vec<f64> = times.windows(2).flat_map(between).collect();
        times.extend(more);
        times
    }

    fn states(&self, axis: usize, overlap: f64, since: f64) -> [State; 2] {
        let begin = self.ways[0].duration() - overlap;
        let [first, second] = self.corner.steps;
        [self.ways[0].state(first, axis, begin + since), self.ways[1].state(second, axis, since)]
    }

    /// Whether a wafer slips that either motion alone would carry.
    fn slips(&self, overlap: f64, since: f64) -> bool {
        let Corner { cell, steps, .. } = self.corner;
        let corner = &steps[1].from;
        let states: Vec<[State; 2]> =
            (0..corner.len()).map(|axis| self.states(axis, overlap, since)).collect();
        let share = |id: EffectorId, of: &dyn Fn(usize) -> State| {
            let [positions, velocities, accelerations] = [0, 1, 2]
                .map(|order| (0..corner.len()).map(|axis| of(axis)[order]).collect::<Vec<_>>());
            let motion = AxesMotion {
                positions: &positions,
                velocities: &velocities,
                accelerations: &accelerations,
            };
            // What is not known there is told by the check.
            cell.slip(id, &motion).map_or(0.0, |slip| slip.share())
        };
        let both = |axis: usize| {
            let [one, other] = states[axis];
            [one[0] + other[0] - corner[axis], one[1] + other[1], one[2] + other[2], 0.0]
        };
        steps[0].loaded.iter().any(|&id| {
            let together = share(id, &both);
            together > 1.0 - SLACK
                && [0, 1].iter().all(|&way| together > share(id, &|axis| states[axis][way]))
        })
    }

    /// Whether both motions of an axis at once keep to the limits of one of the steps.
    fn within(&self, axis: usize, states: [State; 2], owner: usize) -> bool {
        let most = [0, 1].map(|step| {
            let limits = &self.corner.limits[step][axis];
            [limits.velocity, limits.acceleration, limits.jerk]
        });
        (0..3).all(|order| {
            let [own, other] = [owner, 1 - owner].map(|step| states[step][order + 1]);
            let [limit, planned] = [owner, 1 - owner].map(|step| most[step][order]);
            // What one does alone was planned for.
            let slack = if own == 0.0 && planned <= limit { -ROUND_OFF } else { SLACK };
            other == 0.0 || (own + other).abs() <= (1.0 - slack) * limit
        })
    }
}
