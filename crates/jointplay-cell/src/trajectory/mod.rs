//! Steps in time.
//!
//! ```text
//!   Path::PointToPoint   from ──▶ to     every axis jerk-limited, all in the time of the slowest
//!   Path::Line   from ──▶ to     q(s): the wafer's centre straight, its plane turning evenly;  s(t): every axis within its limits
//! ```

mod blend;
mod cartesian_path;
mod corner;
mod limits;
mod profile;
mod sampler;
mod segment_planner;
mod spline;
mod steps;
mod synchronized;
mod time_parameterization;

pub use blend::Blend;
pub use limits::{axis_limits, axis_moves_effector, scaled_axis_limits};
pub(crate) use profile::AxisState;
pub(crate) use sampler::AxisSampler;
pub use segment_planner::{
    MAX_DURATION, StepError, TrajectoryError, TrajectoryOptions, plan_trajectory,
};
pub(crate) use segment_planner::{SegmentCache, straight};

use std::sync::Arc;

use crate::incremental::{Key, extend};
use crate::program::Step;

/// All axes at one time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sample {
    /// Since the start [s].
    pub time: f64,
    /// Index of the step.
    pub step: usize,
    /// Of each axis [m or rad].
    pub positions: Vec<f64>,
    /// Of each axis [m/s or rad/s].
    pub velocities: Vec<f64>,
    /// Of each axis [m/s² or rad/s²].
    pub accelerations: Vec<f64>,
    /// Of each axis [m/s³ or rad/s³].
    pub jerks: Vec<f64>,
}

/// Steps with their times.
#[derive(Debug, Clone)]
pub struct Trajectory {
    /// In order.
    pub steps: Vec<Step>,
    /// Start of each step, and the end of the last; where a step runs into the next, the middle of their overlap [s].
    pub times: Vec<f64>,
    /// How the axes go in each step.
    ways: Vec<Arc<Segment>>,
    /// How each step runs into the next.
    blends: Vec<Option<Blend>>,
}

/// How far a straight line is from straight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineDeviation {
    /// Its length [m].
    pub length: f64,
    /// Largest distance of the wafer's centre from the straight line [m].
    pub deviation: f64,
    /// Largest angle between the wafer's plane and the one that turns evenly [rad].
    pub plane: f64,
}

/// How all axes go in one step.
#[derive(Debug, Clone)]
pub(crate) enum Segment {
    Dwell { duration: f64 },
    PointToPoint(synchronized::SynchronizedProfile),
    Line { line: Arc<cartesian_path::Line>, pace: profile::JerkLimitedProfile },
}

impl Segment {
    fn duration(&self) -> f64 {
        match self {
            Self::Dwell { duration } => *duration,
            Self::PointToPoint(together) => together.duration,
            Self::Line { pace, .. } => pace.duration(),
        }
    }

    /// The same way, `factor` times as long.
    fn slowed(&self, factor: f64) -> Self {
        match self {
            Self::Dwell { duration } => Self::Dwell { duration: *duration },
            Self::PointToPoint(together) => Self::PointToPoint(synchronized::SynchronizedProfile {
                curves: together.curves.iter().map(|curve| curve.slowed(factor)).collect(),
                duration: together.duration * factor,
                slowest: together.slowest,
            }),
            Self::Line { line, pace } => {
                Self::Line { line: Arc::clone(line), pace: pace.slowed(factor) }
            }
        }
    }

    /// Whether an axis does anything on it.
    fn moves(&self, step: &Step, axis: usize) -> bool {
        match self {
            Self::Dwell { .. } => false,
            Self::PointToPoint(_) => step.from[axis] != step.to[axis],
            Self::Line { line, .. } => line.spline.moves(axis),
        }
    }

    /// Times after its start at which a jerk jumps [s].
    fn breaks(&self) -> Vec<f64> {
        match self {
            Self::Dwell { .. } => Vec::new(),
            Self::PointToPoint(together) => {
                together.curves.iter().flat_map(profile::JerkLimitedProfile::breaks).collect()
            }
            Self::Line { line, pace } => {
                let knots = line.spline.knots().iter().map(|&knot| pace.when(knot));
                pace.breaks().chain(knots).collect()
            }
        }
    }

