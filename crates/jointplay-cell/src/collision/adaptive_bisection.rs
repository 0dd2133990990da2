//! Adaptive bisection of time: distances of candidate pairs over one step, evaluated only where motion bounds do not certify them.
//!
//! # Source
//! \[Schwarzer\]

use std::ops::Range;

use nalgebra::Vector3;

use super::allowed_collisions::ClearanceRule;
use super::distance_bound::{DirectionGap, DistanceBound};
use super::interval_motion_bound::{IntervalMotionBound, PairMotion};
use super::link_poses::LinkPoses;
use super::motion_bound::MotionBoundModel;
use super::motion_bound_coefficients::MotionBoundCoefficients;
use super::object::Parent;
use super::sampled_step::SampledStep;
use super::scene::Scene;
use super::unknown_pose::UnknownPose;
use crate::geometry::{PlacedCollider, distance, penetration_depth, separation};
use crate::trajectory::{Sample, Trajectory};
use crate::violation::{
    IntervalMerger, SampleTime, SampleViolation, Subject, ViolationInterval, ViolationKind,
    ViolationQuantity,
};

/// Relative tolerance of reported minimum distances.
const RELATIVE_DISTANCE_TOLERANCE: f64 = 0.02;
/// Least tolerance of reported minimum distances (m).
const DISTANCE_TOLERANCE: f64 = 2e-5;
/// An interval between two samples is not bisected further once no point travels farther in it than this (m).
const MIN_INTERVAL_TRAVEL: f64 = 2e-6;
/// Resolution of the comparison of a distance with the required clearance: the accuracy to which distances are tested (m).
///
/// A pair violates its clearance where its distance is smaller by more than this; a contact is a violation for any required clearance.
pub(crate) const CONTACT_RESOLUTION: f64 = 1e-8;

/// Tolerance of a reported minimum distance: a sample that was not evaluated may have a distance smaller by this much (m).
pub(crate) fn distance_tolerance(distance: f64) -> f64 {
    (RELATIVE_DISTANCE_TOLERANCE * distance).max(DISTANCE_TOLERANCE)
}

/// Minimum distances and violations of the candidate pairs of one step; objects are indices into the candidates, times count from the start of the step.
pub(crate) struct PairResults {
    /// Minimum distances of pairs that come near.
    pub(crate) minima: Vec<PairMinimum>,
    /// Violations of clearances and keep-out zones.
    pub(crate) violations: Vec<ViolationInterval>,
}

/// Minimum distance of a pair at the samples.
pub(crate) struct PairMinimum {
    pub(crate) objects: [usize; 2],
    /// Minimum distance (m).
    pub(crate) distance: f64,
    /// Time of the minimum since the start of the step (s).
    pub(crate) time: f64,
}

/// Pair of collision objects, the first of which moves, and its clearance rule.
#[derive(Clone, Copy)]
pub(crate) struct CandidatePair {
    pub(crate) objects: [usize; 2],
    pub(crate) rule: ClearanceRule,
}

/// Candidate pairs, with results of the windows of a step that were checked so far.
pub(crate) struct PairAccumulator<'p> {
    pairs: &'p [CandidatePair],
    /// Minimum distance (m) and its time (s) of each pair.
    minima: Vec<Option<(f64, f64)>>,
    /// Last separating direction of each pair.
    directions: Vec<Option<Vector3<f64>>>,
    violations: IntervalMerger,
}

impl<'p> PairAccumulator<'p> {
    pub(crate) fn new(pairs: &'p [CandidatePair]) -> Self {
        let (minima, directions) = (vec![None; pairs.len()], vec![None; pairs.len()]);
        Self { pairs, minima, directions, violations: IntervalMerger::default() }
    }

    pub(crate) fn into_results(self) -> PairResults {
        let pairs = self.pairs.iter().zip(self.minima);
        let minima = pairs.filter_map(|(pair, minimum)| {
            minimum.map(|(distance, time)| PairMinimum { objects: pair.objects, distance, time })
        });
        PairResults { minima: minima.collect(), violations: self.violations.into_intervals() }
    }
}

