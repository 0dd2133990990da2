//! The longest overlap of two successive segments.

use jointplay_core::gpr::PlatformPose;
use jointplay_core::spatial::Pose;

use super::axis_state::AxisState;
use super::blend::Blend;
use super::limits::scaled_axis_limits;
use super::segment::Segment;
use super::segment_motion::SegmentMotion;
use crate::geometry::{Collider, PlacedCollider, signed_distance};
use crate::program::{Phase, Step};
use crate::robot::{ArmChain, AxesMotion, KinematicLimits, Positions, RODS};
use crate::workcell::Cell;

/// Number of bisections of the longest overlap.
const BISECTIONS: usize = 12;
/// Number of equal intervals of an overlap, whose ends are checked in addition to times around discontinuities of the jerk; divisible by two, so that the middle is one of them.
const UNIFORM_INTERVALS: usize = 30;
/// Fraction of the time from one checked time to the next, just before the next: one-sided values before a discontinuity.
const JUST_BEFORE: f64 = 1.0 - 1e-6;
/// Margin below each limit for the times between the checked ones, relative to the limit.
const MARGIN: f64 = 5e-3;
/// Tolerance above a limit where only one of the two segments moves an axis, relative to the limit: each segment satisfies its own limits up to round-off.
const ROUND_OFF_TOLERANCE: f64 = 1e-12;

/// Time scales by which both segments may be slowed.
///
/// Two segments that both reach the limits of one axis cannot overlap; slower segments leave a part of the limits to each other.
const SLOWDOWN_FACTORS: [f64; 5] = [1.0, 1.01, 1.03, 1.08, 1.2];

/// Inputs of the blends of a trajectory besides its segments.
#[derive(Clone, Copy)]
pub(super) struct BlendConditions<'a> {
    pub(super) cell: &'a Cell,
    /// Zones in which the centres of wafers have to stay while the robot turns.
    pub(super) safe_zones: &'a [Collider],
}

