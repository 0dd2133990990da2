//! Sample times of a segment.

use std::ops::Range;

use crate::trajectory::Trajectory;

/// Intervals between samples in one window: what is held at a time does not grow with the duration of a step.
const WINDOW: usize = 1 << 14;

/// Even times of a step, and its end; neighbouring windows share a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Samples {
    /// How many samples there are.
    pub(crate) count: usize,
    /// Samples a second [Hz].
    rate: f64,
    /// Duration of the step [s].
    length: f64,
}

impl Samples {
    /// The start of a step, `rate` times a second, and its end.
    pub(crate) fn of(motion: &Trajectory, step: usize, rate: f64) -> Self {
        let length = motion.intrinsic_step_duration(step);
        // A last even time within a thousandth of the end is the end; nothing changes while all stand still.
        let whole = if motion.is_dwell(step) {
            usize::from(length > 0.0)
        } else {
            (length * rate - 1e-3).ceil().max(0.0) as usize
        };
        Self { count: whole + 1, rate, length }
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
        if sample + 1 == self.count { self.length } else { sample as f64 / self.rate }
    }
}