/// Bound coefficients of the relative motion of a pair.
pub(crate) struct RelativeMotion {
    /// Sums of the coefficients of both objects, without those of the common ancestor.
    pub(crate) coefficients: MotionBoundCoefficients,
    /// Last body that carries both objects.
    pub(crate) ancestor: Parent,
}

/// Distance query for the candidate pairs in one window of a step.
pub(crate) struct StepDistanceQuery<'a> {
    pub(crate) scene: &'a Scene<'a>,
    pub(crate) trajectory: &'a Trajectory,
    pub(crate) step: usize,
    pub(crate) sampled: &'a mut SampledStep,
    /// Indices of the candidates in the scene, moving objects first.
    pub(crate) objects: &'a [usize],
    pub(crate) bounds: &'a MotionBoundModel,
    /// Bound coefficients of the moving objects.
    pub(crate) coefficients: &'a [MotionBoundCoefficients],
    /// Relative motion of the pairs of two moving objects, which are the first pairs.
    pub(crate) relative: &'a [RelativeMotion],
    /// Distances from this on are not reported (m).
    pub(crate) max_distance: f64,
}

impl StepDistanceQuery<'_> {
    /// Checks all pairs over runs of samples of the step, as far as they are in the window.
    pub(crate) fn check(&mut self, pairs: &mut PairAccumulator<'_>, runs: &[Range<usize>]) {
        let (first, count) = (self.sampled.first(), self.sampled.times().len());
        let in_window = |run: &Range<usize>| {
            let local = run.start.saturating_sub(first)..run.end.saturating_sub(first).min(count);
            (!local.is_empty()).then_some(local)
        };
        let runs: Vec<Range<usize>> = runs.iter().filter_map(in_window).collect();
        let mut unknown: Vec<UnknownPose> = Vec::new();
        for (index, pair) in pairs.pairs.iter().enumerate() {
            let required = match pair.rule {
                ClearanceRule::MinClearance(clearance)
                | ClearanceRule::SlotClearance(clearance) => clearance,
                ClearanceRule::Unchecked | ClearanceRule::KeepOut => 0.0,
            };
            let (coefficients, ancestor) = match self.relative.get(index) {
                Some(RelativeMotion { coefficients, ancestor }) => (coefficients, *ancestor),
                // A fixed object does not move against the world.
                None => (&self.coefficients[pair.objects[0]], Parent::World),
            };
            let mut query = PairQuery {
                query: self,
                pair,
                limit: (required - CONTACT_RESOLUTION).max(0.0),
                coefficients,
                ancestor,
                minimum: pairs.minima[index],
                violating: Vec::new(),
                direction: pairs.directions[index],
                direction_changes: 0,
                has_first_distance: false,
            };
            for run in &runs {
                if let Err(pose) = query.check_run(run) {
                    unknown.push(pose);
                }
            }
            let PairQuery { minimum, mut violating, direction, .. } = query;
            (pairs.minima[index], pairs.directions[index]) = (minimum, direction);
            violating.sort_by(|one, other| one.at.time.total_cmp(&other.at.time));
            for DistanceSample { at: SampleTime { time, sample }, distance, depth } in violating {
                let at = SampleTime { time, sample: first + sample };
                pairs.violations.add(at, pair.violation(distance, depth, required), String::new);
            }
        }
        // Between two samples a pose may be unknown that is known at both: the distance there is unknown, which is reported.
        unknown.sort_by(|one, other| one.at.time.total_cmp(&other.at.time));
        for mut pose in unknown {
            pose.at.sample += first;
            pose.report(&mut pairs.violations);
        }
    }

    fn colliders<'b>(&'b self, poses: &'b LinkPoses, pair: [usize; 2]) -> [PlacedCollider<'b>; 2] {
        pair.map(|object| self.scene.collider_at(self.objects[object], poses))
    }
}

