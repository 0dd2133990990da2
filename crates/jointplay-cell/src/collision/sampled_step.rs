//! Axis states and link poses of a step at its samples, one window of samples at a time.

use std::ops::Range;

use jointplay_core::bulk::Column;
use jointplay_core::spatial::Pose;

use super::axis_states::AxisStates;
use super::link_poses::{LinkPoses, PoseError};
use super::motion_bound::{AxisTravel, CumulativeAxisTravel, MotionBoundModel};
use super::motion_bound_coefficients::MotionBoundCoefficients;
use super::sample_windows::SampleWindows;
use super::scene::Scene;
use super::swept_aabb::{SweptAabb, union};
use super::unknown_pose::UnknownPose;
use crate::geometry::Interval;
use crate::robot::{Positions, RODS};
use crate::trajectory::{AxisSampler, Trajectory};
use crate::violation::{SampleTime, ViolationKind};

/// Least number of samples in one box of a swept AABB.
const MIN_SAMPLES_PER_BOX: usize = 16;

/// Approximate limit of the boxes of a swept AABB: the boxes of long steps contain more samples each.
const MAX_BOXES: usize = 4096;

/// A window of samples of one step: axis states, cumulative travel, and the link poses as far as they were needed.
///
/// One value is used for many windows, so that its buffers are allocated once.
#[derive(Default)]
pub(crate) struct SampledStep {
    /// Step and window that the samples belong to.
    window: Option<(usize, usize)>,
    /// Number of the window's first sample in the step.
    first: usize,
    /// Samples in one box of a swept AABB.
    samples_per_box: usize,
    /// Times since the start of the step (s).
    times: Vec<f64>,
    /// Positions of all axes at the start (m or rad).
    from: Vec<f64>,
    axes: AxisSampler,
    travel: CumulativeAxisTravel,
    /// Link poses by sample, or why they are unknown, once they were needed.
    poses: Vec<Option<Result<LinkPoses, PoseError>>>,
    /// Buffers of poses that are no longer needed.
    buffers: Vec<Vec<Pose>>,
}

impl SampledStep {
    /// Samples a window of a step.
    pub(crate) fn begin(
        &mut self,
        trajectory: &Trajectory,
        step: usize,
        window: usize,
        windows: &SampleWindows,
        bounds: &MotionBoundModel,
    ) {
        self.window = Some((step, window));
        self.from.clone_from(&trajectory.steps[step].from);
        let range = windows.window(window);
        self.first = range.start;
        self.samples_per_box = MIN_SAMPLES_PER_BOX.max(windows.count / MAX_BOXES);
        self.times.clear();
        self.times.extend(range.map(|sample| windows.time(sample)));
        self.axes.sample_step(trajectory, step, &self.times);
        self.travel.accumulate(bounds, &self.times, &self.from, &self.axes);
        let unused = self.poses.drain(..).flatten().filter_map(Result::ok);
        self.buffers.extend(unused.map(LinkPoses::into_buffer));
        self.poses.resize_with(self.times.len(), || None);
    }

    /// Whether the samples are those of a window of a step.
    pub(crate) fn is_at(&self, step: usize, window: usize) -> bool {
        self.window == Some((step, window))
    }

    /// Invalidates the samples; the buffers stay for the next step.
    pub(crate) fn release(&mut self) {
        self.window = None;
    }

    /// Number of the window's first sample in the step.
    pub(crate) fn first(&self) -> usize {
        self.first
    }

    /// Times of the samples since the start of the step (s).
    pub(crate) fn times(&self) -> &[f64] {
        &self.times
    }

    /// States of the axes that move.
    pub(crate) fn moving_axes(&self) -> &AxisSampler {
        &self.axes
    }

    /// Positions of all axes at the start (m or rad).
    pub(crate) fn from(&self) -> &[f64] {
        &self.from
    }