    /// One axis, some time after its start [s].
    fn state(&self, step: &Step, axis: usize, since: f64) -> profile::AxisState {
        match self {
            Self::Dwell { .. } => [step.to[axis], 0.0, 0.0, 0.0],
            Self::PointToPoint(together) => together.curves[axis].at(since),
            Self::Line { line, pace } => {
                let along = pace.at(since);
                on_line(line, line.spline.interval(along[0]), axis, along)
            }
        }
    }

    /// All axes, some time after its start [s].
    fn fill(&self, step: &Step, since: f64, sample: &mut Sample) {
        if since >= self.duration() {
            sample.positions.copy_from_slice(&step.to);
            return;
        }
        match self {
            Self::Dwell { .. } => sample.positions.copy_from_slice(&step.from),
            Self::PointToPoint(together) => {
                for (axis, curve) in together.curves.iter().enumerate() {
                    sample.set(axis, curve.at(since));
                }
            }
            Self::Line { line, pace } => {
                let along = pace.at(since);
                let interval = line.spline.interval(along[0]);
                for axis in 0..step.from.len() {
                    sample.set(axis, on_line(line, interval, axis, along));
                }
            }
        }
    }

    /// Adds what it does beyond a corner.
    fn add(&self, step: &Step, since: f64, corner: &[f64], sample: &mut Sample) {
        for (axis, corner) in corner.iter().enumerate() {
            let [p, v, a, j] = self.state(step, axis, since);
            sample.positions[axis] += p - corner;
            sample.velocities[axis] += v;
            sample.accelerations[axis] += a;
            sample.jerks[axis] += j;
        }
    }
}

/// One axis where the share of a line's way is in a state.
fn on_line(
    line: &cartesian_path::Line,
    interval: usize,
    axis: usize,
    [s, rate, acceleration, jerk]: profile::AxisState,
) -> profile::AxisState {
    let [q, slope, curvature, third] = line.spline.jet(interval, axis, s);
    [
        q,
        slope * rate,
        curvature * rate * rate + slope * acceleration,
        third * rate.powi(3) + 3.0 * curvature * rate * acceleration + slope * jerk,
    ]
}

impl Trajectory {
    /// How long it takes [s].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// How long a step takes [s].
    #[must_use]
    pub fn step_duration(&self, step: usize) -> f64 {
        self.times[step + 1] - self.times[step]
    }

    /// The step that runs at a time [s]: the later one where two meet, the last one from its end on.
    #[must_use]
    pub fn step_at(&self, time: f64) -> usize {
        let begun = self.times[..self.steps.len().max(1)].partition_point(|&start| start <= time);
        begun.saturating_sub(1)
    }

    /// Whether no axis moves in a step.
    #[must_use]
    pub fn is_dwell(&self, step: usize) -> bool {
        matches!(*self.ways[step], Segment::Dwell { .. })
    }

    /// Whether a step takes any time: waiting for a station that is done already takes none.
    #[must_use]
    pub fn has_duration(&self, step: usize) -> bool {
        self.ways[step].duration() > 0.0
    }

    /// The axes that do anything in a step, as indices.
    pub(crate) fn moving(&self, index: usize) -> Vec<usize> {
        let [lead, tail] = self.overlaps(index);
        let moves = |index: usize, axis: usize| self.ways[index].moves(&self.steps[index], axis);
        let any = |axis: &usize| {
            moves(index, *axis)
                || (lead > 0.0 && moves(index - 1, *axis))
                || (tail > 0.0 && moves(index + 1, *axis))
        };
        (0..self.steps[index].from.len()).filter(any).collect()
    }

    /// How straight a step is that runs along a line; `None` for any other.
    #[must_use]
    pub fn straightness(&self, step: usize) -> Option<LineDeviation> {
        match &*self.ways[step] {
            Segment::Line { line, .. } => Some(LineDeviation {
                length: line.length,
                deviation: line.deviation,
                plane: line.plane,
            }),
            _ => None,
        }
    }

    /// The axis that would be last in a step if each went as fast as it may; `None` where none moves or a line binds them.
    #[must_use]
    pub fn limiting_axis(&self, step: usize) -> Option<usize> {
        match &*self.ways[step] {
            Segment::PointToPoint(together) => together.slowest,
            _ => None,
        }
    }

    /// How a step runs into the next; `None` where both are at rest between them.
    #[must_use]
    pub fn blend(&self, step: usize) -> Option<Blend> {
        self.blends.get(step).copied().flatten()
    }

