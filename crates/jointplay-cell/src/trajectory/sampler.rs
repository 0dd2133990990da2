//! A step at many times, axis by axis.

use super::profile::AxisState;
use super::{Segment, Trajectory, on_line};

/// What the axes of a step do at times that grow.
///
/// It is used for one step after the other, so that its room is taken once.
#[derive(Default)]
pub(crate) struct AxisSampler {
    /// Axes that do anything in the step, as indices in growing order.
    moving: Vec<usize>,
    /// Of each of them, by time; there may be more than there are axes that move.
    states: Vec<Vec<AxisState>>,
    /// Where along a line they are, and in which interval of it.
    along: Vec<(usize, AxisState)>,
}

impl AxisSampler {
    /// Takes up a step.
    ///
    /// # Arguments
    /// * `times` – since its start, growing [s]
    pub(crate) fn take(&mut self, motion: &Trajectory, index: usize, times: &[f64]) {
        let (step, way) = (&motion.steps[index], &*motion.ways[index]);
        self.moving = motion.moving(index);
        if self.states.len() < self.moving.len() {
            self.states.resize_with(self.moving.len(), Vec::new);
        }
        let [lead, tail] = motion.overlaps(index);
        let duration = way.duration();
        let own = |since: f64| (since + lead).max(0.0);
        if let Segment::Line { line, pace } = way {
            let (mut at, mut interval) = (pace.walk(), line.spline.walk());
            self.along.clear();
            self.along.extend(times.iter().map(|&since| {
                let along = at(own(since));
                (interval(along[0]), along)
            }));
        }
        for (&axis, states) in self.moving.iter().zip(&mut self.states) {
            states.clear();
            let end = [step.to[axis], 0.0, 0.0, 0.0];
            let ended = |since: f64| own(since) >= duration;
            match way {
                Segment::Dwell { .. } => states.extend(times.iter().map(|_| end)),
                Segment::PointToPoint(together) => {
                    let mut at = together.curves[axis].walk();
                    let mut state = |since: f64| if ended(since) { end } else { at(own(since)) };
                    states.extend(times.iter().map(|&since| state(since)));
                }
                Segment::Line { line, .. } => {
                    let state = |since: f64, &(interval, along): &(usize, AxisState)| {
                        if ended(since) { end } else { on_line(line, interval, axis, along) }
                    };
                    let along = times.iter().zip(&self.along);
                    states.extend(along.map(|(&since, along)| state(since, along)));
                }
            }
            if [lead, tail] == [0.0; 2] {
                continue;
            }
            // What the step before, or the next, does beyond the corner.
            for (&since, state) in times.iter().zip(states.iter_mut()) {
                if since < lead {
                    let before = &motion.ways[index - 1];
                    let since = before.duration() + since - lead;
                    let other = before.state(&motion.steps[index - 1], axis, since);
                    add(state, other, step.from[axis]);
                }
                let next = own(since) - (duration - 2.0 * tail);
                if tail > 0.0 && next > 0.0 && index + 1 < motion.steps.len() {
                    let other = motion.ways[index + 1].state(&motion.steps[index + 1], axis, next);
                    add(state, other, step.to[axis]);
                }
            }
        }
    }

    /// Axes that do anything in the step, as indices in growing order.
    pub(crate) fn moving(&self) -> &[usize] {
        &self.moving
    }

    /// Of each of [`Self::moving`], by time.
    pub(crate) fn states(&self) -> &[Vec<AxisState>] {
        &self.states[..self.moving.len()]
    }
}

/// Adds what another step does beyond a corner.
fn add(state: &mut AxisState, other: AxisState, corner: f64) {
    state[0] += other[0] - corner;
    for order in 1..4 {
        state[order] += other[order];
    }
}
