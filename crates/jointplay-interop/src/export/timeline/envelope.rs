//! Ranges of the axes over a window.

use jointplay_cell::trajectory::{Sample, Trajectory};

/// Least and largest values of an axis over a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Envelope {
    /// Least and largest position, velocity and acceleration (m or rad, per s, per s²).
    pub bounds: [[f64; 2]; 3],
    /// Time during which the axis moves (s).
    pub moving: f64,
}

impl Envelope {
    pub(super) const NOTHING: Self =
        Self { bounds: [[f64::INFINITY, f64::NEG_INFINITY]; 3], moving: 0.0 };

    pub(super) fn add(&mut self, other: &Self) {
        for (all, one) in self.bounds.iter_mut().zip(&other.bounds) {
            *all = [all[0].min(one[0]), all[1].max(one[1])];
        }
        self.moving += other.moving;
    }

    pub(super) fn reach(&mut self, values: [f64; 3]) {
        for (bounds, value) in self.bounds.iter_mut().zip(values) {
            *bounds = [bounds[0].min(value), bounds[1].max(value)];
        }
    }
}

/// Least and largest values in a step: at the jumps of the jerk, between them, and at the extrema of velocities and accelerations.
pub(super) fn of_step(motion: &Trajectory, step: usize, axes: usize) -> Vec<Envelope> {
    let mut found = vec![Envelope::NOTHING; axes];
    for axis in motion.moving_axes(step) {
        found[axis].moving = motion.intrinsic_step_duration(step);
    }
    let mut last: Option<Sample> = None;
    for time in motion.jerk_discontinuities(step) {
        let now = motion.sample_in_step(step, time);
        let mut looks = Vec::new();
        if let Some(last) = &last {
            let width = now.time - last.time;
            looks.extend([0.25, 0.5, 0.75].map(|share| last.time + share * width));
            let zero = |before: f64, after: f64| {
                (before * after < 0.0).then(|| last.time + width * before / (before - after))
            };
            for axis in 0..axes {
                looks.extend(zero(last.accelerations[axis], now.accelerations[axis]));
                looks.extend(zero(last.velocities[axis], now.velocities[axis]));
            }
        }
        let between = looks.into_iter().map(|time| motion.sample_in_step(step, time));
        for sample in between.chain([now.clone()]) {
            for (axis, envelope) in found.iter_mut().enumerate() {
                let rates = (sample.velocities[axis], sample.accelerations[axis]);
                envelope.reach([sample.positions[axis], rates.0, rates.1]);
            }
        }
        last = Some(now);
    }
    found
}
