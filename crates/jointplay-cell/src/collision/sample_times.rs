//! Sample times of a segment.

use std::ops::Range;

use crate::trajectory::{SampleTimes, Trajectory};

/// Intervals between samples in one window: what is held at a time does not grow with the duration of a step.
const WINDOW: usize = 1 << 14;

/// Even times of a step, and its end; neighbouring windows share a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Samples {
    /// How many samples there are.
    pub(crate) count: usize,
    /// Times of the samples since the start of the step.
    times: SampleTimes,
}

impl Samples {
    /// The start of a step, `rate` times a second, and its end.
    pub(crate) fn of(motion: &Trajectory, step: usize, rate: f64) -> Self {
        let duration = motion.intrinsic_step_duration(step);
        // Nothing changes while all axes are at rest.
        let times = if motion.is_dwell(step) {
            SampleTimes::ends(duration)
        } else {
            SampleTimes::new(duration, rate)
        };
        Self { count: times.intervals() as usize + 1, times }
    }

    /// How many windows they are divided into.
    pub(crate) fn windows(&self) -> usize {
        (self.count - 1).div_ceil(WINDOW).max(1)
    }

    /// The samples of a window.
    pub(crate) fn window(&self, window: usize) -> Range<usize> {
        let first = window * WINDOW;
        first..(first + WINDOW + 1).min(self.count)
    }

    /// Time of a sample since the start of the step [s].
    pub(super) fn time(&self, sample: usize) -> f64 {
        self.times.time(sample as u64)
    }
}
