//! Two steps where they meet: for how long they may run at the same time.

use jointplay_core::gpr::PlatformPose;
use jointplay_core::spatial::Pose;

use super::Segment;
use super::blend::Blend;
use super::limits::scaled_axis_limits;
use super::profile::AxisState;
use crate::geometry::{Placed, Solid, outside};
use crate::program::{Phase, Step};
use crate::robot::{ArmChain, AxesMotion, EffectorId, KinematicLimits, Positions, RODS};
use crate::workcell::Cell;

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

/// Two steps where they meet.
pub(super) struct Corner<'a> {
    cell: &'a Cell,
    /// Zones that wafers' centres have to stay in while the robot turns.
    safe: &'a [Solid],
    steps: [&'a Step; 2],
    ways: [&'a Segment; 2],
    /// How far a wafer may stray [m].
    radius: f64,
    /// Axes that move in either step, as indices.
    moving: Vec<usize>,
    /// Of each of these in either step.
    limits: [Vec<KinematicLimits>; 2],
    effectors: Vec<(EffectorId, ArmChain)>,
    /// The platform where the steps meet.
    platform: Option<PlatformPose>,
}

impl<'a> Corner<'a> {
    /// `None` where two steps are not to be blended: where a wafer changes hands, and up and down in a slot, the robot comes to rest.
    pub(super) fn new(
        (cell, safe): (&'a Cell, &'a [Solid]),
        steps: [&'a Step; 2],
        ways: [&'a Segment; 2],
    ) -> Option<Self> {
        let radius = steps[0].blend.min(steps[1].blend);
        let runs_on = |step: &Step, way: &Segment| {
            step.handover.is_none()
                && !matches!(step.phase, Phase::Lift | Phase::Lower | Phase::Wait)
                && !matches!(way, Segment::Dwell { .. })
        };
        let both = runs_on(steps[0], ways[0]) && runs_on(steps[1], ways[1]);
        if !(both && radius > 0.0 && steps[0].loaded == steps[1].loaded) {
            return None;
        }
        let robot = &cell.robot;
        let moves = |axis: &usize| (0..2).any(|k| ways[k].moves(steps[k], *axis));
        let moving: Vec<usize> = (0..robot.axes.len()).filter(moves).collect();
        let limits = steps
            .map(|step| moving.iter().map(|&axis| scaled_axis_limits(robot, axis, step)).collect());
        let effectors = robot.effectors().map(|id| (id, ArmChain::new(robot, id))).collect();
        let platform = robot.platform(&steps[1].from).ok();
        Some(Self { cell, safe, steps, ways, radius, moving, limits, effectors, platform })
    }

    /// By how much to slow both steps: so that what the overlap saves is more than what that costs.
    pub(super) fn slower(&self) -> f64 {
        let durations = self.ways.map(Segment::duration);
        let (both, most) = (durations[0] + durations[1], longest(durations));
        let mut best = (1.0, 0.0);
        for factor in SLOWER {
            let costs = (factor - 1.0) * both;
            if factor * most - costs <= best.1 {
                continue;
            }
            let ways = self.ways.map(|way| way.slowed(factor));
            let blend = self.at_pace([&ways[0], &ways[1]]);
            let saves = blend.map_or(0.0, |blend| blend.overlap) - costs;
            if saves > best.1 {
                best = (factor, saves);
            }
        }
        best.0
    }

    /// The longest overlap that keeps every limit, lets no wafer slip and no centre leave a safe zone that would not without it, and stays within the radius of the way without it.
    ///
    /// ```text
    ///    q(t)  =  q_1(t) + q_2(t) − corner
    /// ```
    pub(super) fn blend(&self) -> Option<Blend> {
        self.at_pace(self.ways)
    }

    /// The same with other ways, which differ in their pace alone.
    fn at_pace(&self, ways: [&Segment; 2]) -> Option<Blend> {
        let two = Two { corner: self, ways, breaks: ways.map(Segment::breaks) };
        let most = longest(ways.map(Segment::duration));
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

    fn platform(&self, positions: &[f64]) -> Option<PlatformPose> {
        match &self.platform {
            Some(platform) if platform.rods == positions[..RODS] => Some(*platform),
            _ => self.cell.robot.platform(positions).ok(),
        }
    }
}

/// The longest overlap of two steps that last so long: half of the shorter one, so that no three run at once [s].
fn longest(durations: [f64; 2]) -> f64 {
    0.5 * durations[0].min(durations[1])
}

/// Two motions at a corner.
struct Two<'c> {
    corner: &'c Corner<'c>,
    ways: [&'c Segment; 2],
    /// Times after the start of either at which a jerk jumps [s].
    breaks: [Vec<f64>; 2],
}

/// Positions, velocities and accelerations of all axes.
type Rates = [Positions; 3];

impl Two<'_> {
    /// How far wafers' centres stray with an overlap; `None` where a limit or the radius is exceeded, a wafer slips or leaves a safe zone.
    fn stray(&self, overlap: f64) -> Option<f64> {
        let times = self.times(overlap);
        // Half of the overlap belongs to either step, its middle to both.
        let owners =
            |since: f64| usize::from(since > 0.5 * overlap)..=usize::from(since >= 0.5 * overlap);
        for &since in &times {
            for place in 0..self.corner.moving.len() {
                let states = self.states(place, overlap, since);
                if !owners(since).all(|owner| self.within(place, states, owner)) {
                    return None;
                }
            }
        }
        let mut deviation = 0.0_f64;
        for &since in &times {
            let moment = Moment::new(self, overlap, since)?;
            deviation = deviation.max(moment.stray(self.corner));
            let leaves = |owner| moment.leaves(self.corner, owner);
            let is_too_far = deviation > self.corner.radius || owners(since).any(leaves);
            if is_too_far || moment.slips(self.corner) {
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
        times.dedup();
        // Behind each jump, in the middle to the next, and before that.
        let between =
            |pair: &[f64]| [0.5, BEFORE].map(|share| pair[0] + share * (pair[1] - pair[0]));
        let more: Vec<f64> = times.windows(2).flat_map(between).collect();
        times.extend(more);
        times
    }

    /// What an axis does in either step, by its place among those that move.
    fn states(&self, place: usize, overlap: f64, since: f64) -> [AxisState; 2] {
        let begin = self.ways[0].duration() - overlap;
        let axis = self.corner.moving[place];
        let [first, second] = self.corner.steps;
        [self.ways[0].state(first, axis, begin + since), self.ways[1].state(second, axis, since)]
    }

    /// Whether both motions of an axis at once keep to the limits of one of the steps.
    fn within(&self, place: usize, states: [AxisState; 2], owner: usize) -> bool {
        let most = [0, 1].map(|step| {
            let limits = &self.corner.limits[step][place];
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

/// One time of an overlap.
struct Moment {
    /// In the step before, in the next, and in both at once.
    rates: [Rates; 3],
    /// The platform in each.
    platforms: [PlatformPose; 3],
}

/// Place of both at once in a [`Moment`].
const BOTH: usize = 2;

impl Moment {
    /// `None` where the platform cannot be.
    fn new(two: &Two<'_>, overlap: f64, since: f64) -> Option<Self> {
        let corner = &two.corner.steps[1].from;
        let still = Positions::new(&vec![0.0; corner.len()]);
        let mut rates = [[Positions::new(corner), still, still]; 3];
        for (place, &axis) in two.corner.moving.iter().enumerate() {
            let states = two.states(place, overlap, since);
            for order in 0..3 {
                for (way, state) in states.iter().enumerate() {
                    rates[way][order][axis] = state[order];
                }
                let beyond = if order == 0 { corner[axis] } else { 0.0 };
                rates[BOTH][order][axis] = states[0][order] + states[1][order] - beyond;
            }
        }
        let platform = |way: usize| two.corner.platform(&rates[way][0]);
        let platforms = [platform(0)?, platform(1)?, platform(BOTH)?];
        Some(Self { rates, platforms })
    }

    /// How far wafers' centres are from where either step alone would have them, the nearer of both [m].
    fn stray(&self, corner: &Corner<'_>) -> f64 {
        let of = |planar: &ArmChain| {
            let center = |way: usize| {
                let wafer = planar.wafer(&self.rates[way][0]);
                (self.platforms[way].base_from_platform * wafer).translation.vector
            };
            let blended = center(BOTH);
            (blended - center(0)).norm().min((blended - center(1)).norm())
        };
        corner.effectors.iter().map(|(_, planar)| of(planar)).fold(0.0, f64::max)
    }

    /// Whether a wafer slips that either motion alone would carry.
    fn slips(&self, corner: &Corner<'_>) -> bool {
        let share = |&(id, planar): &(EffectorId, ArmChain), way: usize| {
            let [positions, velocities, accelerations] = &self.rates[way];
            let motion = AxesMotion { positions, velocities, accelerations };
            let robot = &corner.cell.robot;
            let platform = robot.platform_motion(&self.platforms[way], &motion).ok()?;
            let on_platform = planar.moving(&planar.own_rates(&motion));
            let wafer = corner.cell.lowered_motion(&platform, &on_platform, id, true).ok()?;
            Some(corner.cell.slip_of(id, &wafer).share())
        };
        // What is not known there is told by the check.
        let share = |carried, way| share(carried, way).unwrap_or(0.0);
        let carried = corner.effectors.iter().filter(|(id, _)| corner.steps[0].loaded.contains(id));
        carried.into_iter().any(|carried| {
            let together = share(carried, BOTH);
            together > 1.0 - SLACK && [0, 1].iter().all(|&way| together > share(carried, way))
        })
    }

    /// Whether a centre is out of a safe zone while the robot turns, farther than by the turn alone.
    fn leaves(&self, corner: &Corner<'_>, owner: usize) -> bool {
        if corner.steps[owner].phase != Phase::Turn {
            return false;
        }
        let off = |solid: &Solid, &(id, ref planar): &(EffectorId, ArmChain), way: usize| {
            let loaded = corner.steps[0].loaded.contains(&id);
            let wafer =
                corner.cell.wafer_pose_by((id, planar), &self.rates[way][0], loaded).ok()?;
            let placed = Placed { solid, base_from_carrier: &Pose::identity() };
            Some(outside(placed, &wafer.translation.vector))
        };
        let any = |solid: &Solid| {
            corner.effectors.iter().any(|effector| {
                let together = off(solid, effector, BOTH);
                together.is_some_and(|off| off > 0.0) && together > off(solid, effector, owner)
            })
        };
        corner.safe.iter().any(any)
    }
}