/// Two successive segments that may overlap.
pub(super) struct BlendCandidate<'a> {
    conditions: BlendConditions<'a>,
    steps: [&'a Step; 2],
    segments: [&'a Segment; 2],
    /// Largest allowed distance of a wafer's centre from the unblended path (m).
    radius: f64,
    /// Indices of the axes that move in either step.
    moving: Vec<usize>,
    /// Limits of each moving axis, in either step.
    limits: [Vec<KinematicLimits>; 2],
    /// Arms to all effectors.
    chains: Vec<ArmChain>,
    /// The platform in the positions where the steps meet; `None` where it cannot be computed.
    platform: Option<PlatformPose>,
}

impl<'a> BlendCandidate<'a> {
    /// Two steps with their segments; `None` where the robot has to stop between them: at a hand-off, before and after strokes in a slot, and at dwells.
    pub(super) fn new(
        conditions: BlendConditions<'a>,
        steps: [&'a Step; 2],
        segments: [&'a Segment; 2],
    ) -> Option<Self> {
        let radius = steps[0].blend_radius.min(steps[1].blend_radius);
        let may_blend = |step: &Step, segment: &Segment| {
            step.handoff.is_none()
                && !matches!(step.phase, Phase::Lift | Phase::Lower | Phase::Wait)
                && !matches!(**segment.motion, SegmentMotion::Dwell { .. })
        };
        let both = may_blend(steps[0], segments[0]) && may_blend(steps[1], segments[1]);
        if !(both && radius > 0.0 && steps[0].loaded == steps[1].loaded) {
            return None;
        }
        let robot = &conditions.cell.robot;
        let moves = |axis: &usize| (0..2).any(|k| segments[k].motion.moves(steps[k], *axis));
        let moving: Vec<usize> = (0..robot.axes.len()).filter(moves).collect();
        let limits = steps
            .map(|step| moving.iter().map(|&axis| scaled_axis_limits(robot, axis, step)).collect());
        let chains = robot.effectors().map(|id| ArmChain::new(robot, id)).collect();
        let platform = robot.platform(&steps[1].from).ok();
        Some(Self { conditions, steps, segments, radius, moving, limits, chains, platform })
    }

    /// Time scale of both segments for which their total duration is shortest: the longer overlap saves more time than the slowdown costs.
    pub(super) fn best_slowdown(&self) -> f64 {
        let durations = self.segments.map(Segment::duration);
        let (total, longest) = (durations[0] + durations[1], max_overlap(durations));
        let mut best = (1.0, 0.0);
        for factor in SLOWDOWN_FACTORS {
            let cost = (factor - 1.0) * total;
            // Even the longest overlap saves less time than the best factor so far.
            if factor * longest - cost <= best.1 {
                continue;
            }
            let segments = self.segments.map(|segment| segment.slowed(factor));
            let blend = self.blend_of([&segments[0], &segments[1]]);
            let gain = blend.map_or(0.0, |blend| blend.overlap) - cost;
            if gain > best.1 {
                best = (factor, gain);
            }
        }
        best.0
    }

    /// The longest admissible overlap; `None` where there is none.
    ///
    /// An overlap is admissible if every axis is within its limits, all wafer centres stay within the blend radius of the unblended path,
    /// and the overlap causes no slip and no exit from a safe zone that the unblended motion does not have.
    pub(super) fn blend(&self) -> Option<Blend> {
        self.blend_of(self.segments)
    }

    /// As [`Self::blend`], for segments on the same paths with other timing.
    fn blend_of(&self, segments: [&Segment; 2]) -> Option<Blend> {
        let superposed = SuperposedSegments {
            candidate: self,
            segments,
            discontinuities: segments.map(|segment| segment.motion.jerk_discontinuities()),
        };
        let longest = max_overlap(segments.map(Segment::duration));
        if let Some(deviation) = superposed.path_deviation(longest) {
            return Some(Blend { overlap: longest, deviation });
        }
        // Bisection: a shorter overlap superposes less motion. Where admissibility is not monotonic, the result is admissible, but it may not be the longest.
        let (mut low, mut high, mut deviation) = (0.0, longest, 0.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            match superposed.path_deviation(middle) {
                Some(found) => (low, deviation) = (middle, found),
                None => high = middle,
            }
        }
        (low > 0.0).then_some(Blend { overlap: low, deviation })
    }

    /// The platform in given positions of all axes.
    fn platform(&self, positions: &[f64]) -> Option<PlatformPose> {
        match &self.platform {
            // The rods are mostly at rest: then the model need not be solved again.
            Some(platform) if platform.rods == positions[..RODS] => Some(*platform),
            _ => self.conditions.cell.robot.platform(positions).ok(),
        }
    }
}

/// Longest overlap of two segments: half of the shorter one, so that no three segments run at once (s).
fn max_overlap(durations: [f64; 2]) -> f64 {
    0.5 * durations[0].min(durations[1])
}

/// Two segments that overlap.
struct SuperposedSegments<'c> {
    candidate: &'c BlendCandidate<'c>,
    segments: [&'c Segment; 2],
    /// Times since the start of either segment at which its jerk is discontinuous (s).
    discontinuities: [Vec<f64>; 2],
}

/// Vectors of the positions, velocities and accelerations of all axes.
type AxisVectors = [Positions; 3];

impl SuperposedSegments<'_> {
    /// Largest distance of a wafer's centre from the unblended path for an overlap (m); `None` where the overlap is not admissible.
    fn path_deviation(&self, overlap: f64) -> Option<f64> {
        let times = self.checked_times(overlap);
        // Each half of the overlap belongs to one of the steps, whose limits apply there; the middle belongs to both.
        let owners =
            |time: f64| usize::from(time > 0.5 * overlap)..=usize::from(time >= 0.5 * overlap);
        // Limits of axes first: they are cheaper than poses.
        for &time in &times {
            for index in 0..self.candidate.moving.len() {
                let states = self.states(index, overlap, time);
                if !owners(time)
                    .all(|active_step| self.is_within_limits(index, states, active_step))
                {
                    return None;
                }
            }
        }
        let mut deviation = 0.0_f64;
        for &time in &times {
            let sample = BlendSample::new(self, overlap, time)?;
            deviation = deviation.max(sample.path_deviation(self.candidate));
            let leaves = |active_step| sample.leaves_safe_zone(self.candidate, active_step);
            let is_too_far = deviation > self.candidate.radius || owners(time).any(leaves);
            if is_too_far || sample.slips(self.candidate) {
                return None;
            }
        }
        Some(deviation)
    }

    /// Times since the start of an overlap at which it is checked (s).
    ///
    /// Between discontinuities of the jerk, accelerations are nearly linear and velocities nearly parabolic:
    /// ends and middle of each such interval bound them to within [`MARGIN`].
    fn checked_times(&self, overlap: f64) -> Vec<f64> {
        let begin = self.segments[0].duration() - overlap;
        let uniform =
            (0..=UNIFORM_INTERVALS).map(|k| overlap * (k as f64 / UNIFORM_INTERVALS as f64));
        let mut times: Vec<f64> = uniform.collect();
        times.extend(self.discontinuities[0].iter().map(|time| time - begin));
        times.extend(&self.discontinuities[1]);
        times.retain(|time| (0.0..=overlap).contains(time));
        times.sort_by(f64::total_cmp);
        times.dedup();
        let inside = |pair: &[f64]| {
            [0.5, JUST_BEFORE].map(|fraction| pair[0] + fraction * (pair[1] - pair[0]))
        };
        let between: Vec<f64> = times.windows(2).flat_map(inside).collect();
        times.extend(between);
        times
    }

    /// States of an axis in either segment, by its index among the moving axes.
    fn states(&self, index: usize, overlap: f64, time: f64) -> [AxisState; 2] {
        let begin = self.segments[0].duration() - overlap;
        let axis = self.candidate.moving[index];
        let [first, second] = self.candidate.steps;
        [
            self.segments[0].state(first, axis, begin + time),
            self.segments[1].state(second, axis, time),
        ]
    }

    /// Whether the sum of two states of an axis is within the limits of one of the steps, the active one.
    fn is_within_limits(&self, index: usize, states: [AxisState; 2], active_step: usize) -> bool {
        let limits = [0, 1].map(|step| {
            let limits = &self.candidate.limits[step][index];
            [limits.velocity, limits.acceleration, limits.jerk]
        });
        (0..3).all(|order| {
            let [own, other] = [active_step, 1 - active_step].map(|step| states[step][order + 1]);
            let [limit, other_limit] =
                [active_step, 1 - active_step].map(|step| limits[step][order]);
            // A segment alone was planned within the limits of its own step.
            let margin =
                if own == 0.0 && other_limit <= limit { -ROUND_OFF_TOLERANCE } else { MARGIN };
            other == 0.0 || (own + other).abs() <= (1.0 - margin) * limit
        })
    }
}

/// The robot at one time of an overlap.
struct BlendSample {
    /// Axes by the first segment alone, by the second alone, and superposed.
    states: [AxisVectors; 3],
    /// Platform in each of them.
    platforms: [PlatformPose; 3],
}

/// Index of the superposed motion in a [`BlendSample`].
const SUPERPOSED: usize = 2;

impl BlendSample {
    /// `None` where the platform cannot be computed.
    fn new(superposed: &SuperposedSegments<'_>, overlap: f64, time: f64) -> Option<Self> {
        let corner = &superposed.candidate.steps[1].from;
        let zero = Positions::new(&vec![0.0; corner.len()]);
        let mut states = [[Positions::new(corner), zero, zero]; 3];
        for (index, &axis) in superposed.candidate.moving.iter().enumerate() {
            let by_segment = superposed.states(index, overlap, time);
            for order in 0..3 {
                for (segment, state) in by_segment.iter().enumerate() {
                    states[segment][order][axis] = state[order];
                }
                let common = if order == 0 { corner[axis] } else { 0.0 };
                states[SUPERPOSED][order][axis] =
                    by_segment[0][order] + by_segment[1][order] - common;
            }
        }
        let platform = |motion: usize| superposed.candidate.platform(&states[motion][0]);
        let platforms = [platform(0)?, platform(1)?, platform(SUPERPOSED)?];
        Some(Self { states, platforms })
    }

    /// Largest distance of a wafer's centre from the nearer of its positions by either segment alone (m).
    fn path_deviation(&self, candidate: &BlendCandidate<'_>) -> f64 {
        let deviation = |chain: &ArmChain| {
            let center = |motion: usize| {
                let wafer = chain.wafer(&self.states[motion][0]);
                (self.platforms[motion].base_from_platform * wafer).translation.vector
            };
            let blended = center(SUPERPOSED);
            (blended - center(0)).norm().min((blended - center(1)).norm())
        };
        candidate.chains.iter().map(deviation).fold(0.0, f64::max)
    }

    /// Whether a wafer slips that slips in neither segment alone.
    fn slips(&self, candidate: &BlendCandidate<'_>) -> bool {
        let cell = candidate.conditions.cell;
        let utilization = |chain: &ArmChain, motion: usize| {
            let [positions, velocities, accelerations] = &self.states[motion];
            let axes = AxesMotion { positions, velocities, accelerations };
            let platform = cell.robot.platform_motion(&self.platforms[motion], &axes).ok()?;
            let on_platform = chain.wafer_motion(&chain.arm_states(&axes));
            let wafer =
                cell.deflected_motion(&platform, &on_platform, chain.effector, true).ok()?;
            Some(cell.friction_demand_of(chain.effector, &wafer).utilization())
        };
        // Where the motion is unknown, the check of the trajectory reports it.
        let utilization = |chain, motion| utilization(chain, motion).unwrap_or(0.0);
        let is_loaded = |chain: &&ArmChain| candidate.steps[0].loaded.contains(&chain.effector);
        candidate.chains.iter().filter(is_loaded).any(|chain| {
            let superposed = utilization(chain, SUPERPOSED);
            superposed > 1.0 - MARGIN
                && [0, 1].iter().all(|&motion| superposed > utilization(chain, motion))
        })
    }

    /// Whether a wafer's centre is farther outside a safe zone than without the overlap, in a step in which the robot turns or changes its posture.
    ///
    /// # Arguments
    /// * `active_step` – index, 0 or 1, of the step whose half of the overlap contains the sample
    fn leaves_safe_zone(&self, candidate: &BlendCandidate<'_>, active_step: usize) -> bool {
        if !candidate.steps[active_step].phase.is_in_safe_zones() {
            return false;
        }
        let distance = |zone: &Collider, chain: &ArmChain, motion: usize| {
            let loaded = candidate.steps[0].loaded.contains(&chain.effector);
            let cell = candidate.conditions.cell;
            let wafer = cell.wafer_pose_by(chain, &self.states[motion][0], loaded).ok()?;
            let placed = PlacedCollider { collider: zone, base_from_parent: &Pose::identity() };
            Some(signed_distance(placed, &wafer.translation.vector))
        };
        let leaves = |zone: &Collider| {
            candidate.chains.iter().any(|chain| {
                let superposed = distance(zone, chain, SUPERPOSED);
                superposed.is_some_and(|distance| distance > 0.0)
                    && superposed > distance(zone, chain, active_step)
            })
        };
        candidate.conditions.safe_zones.iter().any(leaves)
    }
}
