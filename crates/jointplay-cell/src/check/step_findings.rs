//! Findings of one step without pairs of objects: peaks relative to limits, violations, swept boxes.

use std::ops::Range;

use super::report::Utilization;
use crate::collision::{SweptAabb, UnknownPose};
use crate::violation::{IntervalMerger, ViolationInterval};

/// Findings of one step that depend on its own motion alone; times are since the start of the step.
#[derive(Debug)]
pub(super) struct StepFindings {
    pub(super) velocity: Option<Utilization>,
    pub(super) acceleration: Option<Utilization>,
    pub(super) jerk: Option<Utilization>,
    pub(super) slip: Option<Utilization>,
    /// Largest tilt relative to its limit.
    pub(super) tilt: f64,
    /// Largest displacement of the virtual joints relative to the play budget.
    pub(super) play: f64,
    /// Number of samples.
    pub(super) samples: usize,
    pub(super) violations: Vec<ViolationInterval>,
    /// Runs of samples at which all poses are known.
    pub(super) runs: Vec<Range<usize>>,
    /// Swept boxes of the moving objects.
    pub(super) swept_boxes: Vec<Option<SweptAabb>>,
}

/// Replaces a peak by a larger one, or by an equal one that is earlier.
pub(super) fn update_peak(peak: &mut Option<Utilization>, found: Utilization) {
    let is_larger = |peak: &Utilization| {
        found.ratio > peak.ratio || (found.ratio == peak.ratio && found.time < peak.time)
    };
    if peak.as_ref().is_none_or(is_larger) {
        *peak = Some(found);
    }
}

impl StepFindings {
    /// Adds the findings of a later window of the step.
    ///
    /// # Arguments
    /// * `first` – number of its first sample in the step
    pub(super) fn join(&mut self, next: Self, first: usize) {
        let peaks = [
            (&mut self.velocity, next.velocity),
            (&mut self.acceleration, next.acceleration),
            (&mut self.jerk, next.jerk),
            (&mut self.slip, next.slip),
        ];
        for (peak, found) in peaks {
            if let Some(found) = found {
                update_peak(peak, found);
            }
        }
        self.tilt = self.tilt.max(next.tilt);
        self.play = self.play.max(next.play);
        self.samples = first + next.samples;
        let mut violations = IntervalMerger::from_intervals(std::mem::take(&mut self.violations));
        violations.join(next.violations, first);
        self.violations = violations.into_intervals();
        for run in next.runs {
            let run = run.start + first..run.end + first;
            match self.runs.last_mut() {
                Some(last) if last.end >= run.start => last.end = run.end,
                _ => self.runs.push(run),
            }
        }
        for (boxes, next) in self.swept_boxes.iter_mut().zip(next.swept_boxes) {
            match (boxes.as_mut(), next) {
                (Some(boxes), Some(next)) => boxes.join(next),
                (None, next) => *boxes = next,
                (Some(_), None) => {}
            }
        }
    }

    /// Reports a pose that is unknown although the step has poses at all its samples; no distance is evaluated then.
    pub(super) fn add_unknown_pose(&mut self, unknown: UnknownPose) {
        let mut violations = IntervalMerger::default();
        unknown.report(&mut violations);
        self.violations.extend(violations.into_intervals());
        self.violations.sort_by_key(|interval| interval.first);
        self.runs.clear();
    }
}
