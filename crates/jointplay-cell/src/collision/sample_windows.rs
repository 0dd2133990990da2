//! Sample times of a step.

use std::ops::Range;

use crate::trajectory::{Trajectory, UniformSampling};

/// Intervals between samples in one window: memory does not grow with the duration of a step.
const WINDOW: usize = 1 << 14;

/// Sample times of a step, divided into windows; neighbouring windows share a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SampleWindows {
    /// Number of samples.
    pub(crate) count: usize,
    /// Times of the samples since the start of the step.
    times: UniformSampling,
}

impl SampleWindows {
    /// Sample times of a step at a rate (Hz), its end included.
    pub(crate) fn new(trajectory: &Trajectory, step: usize, rate: f64) -> Self {
        let duration = trajectory.intrinsic_step_duration(step);
        // Nothing changes while all axes are at rest.
        let times = if trajectory.is_dwell(step) {
            UniformSampling::ends(duration)
        } else {
            UniformSampling::new(duration, rate)
        };
        Self { count: times.intervals() as usize + 1, times }
    }

    /// Number of windows.
    pub(crate) fn windows(&self) -> usize {
        (self.count - 1).div_ceil(WINDOW).max(1)
    }

    /// Samples of a window.
    pub(crate) fn window(&self, window: usize) -> Range<usize> {
        let first = window * WINDOW;
        first..(first + WINDOW + 1).min(self.count)
    }

    /// Time of a sample since the start of the step (s).
    pub(super) fn time(&self, sample: usize) -> f64 {
        self.times.time(sample as u64)
    }
}