    /// States of some axes, by their indices; missing axes have the position 0.
    pub(crate) fn axis_states<const N: usize>(&self, indices: &[usize]) -> AxisStates<'_, N> {
        let mut states = AxisStates { moving: [None; N], fixed: [0.0; N] };
        for (index, &axis) in indices.iter().enumerate() {
            states.moving[index] = self.axes.states_of(axis);
            states.fixed[index] = self.from[axis];
        }
        states
    }

    /// Positions of the rods by sample (m); a single value where no rod moves.
    pub(crate) fn rods(&self) -> [Column<'_>; RODS] {
        let states: [_; RODS] = std::array::from_fn(|rod| self.axes.states_of(rod));
        let any_moves = states.iter().any(Option::is_some);
        let len = if any_moves { self.times.len() } else { 1 };
        std::array::from_fn(|rod| match states[rod] {
            Some(states) => Column::from(states.columns()[0]),
            None => Column::constant(&self.from[rod], len),
        })
    }

    /// Positions of all axes at a sample (m or rad).
    pub(crate) fn positions(&self, sample: usize) -> Positions {
        let mut positions = Positions::new(&self.from);
        for (&axis, states) in self.axes.moving().iter().zip(self.axes.states()) {
            positions[axis] = states.columns()[0][sample];
        }
        positions
    }

    /// Upper bounds of the travel of all axes between two samples.
    pub(crate) fn axis_travel(&self, interval: &Range<usize>) -> AxisTravel<'_> {
        self.travel.between(&self.axes, interval)
    }

    /// Computes the link poses at a sample, unless they have been computed.
    ///
    /// # Errors
    /// [`UnknownPose`]
    pub(crate) fn ensure_link_poses(
        &mut self,
        scene: &Scene<'_>,
        sample: usize,
    ) -> Result<(), UnknownPose> {
        if self.poses[sample].is_none() {
            let buffer = self.buffers.pop().unwrap_or_default();
            self.poses[sample] = Some(scene.link_poses(&self.positions(sample), buffer));
        }
        self.link_poses(sample).map(|_| ())
    }

    /// Link poses at a sample for which [`Self::ensure_link_poses`] was called.
    ///
    /// # Errors
    /// [`UnknownPose`]
    pub(crate) fn link_poses(&self, sample: usize) -> Result<&LinkPoses, UnknownPose> {
        let at = SampleTime { time: self.times[sample], sample };
        match &self.poses[sample] {
            Some(Ok(poses)) => Ok(poses),
            Some(Err(error)) => Err(UnknownPose { at, error: error.clone() }),
            // A distance that cannot be computed is a violation, never a clearance that is satisfied.
            None => {
                let reason =
                    "the poses of this sample were not computed before their use".to_owned();
                Err(UnknownPose { at, error: PoseError { kind: ViolationKind::Platform, reason } })
            }
        }
    }

    /// Boxes around the path of an object over runs of samples; `None` for no run.
    ///
    /// # Errors
    /// [`UnknownPose`], where a pose is unknown.
    pub(crate) fn swept_aabb(
        &mut self,
        scene: &Scene<'_>,
        object: usize,
        bounds: &MotionBoundModel,
        coefficients: &MotionBoundCoefficients,
        runs: &[Range<usize>],
    ) -> Result<Option<SweptAabb>, UnknownPose> {
        let count = runs.iter().map(|run| run.len().div_ceil(self.samples_per_box)).sum();
        let mut parts: Vec<[Interval; 3]> = Vec::with_capacity(count);
        for run in runs {
            let ends = run.clone().step_by(self.samples_per_box).skip(1).chain([run.end - 1]);
            let mut from = run.start;
            let mut first = self.aabb(scene, object, from)?;
            for to in ends {
                let second = self.aabb(scene, object, to)?;
                // Between two samples a point is no farther from one of its positions there than half of its travel.
                let travel = self.axis_travel(&(from..to));
                let margin = 0.5 * bounds.displacement(coefficients, &travel).total();
                parts.push(std::array::from_fn(|k| first[k].union(second[k]).inflated(margin)));
                (from, first) = (to, second);
            }
        }
        Ok(parts.iter().copied().reduce(union).map(|whole| SweptAabb { whole, parts }))
    }

    /// Axis-aligned box around an object at a sample.
    fn aabb(
        &mut self,
        scene: &Scene<'_>,
        object: usize,
        sample: usize,
    ) -> Result<[Interval; 3], UnknownPose> {
        self.ensure_link_poses(scene, sample)?;
        Ok(scene.collider_at(object, self.link_poses(sample)?).aabb())
    }
}