impl CandidatePair {
    /// The violation of this pair's rule at a distance (m) or penetration depth (m).
    fn violation(&self, distance: f64, depth: f64, required: f64) -> SampleViolation {
        let (kind, value, limit) = match self.rule {
            ClearanceRule::KeepOut => (ViolationKind::KeepOut, 0.0 - depth, 0.0),
            _ if distance == 0.0 => (ViolationKind::Collision, 0.0 - depth, required),
            ClearanceRule::SlotClearance(_) => (ViolationKind::SlotClearance, distance, required),
            _ => (ViolationKind::Clearance, distance, required),
        };
        let [first, second] = self.objects;
        // One subject for all kinds: clearance violation and contact merge into one interval.
        let subject = Subject { kind: ViolationKind::Collision, first, second };
        SampleViolation {
            subject,
            kind,
            severity: -value,
            value,
            limit,
            quantity: ViolationQuantity::Length,
        }
    }
}

/// Distance of a pair that violates its rule.
struct DistanceSample {
    at: SampleTime,
    /// Distance (m).
    distance: f64,
    /// Penetration depth (m).
    depth: f64,
}

/// Distance query for one pair.
struct PairQuery<'q, 'a> {
    query: &'q mut StepDistanceQuery<'a>,
    pair: &'q CandidatePair,
    /// Distance at which the pair violates its rule: the required clearance less the resolution (m).
    limit: f64,
    coefficients: &'a MotionBoundCoefficients,
    /// Last body that carries both objects.
    ancestor: Parent,
    /// Minimum distance (m) and its time (s) so far.
    minimum: Option<(f64, f64)>,
    violating: Vec<DistanceSample>,
    /// Separating direction from the first object to the second at the last evaluation, in the frame of the common ancestor, where it changes little.
    direction: Option<Vector3<f64>>,
    /// Number of evaluations that changed the direction.
    direction_changes: usize,
    /// Whether distances at the ends of an interval were evaluated for a minimum and a separating direction, if they are relevant.
    has_first_distance: bool,
}

impl PairQuery<'_, '_> {
    fn check_run(&mut self, run: &Range<usize>) -> Result<(), UnknownPose> {
        let last = run.end - 1;
        let mut left = self.bound_at(run.start)?;
        if last == run.start {
            return self.evaluate_if_relevant(run.start, &mut left);
        }
        let mut right = self.bound_at(last)?;
        self.certify_interval(run.start..last, &mut left, &mut right)
    }

    /// Certifies the distance between two samples, or bisects the interval down to neighbouring samples.
    fn certify_interval(
        &mut self,
        interval: Range<usize>,
        left: &mut DistanceBound,
        right: &mut DistanceBound,
    ) -> Result<(), UnknownPose> {
        // Bounds in the order of their cost: spheres, separating direction, droop in the interval, exact distances.
        let motion = self.motion().bound(&interval);
        if DistanceBound::between(left, right, motion) > self.relevant_distance() {
            return Ok(());
        }
        self.refine_lower_bound(interval.start, left)?;
        self.refine_lower_bound(interval.end, right)?;
        let chord_deviation = self.motion().chord_deviation(&interval);
        let mut motion = motion;
        if self.lower_bound(&interval, left, right, motion, chord_deviation)?
            > self.relevant_distance()
        {
            return Ok(());
        }
        let rigid = motion.with_deflection(0.0, 0.0);
        if motion.deflection > 0.0
            && self.lower_bound(&interval, left, right, rigid, chord_deviation)?
                > self.relevant_distance()
        {
            motion = self.motion().with_droop_in_interval(&interval, motion)?;
            if self.lower_bound(&interval, left, right, motion, chord_deviation)?
                > self.relevant_distance()
            {
                return Ok(());
            }
        }
        if !self.has_first_distance {
            // A minimum and a separating direction rule out many intervals, and save their bisection.
            self.has_first_distance = true;
            self.evaluate_if_relevant(interval.start, left)?;
            self.evaluate_if_relevant(interval.end, right)?;
            return self.certify_interval(interval, left, right);
        }
        if interval.len() == 1 {
            self.evaluate_if_relevant(interval.start, left)?;
            self.evaluate_if_relevant(interval.end, right)?;
            // Between samples only violations are searched for, not minimum distances.
            let bound = self.lower_bound(&interval, left, right, motion, chord_deviation)?;
            if bound > self.limit {
                return Ok(());
            }
            self.evaluate(interval.start, left)?;
            self.evaluate(interval.end, right)?;
            let times = [interval.start, interval.end].map(|k| self.query.sampled.times()[k]);
            self.bisect_between_samples(interval.end, times, [*left, *right], motion)?;
            return Ok(());
        }
        let middle = interval.start.midpoint(interval.end);
        let mut center = self.bound_at(middle)?;
        // The half with the smaller distance first: the minimum found there may rule out the other half.
        if left.value <= right.value {
            self.certify_interval(interval.start..middle, left, &mut center)?;
            self.certify_interval(middle..interval.end, &mut center, right)
        } else {
            self.certify_interval(middle..interval.end, &mut center, right)?;
            self.certify_interval(interval.start..middle, left, &mut center)
        }
    }

