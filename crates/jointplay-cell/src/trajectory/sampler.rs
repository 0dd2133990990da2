//! States of the moving axes of a step at many times.

use super::profile::AxisState;
use super::segment_motion::{SegmentMotion, derivatives_along_path};
use super::trajectory::Trajectory;

/// States of the moving axes of a step at times in growing order.
///
/// A sampler is used for one step after the other, so that its memory is allocated once.
#[derive(Default)]
pub(crate) struct AxisSampler {
    /// Indices of the axes that move in the step, in growing order.
    moving: Vec<usize>,
    /// States of each moving axis, by time; spare entries keep their memory for steps with more moving axes.
    states: Vec<Vec<AxisState>>,
    /// Interval of the spline and state of the path parameter at each time, where the step is a line.
    along: Vec<(usize, AxisState)>,
}

impl AxisSampler {
    /// Samples a step.
    ///
    /// # Arguments
    /// * `times` – since the start of the step, in growing order (s)
    pub(crate) fn sample_step(&mut self, trajectory: &Trajectory, index: usize, times: &[f64]) {
        let (step, segment) = (&trajectory.steps[index], &trajectory.segments[index]);
        let motion = &**segment.motion;
        self.moving = trajectory.moving_axes(index);
        if self.states.len() < self.moving.len() {
            self.states.resize_with(self.moving.len(), Vec::new);
        }
        let overlaps = trajectory.half_overlaps(index);
        let duration = segment.duration();
        let in_segment = |time_in_step: f64| (time_in_step + overlaps.previous).max(0.0);
        if let SegmentMotion::Line { path, parameter } = motion {
            let mut state = parameter.states_in_order();
            let mut interval = path.spline.intervals_in_order();
            self.along.clear();
            self.along.extend(times.iter().map(|&time_in_step| {
                let along = state(in_segment(time_in_step));
                (interval(along[0]), along)
            }));
        }
        for (&axis, states) in self.moving.iter().zip(&mut self.states) {
            states.clear();
            let end = [step.to[axis], 0.0, 0.0, 0.0];
            let ended = |time_in_step: f64| in_segment(time_in_step) >= duration;
            let lift = segment.lift_of(axis);
            let lifted = |[position, velocity, acceleration, jerk]: AxisState| {
                [position + lift, velocity, acceleration, jerk]
            };
            match motion {
                SegmentMotion::Dwell { .. } => states.extend(times.iter().map(|_| end)),
                SegmentMotion::PointToPoint(profile) => {
                    let mut in_order = profile.axes[axis].states_in_order();
                    let mut state = |time_in_step: f64| {
                        if ended(time_in_step) {
                            end
                        } else {
                            lifted(in_order(in_segment(time_in_step)))
                        }
                    };
                    states.extend(times.iter().map(|&time_in_step| state(time_in_step)));
                }
                SegmentMotion::Line { path, .. } => {
                    let state = |time_in_step: f64, &(interval, along): &(usize, AxisState)| {
                        if ended(time_in_step) {
                            end
                        } else {
                            lifted(derivatives_along_path(path, interval, axis, along))
                        }
                    };
                    let along = times.iter().zip(&self.along);
                    states.extend(along.map(|(&time_in_step, along)| state(time_in_step, along)));
                }
            }
            if overlaps.previous == 0.0 && overlaps.next == 0.0 {
                continue;
            }
            for (&time_in_step, state) in times.iter().zip(states.iter_mut()) {
                if time_in_step < overlaps.previous {
                    let previous = &trajectory.segments[index - 1];
                    let time = previous.duration() + time_in_step - overlaps.previous;
                    let other = previous.state(&trajectory.steps[index - 1], axis, time);
                    superpose(state, other, step.from[axis]);
                }
                let time = in_segment(time_in_step) - (duration - 2.0 * overlaps.next);
                if overlaps.next > 0.0 && time > 0.0 && index + 1 < trajectory.steps.len() {
                    let next = &trajectory.segments[index + 1];
                    let other = next.state(&trajectory.steps[index + 1], axis, time);
                    superpose(state, other, step.to[axis]);
                }
            }
        }
    }

    /// Indices of the axes that move in the step, in growing order.
    pub(crate) fn moving(&self) -> &[usize] {
        &self.moving
    }

    /// States of each of [`Self::moving`], by time.
    pub(crate) fn states(&self) -> &[Vec<AxisState>] {
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
