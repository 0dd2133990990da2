//! Steps in time.
//!
//! ```text
//!   Path::Axes   from ──▶ to     every axis jerk-limited, all in the time of the slowest
//!   Path::Line   from ──▶ to     q(s): the wafer's centre straight, its plane turning evenly;  s(t): every axis within its limits
//! ```

mod axes;
mod cubic;
mod limits;
mod line;
mod pace;
mod plan;
mod spline;

pub use limits::{dynamics, limits_of, moves};
pub use plan::{MotionError, MotionOptions, StepProblem, timed};

use crate::program::Step;

/// All axes at one time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sample {
    /// Since the start [s].
    pub time: f64,
    /// Index of the step.
    pub step: usize,
    /// Of each axis [m or rad].
    pub positions: Vec<f64>,
    /// Of each axis [m/s or rad/s].
    pub velocities: Vec<f64>,
    /// Of each axis [m/s² or rad/s²].
    pub accelerations: Vec<f64>,
    /// Of each axis [m/s³ or rad/s³].
    pub jerks: Vec<f64>,
}

/// Steps with their times.
#[derive(Debug, Clone)]
pub struct Motion {
    /// In order.
    pub steps: Vec<Step>,
    /// Start of each step, and the end of the last [s].
    pub times: Vec<f64>,
    /// How the axes go in each step.
    ways: Vec<Way>,
}

/// How far a straight line is from straight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Straightness {
    /// Its length [m].
    pub length: f64,
    /// Largest distance of the wafer's centre from the straight line [m].
    pub deviation: f64,
    /// Largest angle between the wafer's plane and the one that turns evenly [rad].
    pub plane: f64,
}

/// How all axes go in one step.
#[derive(Debug, Clone)]
enum Way {
    Still { duration: f64 },
    Axes(axes::Together),
    Line { line: line::Line, pace: cubic::Curve },
}

impl Way {
    fn duration(&self) -> f64 {
        match self {
            Self::Still { duration } => *duration,
            Self::Axes(together) => together.duration,
            Self::Line { pace, .. } => pace.duration(),
        }
    }
}

impl Motion {
    /// How long it takes [s].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// How long a step takes [s].
    #[must_use]
    pub fn step_duration(&self, step: usize) -> f64 {
        self.times[step + 1] - self.times[step]
    }

    /// The step that runs at a time [s]: the later one where two meet, the last one from its end on.
    #[must_use]
    pub fn step_at(&self, time: f64) -> usize {
        let begun = self.times[..self.steps.len().max(1)].partition_point(|&start| start <= time);
        begun.saturating_sub(1)
    }

    /// How straight a step is that runs along a line; `None` for any other.
    #[must_use]
    pub fn straightness(&self, step: usize) -> Option<Straightness> {
        match &self.ways[step] {
            Way::Line { line, .. } => Some(Straightness {
                length: line.length,
                deviation: line.deviation,
                plane: line.plane,
            }),
            _ => None,
        }
    }

    /// The axis that would be last in a step if each went as fast as it may; `None` where none moves or a line binds them.
    #[must_use]
    pub fn slowest_axis(&self, step: usize) -> Option<usize> {
        match &self.ways[step] {
            Way::Axes(together) => together.slowest,
            _ => None,
        }
    }

    /// All axes at a time [s]; before the start and after the end, as they stand there.
    ///
    /// At the end of a step all axes are exactly where it leads.
    #[must_use]
    pub fn at(&self, time: f64) -> Sample {
        let mut sample = Sample::default();
        self.fill(time, &mut sample);
        sample
    }

    /// As [`Self::at`], into a sample that is there.
    pub fn fill(&self, time: f64, sample: &mut Sample) {
        sample.time = time;
        sample.step = self.step_at(time);
        let Some(step) = self.steps.get(sample.step) else { return };
        let count = step.from.len();
        for values in [
            &mut sample.positions,
            &mut sample.velocities,
            &mut sample.accelerations,
            &mut sample.jerks,
        ] {
            values.clear();
            values.resize(count, 0.0);
        }
        let since = (time - self.times[sample.step]).max(0.0);
        let way = &self.ways[sample.step];
        if since >= way.duration() || time >= self.duration() {
            sample.positions.copy_from_slice(&step.to);
            return;
        }
        match way {
            Way::Still { .. } => sample.positions.copy_from_slice(&step.from),
            Way::Axes(together) => {
                for (axis, curve) in together.curves.iter().enumerate() {
                    sample.set(axis, curve.at(since));
                }
            }
            Way::Line { line, pace } => {
                let [s, rate, acceleration, jerk] = pace.at(since);
                let interval = line.spline.interval(s);
                for axis in 0..count {
                    let [q, slope, curvature, third] = line.spline.jet(interval, axis, s);
                    let state = [
                        q,
                        slope * rate,
                        curvature * rate * rate + slope * acceleration,
                        third * rate.powi(3) + 3.0 * curvature * rate * acceleration + slope * jerk,
                    ];
                    sample.set(axis, state);
                }
            }
        }
    }

    /// All axes at even times from the start, `rate` a second, and at the end [Hz].
    pub fn samples(&self, rate: f64) -> impl Iterator<Item = Sample> + '_ {
        self.sample_times(rate).map(|time| self.at(time))
    }

    /// The times of [`Self::samples`].
    pub(crate) fn sample_times(&self, rate: f64) -> impl Iterator<Item = f64> + use<> {
        let duration = self.duration();
        // A last even time within a thousandth of the end is the end.
        let whole = (duration * rate - 1e-3).ceil().max(0.0);
        (0..whole as u64).map(move |k| k as f64 / rate).chain([duration])
    }
}

impl Sample {
    fn set(&mut self, axis: usize, state: cubic::State) {
        self.positions[axis] = state[0];
        self.velocities[axis] = state[1];
        self.accelerations[axis] = state[2];
        self.jerks[axis] = state[3];
    }
}
