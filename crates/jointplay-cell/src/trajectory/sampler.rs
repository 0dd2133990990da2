//! States of the moving axes of a step at many times.

use std::borrow::Cow;

use super::axis_state::{AxisState, StateColumns};
use super::segment_motion::{SegmentMotion, by_chain_rule};
use super::spline::advanced;
use super::trajectory::Trajectory;

/// States of the moving axes of a step at times in growing order.
///
/// A sampler is used for one step after the other, so that its memory is allocated once.
#[derive(Default)]
pub(crate) struct AxisSampler {
    /// Indices of the axes that move in the step, in growing order.
    moving: Vec<usize>,
    /// States of each moving axis, by time; spare entries keep their memory for steps with more moving axes.
    states: Vec<StateColumns>,
    /// Times since the start of the segment (s).
    in_segment: Vec<f64>,
    /// States of the path parameter, where the step is a line.
    along: StateColumns,
}

impl AxisSampler {
    /// Samples a step.
    ///
    /// # Arguments
    /// * `times` – since the start of the step, in growing order (s)
    pub(crate) fn sample_step(&mut self, trajectory: &Trajectory, index: usize, times: &[f64]) {
        let (step, segment) = (&trajectory.steps[index], &trajectory.segments[index]);
        self.moving = trajectory.moving_axes(index);
        if self.states.len() < self.moving.len() {
            self.states.resize_with(self.moving.len(), StateColumns::default);
        }
        let overlaps = trajectory.half_overlaps(index);
        let duration = segment.duration();
        let in_segment = |time_in_step: f64| (time_in_step + overlaps.previous).max(0.0);
        self.in_segment.clear();
        self.in_segment.extend(times.iter().map(|&time_in_step| in_segment(time_in_step)));
        // From the end of its segment on, the step is exactly at its end: a profile meets it to round-off only.
        let first_ended = match &**segment.motion {
            SegmentMotion::Dwell { .. } => 0,
            _ => self.in_segment.partition_point(|&time| time < duration),
        };
        let before_end = &self.in_segment[..first_ended];
        if let SegmentMotion::Line { parameter, .. } = &**segment.motion {
            self.along.resize(first_ended);
            parameter.write_states(before_end, 0.0, &mut self.along);
        }
        for (&axis, states) in self.moving.iter().zip(&mut self.states) {
            states.resize(times.len());
            let lift = segment.lift_of(axis);
            match &**segment.motion {
                SegmentMotion::Dwell { .. } => {}
                SegmentMotion::PointToPoint(profile) => {
                    profile.axes[axis].write_states(before_end, lift, states);
                }
                SegmentMotion::Line { path, .. } => {
                    let along = self.along.columns();
                    for (interval, run) in path.spline.runs(along[0]) {
                        let (start, jet) = path.spline.piece(interval, axis);
                        states.map(run, along, |along: AxisState| {
                            let jet = advanced(&jet, along[0] - start);
                            let [position, velocity, acceleration, jerk] =
                                by_chain_rule(jet, along);
                            [position + lift, velocity, acceleration, jerk]
                        });
                    }
                }
            }
            states.fill(first_ended..times.len(), [step.to[axis], 0.0, 0.0, 0.0]);
            if overlaps.previous == 0.0 && overlaps.next == 0.0 {
                continue;
            }
            for (sample, &time_in_step) in times.iter().enumerate() {
                let mut state = states.at(sample);
                if time_in_step < overlaps.previous {
                    let previous = &trajectory.segments[index - 1];
                    let time = previous.duration() + time_in_step - overlaps.previous;
                    let other = previous.state(&trajectory.steps[index - 1], axis, time);
                    superpose(&mut state, other, step.from[axis]);
                }
                let time = in_segment(time_in_step) - (duration - 2.0 * overlaps.next);
                if overlaps.next > 0.0 && time > 0.0 && index + 1 < trajectory.steps.len() {
                    let next = &trajectory.segments[index + 1];
                    let other = next.state(&trajectory.steps[index + 1], axis, time);
                    superpose(&mut state, other, step.to[axis]);
                }
                states.set(sample, state);
            }
        }
    }

    /// States of an axis by time; `None` where it does not move.
    pub(crate) fn states_of(&self, axis: usize) -> Option<&StateColumns> {
        self.moving.binary_search(&axis).ok().map(|index| &self.states[index])
    }

    /// States of an axis by time; at rest in a position where it does not move.
    pub(crate) fn states_or_at_rest(&self, axis: usize, position: f64) -> Cow<'_, StateColumns> {
        match self.states_of(axis) {
            Some(states) => Cow::Borrowed(states),
            None => Cow::Owned(StateColumns::at_rest(position, self.in_segment.len())),
        }
    }

    /// Indices of the axes that move in the step, in growing order.
    pub(crate) fn moving(&self) -> &[usize] {
        &self.moving
    }

    /// States of each of [`Self::moving`], by time.
    pub(crate) fn states(&self) -> &[StateColumns] {
        &self.states[..self.moving.len()]
    }
}

/// Adds the displacement of another segment from the corner that both share, and its derivatives.
fn superpose(state: &mut AxisState, other: AxisState, corner: f64) {
    state[0] += other[0] - corner;
    for order in 1..4 {
        state[order] += other[order];
    }
}
