//! The motion of all axes in one step, before it is blended with its neighbours.

use std::sync::Arc;

use super::axis_state::AxisState;
use super::sample::Sample;
use super::segment_motion::{SegmentMotion, derivatives_along_path};
use crate::incremental::{CacheKey, CacheKeyPart, WithId};
use crate::program::Step;
use crate::robot::RODS;

/// The motion of all axes in one step, from rest to rest.
#[derive(Debug, Clone)]
pub(crate) struct Segment {
    /// Motion over a height of the rods, which segments at other heights share.
    pub(super) motion: Arc<WithId<SegmentMotion>>,
    /// That height, which is added to all rods (m).
    lift: f64,
}

impl Segment {
    /// A motion that no other segment shares.
    pub(super) fn new(motion: SegmentMotion) -> Self {
        Self { motion: Arc::new(WithId::new(motion)), lift: 0.0 }
    }

    /// A motion over a height of the rods; a dwell is at the positions of its step.
    pub(super) fn lifted(motion: Arc<WithId<SegmentMotion>>, lift: f64) -> Self {
        let is_dwell = matches!(**motion, SegmentMotion::Dwell { .. });
        Self { motion, lift: if is_dwell { 0.0 } else { lift } }
    }

    /// No motion.
    pub(super) fn dwell(duration: f64) -> Self {
        Self::new(SegmentMotion::Dwell { duration })
    }

    /// Time from the start of the segment to its end (s).
    pub(super) fn duration(&self) -> f64 {
        self.motion.duration()
    }

    /// The segment stretched in time by a factor; a dwell keeps its duration.
    pub(super) fn slowed(&self, factor: f64) -> Self {
        self.with(Arc::new(WithId::new(self.motion.slowed(factor))))
    }

    /// Another motion over the same height.
    pub(super) fn with(&self, motion: Arc<WithId<SegmentMotion>>) -> Self {
        Self { motion, lift: self.lift }
    }

    /// Height that is added to an axis (m); 0 for motors.
    pub(super) fn lift_of(&self, axis: usize) -> f64 {
        if axis < RODS { self.lift } else { 0.0 }
    }

    /// State of one axis at a time since the start of the segment (s).
    pub(super) fn state(&self, step: &Step, axis: usize, time: f64) -> AxisState {
        let [position, velocity, acceleration, jerk] = self.motion.state(step, axis, time);
        [position + self.lift_of(axis), velocity, acceleration, jerk]
    }

    /// Writes the states of all axes at a time since the start of the segment (s) into a sample of zeros.
    pub(super) fn write_sample(&self, step: &Step, time: f64, sample: &mut Sample) {
        if time >= self.duration() {
            // Exactly the end of the step: a profile meets it to round-off only.
            sample.positions.copy_from_slice(&step.to);
            return;
        }
        match &**self.motion {
            SegmentMotion::Dwell { .. } => sample.positions.copy_from_slice(&step.from),
            SegmentMotion::PointToPoint(profile) => {
                for (axis, profile) in profile.axes.iter().enumerate() {
                    sample.set(axis, profile.state(time));
                }
            }
            SegmentMotion::Line { path, parameter } => {
                let along = parameter.state(time);
                let interval = path.spline.interval(along[0]);
                for axis in 0..step.from.len() {
                    sample.set(axis, derivatives_along_path(path, interval, axis, along));
                }
            }
        }
        if time > 0.0 {
            sample.positions.iter_mut().take(RODS).for_each(|length| *length += self.lift);
        } else {
            sample.positions.copy_from_slice(&step.from);
        }
    }

    /// Superposes the segment on a sample: adds its displacement from the corner that it shares with the other segment, and the derivatives of its displacement.
    ///
    /// # Arguments
    /// * `time` – since the start of this segment (s)
    /// * `corner` – positions of all axes where the two segments meet (m or rad)
    pub(super) fn superpose(&self, step: &Step, time: f64, corner: &[f64], sample: &mut Sample) {
        for (axis, corner) in corner.iter().enumerate() {
            let [p, v, a, j] = self.state(step, axis, time);
            sample.positions[axis] += p - corner;
            sample.velocities[axis] += v;
            sample.accelerations[axis] += a;
            sample.jerks[axis] += j;
        }
    }
}

impl CacheKeyPart for Segment {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { motion, lift } = self;
        key.add(&**motion).add(lift);
    }
}