    /// Bisects the interval between two neighbouring samples where they do not rule out a violation; true if a contact was found.
    fn bisect_between_samples(
        &mut self,
        sample: usize,
        times: [f64; 2],
        ends: [DistanceBound; 2],
        motion: IntervalMotionBound,
    ) -> Result<bool, UnknownPose> {
        let [left, right] = &ends;
        if left.value == 0.0 || right.value == 0.0 {
            return Ok(false);
        }
        // Where the clearance is violated already, only a contact is worse.
        let level = if left.value.min(right.value) <= self.limit { 0.0 } else { self.limit };
        if DistanceBound::between(left, right, motion) > level || motion.total < MIN_INTERVAL_TRAVEL
        {
            return Ok(false);
        }
        let time = 0.5 * (times[0] + times[1]);
        let at = SampleTime { time, sample };
        let query = &mut *self.query;
        let mut state = Sample::default();
        query.trajectory.write_sample_in_step(query.step, time, &mut state);
        let poses = query.scene.link_poses(&state.positions, Vec::new());
        let poses = poses.map_err(|error| UnknownPose { at, error })?;
        let [a, b] = query.colliders(&poses, self.pair.objects);
        let mut middle = DistanceBound::by_spheres([a, b], &poses.normal);
        (middle.value, middle.is_exact) = (distance(a, b), true);
        if middle.value <= self.limit {
            let depth = if middle.value == 0.0 { penetration_depth(a, b) } else { 0.0 };
            self.violating.push(DistanceSample { at, distance: middle.value, depth });
        }
        if middle.value == 0.0 {
            self.update_minimum(0.0, time);
            return Ok(true);
        }
        let half = motion.half();
        Ok(self.bisect_between_samples(sample, [times[0], time], [*left, middle], half)?
            || self.bisect_between_samples(sample, [time, times[1]], [middle, *right], half)?)
    }

    /// Bound of the distance at a sample by bounding spheres.
    fn bound_at(&mut self, sample: usize) -> Result<DistanceBound, UnknownPose> {
        let query = &mut *self.query;
        query.sampled.ensure_link_poses(query.scene, sample)?;
        let poses = query.sampled.link_poses(sample)?;
        Ok(DistanceBound::by_spheres(query.colliders(poses, self.pair.objects), &poses.normal))
    }

    /// Raises the lower bound at a sample to the separation along the last separating direction.
    fn refine_lower_bound(
        &mut self,
        sample: usize,
        bound: &mut DistanceBound,
    ) -> Result<(), UnknownPose> {
        if !bound.is_exact
            && let Some(gap) = self.direction_gap(sample, bound)?
        {
            bound.value = bound.value.max(gap.either);
        }
        Ok(())
    }

    /// Gap along the last separating direction at a sample, computed once for each direction; `None` before the first.
    fn direction_gap(
        &self,
        sample: usize,
        bound: &mut DistanceBound,
    ) -> Result<Option<DirectionGap>, UnknownPose> {
        let (Some(direction), direction_changes) = (&self.direction, self.direction_changes) else {
            return Ok(None);
        };
        let known = bound.along_direction;
        if known.is_some_and(|gap| gap.direction_changes == direction_changes) {
            return Ok(known);
        }
        let query = &*self.query;
        let poses = query.sampled.link_poses(sample)?;
        let colliders = query.colliders(poses, self.pair.objects);
        let direction = query.scene.rotation_of(self.ancestor, poses) * direction;
        let gap = DirectionGap::new(colliders, &direction, direction_changes, &poses.normal);
        bound.along_direction = Some(gap);
        Ok(bound.along_direction)
    }