    /// All axes at a time [s]; before the start and after the end, as they stand there.
    ///
    /// At the end of a step all axes are exactly where it leads, unless it runs into the next.
    #[must_use]
    pub fn at(&self, time: f64) -> Sample {
        let mut sample = Sample::default();
        self.fill(time, &mut sample);
        sample
    }

    /// As [`Self::at`], into a sample that is there.
    pub fn fill(&self, time: f64, sample: &mut Sample) {
        self.fill_in(self.step_at(time), time, sample);
    }

    /// All axes at a time [s] of a step, both its ends included.
    fn fill_in(&self, index: usize, time: f64, sample: &mut Sample) {
        let last = index + 1 == self.steps.len() && time >= self.duration();
        let since = self.times.get(index).map_or(0.0, |start| time - start);
        self.fill_in_step(index, if last { f64::INFINITY } else { since }, sample);
        sample.time = time;
    }

    /// All axes some time after a step's start [s].
    pub(crate) fn fill_in_step(&self, index: usize, since: f64, sample: &mut Sample) {
        sample.time = since;
        sample.step = index;
        let Some(step) = self.steps.get(index) else { return };
        let count = step.from.len();
        for values in [
            &mut sample.positions,
            &mut sample.velocities,
            &mut sample.accelerations,
            &mut sample.jerks,
        ] {
            values.clear();
            values.resize(count, 0.0);
        }
        let [lead, tail] = self.overlaps(index);
        let own = (since + lead).max(0.0);
        self.ways[index].fill(step, own, sample);
        if since < lead {
            let before = &self.ways[index - 1];
            let since = before.duration() + since - lead;
            before.add(&self.steps[index - 1], since, &step.from, sample);
        }
        let next = own - (self.ways[index].duration() - 2.0 * tail);
        if tail > 0.0 && next > 0.0 && index + 1 < self.steps.len() {
            self.ways[index + 1].add(&self.steps[index + 1], next, &step.to, sample);
        }
    }

    /// Half of the overlaps with the step before and the step after [s]: half of each belongs to either step.
    fn overlaps(&self, index: usize) -> [f64; 2] {
        let half = |step: usize| self.blend(step).map_or(0.0, |blend| 0.5 * blend.overlap);
        [index.checked_sub(1).map_or(0.0, half), half(index)]
    }

    /// How long a step takes, by itself and not as a difference of times [s].
    pub(crate) fn length(&self, index: usize) -> f64 {
        let [lead, tail] = self.overlaps(index);
        self.ways[index].duration() - lead - tail
    }

    /// What all axes do in a step, as inputs of what is found of it; the ways are those in [`Self::segments_of`].
    pub(crate) fn key(&self, index: usize) -> Key {
        let step = &self.steps[index];
        let mut key = Key::new();
        let overlaps = self.overlaps(index);
        for (way, overlap) in self.segments_of(index).iter().zip([0.0, overlaps[0], overlaps[1]]) {
            key.push(way.as_ref().map_or(0, |way| Arc::as_ptr(way) as u64));
            key.push(overlap.to_bits());
        }
        extend(&mut key, &step.from);
        extend(&mut key, &step.to);
        key
    }

    /// The way of a step, and those of its neighbours where they run into it; whoever keeps a [`Self::key`] keeps them, so that no other way comes to be in their place.
    pub(crate) fn segments_of(&self, index: usize) -> [Option<Arc<Segment>>; 3] {
        let [lead, tail] = self.overlaps(index);
        let way = |index: usize| Some(Arc::clone(&self.ways[index]));
        [
            way(index),
            if lead > 0.0 { way(index - 1) } else { None },
            if tail > 0.0 { way(index + 1) } else { None },
        ]
    }

    /// All axes at even times from the start, `rate` a second, and at the end [Hz].
    pub fn samples(&self, rate: f64) -> impl Iterator<Item = Sample> + '_ {
        self.sample_times(rate).map(|time| self.at(time))
    }

    /// The times of [`Self::samples`].
    pub fn sample_times(&self, rate: f64) -> impl Iterator<Item = f64> + use<> {
        let duration = self.duration();
        // A last even time within a thousandth of the end is the end.
        let whole = (duration * rate - 1e-3).ceil().max(0.0);
        (0..whole as u64).map(move |k| k as f64 / rate).chain([duration])
    }
}

impl Sample {
    fn set(&mut self, axis: usize, state: profile::AxisState) {
        self.positions[axis] = state[0];
        self.velocities[axis] = state[1];
        self.accelerations[axis] = state[2];
        self.jerks[axis] = state[3];
    }
}
