//! Violations of one step, merged from sample to sample into intervals of time.

use super::kind::{ViolationKind, ViolationQuantity};

/// Subject of a violation, to recognize it at the next sample: a kind, and indices of the parts concerned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Subject {
    pub(crate) kind: ViolationKind,
    pub(crate) first: usize,
    pub(crate) second: usize,
}

impl Subject {
    /// A violation of the robot as a whole.
    pub(crate) fn of(kind: ViolationKind) -> Self {
        Self { kind, first: 0, second: 0 }
    }
}

/// Violation at one sample.
#[derive(Debug, Clone)]
pub(crate) struct SampleViolation {
    pub(crate) subject: Subject,
    /// Kind that is reported: of a clearance violation that becomes a contact, the worse of the two.
    pub(crate) kind: ViolationKind,
    /// Larger is worse, whatever the kind.
    pub(crate) severity: f64,
    pub(crate) value: f64,
    pub(crate) limit: f64,
    pub(crate) quantity: ViolationQuantity,
}

/// Violation over an interval of time without interruption.
#[derive(Debug, Clone)]
pub(crate) struct ViolationInterval {
    /// The worst sample.
    pub(crate) worst: SampleViolation,
    /// Time of the worst sample since the start of the step (s).
    pub(crate) worst_time: f64,
    /// Start of the interval since the start of the step (s).
    pub(crate) start: f64,
    /// End of the interval since the start of the step (s).
    pub(crate) end: f64,
    /// First sample at which, or before which, the violation occurs.
    pub(crate) first: usize,
    /// Last sample at which, or before which, the violation occurs.
    pub(crate) last: usize,
    pub(crate) detail: String,
}

/// Time of a finding since the start of the step (s), and the sample at or before which it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SampleTime {
    pub(crate) time: f64,
    pub(crate) sample: usize,
}

/// Merges violations at successive samples into intervals.
#[derive(Debug, Default)]
pub(crate) struct IntervalMerger(Vec<ViolationInterval>);

impl IntervalMerger {
    /// A merger that continues intervals found before.
    pub(crate) fn from_intervals(intervals: Vec<ViolationInterval>) -> Self {
        Self(intervals)
    }

    /// Adds a violation; it extends the interval of its subject if that reaches to the sample before. The times of one subject must not decrease.
    pub(crate) fn add(
        &mut self,
        at: SampleTime,
        violation: SampleViolation,
        detail: impl FnOnce() -> String,
    ) {
        let SampleTime { time, sample } = at;
        // The last interval of the subject: earlier ones are closed.
        let open = self.0.iter_mut().rev().find(|open| open.worst.subject == violation.subject);
        if let Some(open) = open.filter(|open| open.last + 1 >= sample) {
            (open.end, open.last) = (time, sample);
            if violation.severity > open.worst.severity {
                (open.worst, open.worst_time) = (violation, time);
            }
            return;
        }
        self.0.push(ViolationInterval {
            worst: violation,
            worst_time: time,
            start: time,
            end: time,
            first: sample,
            last: sample,
            detail: detail(),
        });
    }

    /// Adds intervals in the order of their first samples, such as those of the next window, whose first sample is the last of the window before.
    ///
    /// # Arguments
    /// * `first` – number of that sample in the step
    pub(crate) fn join(&mut self, next: Vec<ViolationInterval>, first: usize) {
        for mut interval in next {
            (interval.first, interval.last) = (interval.first + first, interval.last + first);
            let subject = interval.worst.subject;
            let open = self.0.iter_mut().rev().find(|open| open.worst.subject == subject);
            match open.filter(|open| open.last + 1 >= interval.first) {
                Some(open) => {
                    (open.end, open.last) =
                        (open.end.max(interval.end), open.last.max(interval.last));
                    if interval.worst.severity > open.worst.severity {
                        (open.worst, open.worst_time) = (interval.worst, interval.worst_time);
                    }
                }
                None => self.0.push(interval),
            }
        }
    }

    /// All intervals in the order of their first samples.
    pub(crate) fn into_intervals(mut self) -> Vec<ViolationInterval> {
        self.0.sort_by_key(|interval| interval.first);
        self.0
    }
}