    /// Evaluates the distance at a sample unless its lower bound rules out that it is relevant.
    fn evaluate_if_relevant(
        &mut self,
        sample: usize,
        bound: &mut DistanceBound,
    ) -> Result<(), UnknownPose> {
        if bound.value.max(bound.along_normal) <= self.relevant_distance() {
            self.refine_lower_bound(sample, bound)?;
        }
        if bound.value.max(bound.along_normal) <= self.relevant_distance() {
            self.evaluate(sample, bound)?;
        }
        Ok(())
    }

    /// Evaluates the exact distance at a sample.
    fn evaluate(&mut self, sample: usize, bound: &mut DistanceBound) -> Result<(), UnknownPose> {
        if bound.is_exact {
            return Ok(());
        }
        let query = &mut *self.query;
        let poses = query.sampled.link_poses(sample)?;
        let [a, b] = query.colliders(poses, self.pair.objects);
        let rotation = query.scene.rotation_of(self.ancestor, poses);
        let guess = self.direction.map(|direction| rotation * direction);
        let found = separation(a, b, guess.as_ref());
        let distance = found.distance;
        let direction = found.direction.map(|direction| rotation.inverse() * direction);
        if direction.is_some() {
            self.direction = direction;
            self.direction_changes += 1;
        }
        (bound.value, bound.is_exact) = (distance, true);
        let time = query.sampled.times()[sample];
        if distance <= self.limit {
            let depth = if distance == 0.0 { penetration_depth(a, b) } else { 0.0 };
            self.violating.push(DistanceSample {
                at: SampleTime { time, sample },
                distance,
                depth,
            });
        }
        self.update_minimum(distance, time);
        Ok(())
    }

    fn update_minimum(&mut self, distance: f64, time: f64) {
        let is_smaller = match self.minimum {
            Some((minimum, earlier)) => {
                distance < minimum || (distance == minimum && time < earlier)
            }
            None => distance < self.query.max_distance,
        };
        if is_smaller && self.pair.rule != ClearanceRule::KeepOut {
            self.minimum = Some((distance, time));
        }
    }

    /// Distance above which neither a violation nor a smaller minimum is possible (m).
    fn relevant_distance(&self) -> f64 {
        if self.pair.rule == ClearanceRule::KeepOut {
            return 0.0;
        }
        self.limit.max(match self.minimum {
            Some((minimum, _)) => minimum - distance_tolerance(minimum),
            // Whether a pair comes nearer than the reported range is decided without tolerance.
            None => self.query.max_distance,
        })
    }

    /// Motion of the pair, for its bounds.
    fn motion(&self) -> PairMotion<'_> {
        let StepDistanceQuery { scene, sampled, bounds, .. } = &*self.query;
        PairMotion {
            scene,
            sampled,
            bounds,
            coefficients: self.coefficients,
            ancestor: self.ancestor,
        }
    }

    /// Lower bound of the distance in an interval by the distances at its ends, and by the gap along the last separating direction (m).
    fn lower_bound(
        &self,
        interval: &Range<usize>,
        left: &mut DistanceBound,
        right: &mut DistanceBound,
        motion: IntervalMotionBound,
        chord_deviation: f64,
    ) -> Result<f64, UnknownPose> {
        let bound = DistanceBound::between(left, right, motion);
        let ends =
            [self.direction_gap(interval.start, left)?, self.direction_gap(interval.end, right)?];
        let [Some(left), Some(right)] = ends else { return Ok(bound) };
        let (gap, vertical) = (left.signed.min(right.signed), left.vertical.max(right.vertical));
        // Deflections are mostly vertical: only their part along the direction counts.
        let vertical_ratio = (vertical + motion.normal_rotation).min(1.0);
        let deflection = vertical_ratio * motion.deflection + motion.lateral_deflection;
        Ok(bound.max(gap - chord_deviation - 2.0 * (motion.platform + deflection)))
    }
}
