//! The state of all axes at one time.

use jointplay_core::sampling;

use super::axis_state::AxisState;

/// Positions of all axes with their first three derivatives, at one time of a trajectory.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sample {
    /// Time since the start of the trajectory, or of the step where a function states it (s).
    pub time: f64,
    /// Index of the step.
    pub step: usize,
    /// Position of each axis (m or rad).
    pub positions: Vec<f64>,
    /// Velocity of each axis (m/s or rad/s).
    pub velocities: Vec<f64>,
    /// Acceleration of each axis (m/s² or rad/s²).
    pub accelerations: Vec<f64>,
    /// Jerk of each axis (m/s³ or rad/s³).
    pub jerks: Vec<f64>,
}

impl Sample {
    /// Sets everything to zero for a number of axes.
    pub(super) fn reset(&mut self, axes: usize) {
        for values in
            [&mut self.positions, &mut self.velocities, &mut self.accelerations, &mut self.jerks]
        {
            values.clear();
            values.resize(axes, 0.0);
        }
    }

    /// Sets the state of one axis.
    pub(super) fn set(&mut self, axis: usize, state: AxisState) {
        self.positions[axis] = state[0];
        self.velocities[axis] = state[1];
        self.accelerations[axis] = state[2];
        self.jerks[axis] = state[3];
    }
}

/// Uniform sampling of a duration: times at a constant rate from its start, and its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformSampling {
    duration: f64,
    rate: f64,
    intervals: u64,
}

impl UniformSampling {
    /// Uniform sampling of a duration.
    ///
    /// # Arguments
    /// * `duration` – time from the first sample to the last (s)
    /// * `rate` – number of samples a second (Hz)
    #[must_use]
    pub fn new(duration: f64, rate: f64) -> Self {
        Self { duration, rate, intervals: sampling::intervals(duration, rate) }
    }

    /// Start and end of a duration (s); the start alone where the duration is 0.
    #[must_use]
    pub fn ends(duration: f64) -> Self {
        Self { duration, rate: 1.0, intervals: u64::from(duration > 0.0) }
    }

    /// Number of intervals between the samples; there is one sample more than intervals.
    #[must_use]
    pub fn intervals(&self) -> u64 {
        self.intervals
    }

    /// Time of a sample since the first; from the last on it is the duration (s).
    #[must_use]
    pub fn time(&self, sample: u64) -> f64 {
        let time = sample as f64 / self.rate;
        if sample >= self.intervals { self.duration } else { time }
    }

    /// All times, in growing order.
    pub fn iter(self) -> impl Iterator<Item = f64> {
        (0..=self.intervals).map(move |sample| self.time(sample))
    }
}
