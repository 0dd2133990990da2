//! Violations as they are found, sample by sample, merged into stretches of time.

use std::collections::BTreeMap;

use super::report::{Kind, Unit, Violation};
use crate::program::Step;

/// What something is about, so that it is known again at the next sample: kind, and indices of what takes part.
pub(super) type About = (Kind, usize, usize);

/// One thing that is broken at one sample.
pub(super) struct Hit {
    pub(super) about: About,
    /// What it is called: of two bodies that come too near and then touch, the worse of the two.
    pub(super) kind: Kind,
    /// Larger is worse, whatever the kind.
    pub(super) severity: f64,
    pub(super) value: f64,
    pub(super) limit: f64,
    pub(super) unit: Unit,
}

struct Open {
    violation: Violation,
    severity: f64,
    /// Number of the last sample at which it was broken.
    sample: usize,
}

/// All violations so far.
#[derive(Default)]
pub(super) struct Found {
    open: BTreeMap<About, Open>,
    closed: Vec<Violation>,
}

/// When something was found.
#[derive(Clone, Copy)]
pub(super) struct When<'a> {
    pub(super) time: f64,
    pub(super) sample: usize,
    pub(super) index: usize,
    pub(super) step: &'a Step,
}

impl Found {
    /// Adds what is broken at a sample, to what was broken at the sample before where that is the same.
    pub(super) fn add(
        &mut self,
        when: When<'_>,
        hit: &Hit,
        words: impl FnOnce() -> (Vec<String>, String),
    ) {
        if let Some(open) = self.open.get_mut(&hit.about) {
            let violation = &mut open.violation;
            let same = violation.instruction == when.step.instruction;
            if same && open.sample + 1 >= when.sample {
                open.sample = when.sample;
                violation.end = violation.end.max(when.time);
                violation.start = violation.start.min(when.time);
                if hit.severity > open.severity {
                    open.severity = hit.severity;
                    violation.kind = hit.kind;
                    violation.worst = hit.value;
                    violation.limit = hit.limit;
                    violation.worst_time = when.time;
                    violation.step = when.index;
                    violation.phase = when.step.phase;
                }
                return;
            }
        }
        let (names, detail) = words();
        let violation = Violation {
            kind: hit.kind,
            names,
            instruction: when.step.instruction,
            place: when.step.place,
            step: when.index,
            phase: when.step.phase,
            start: when.time,
            end: when.time,
            worst_time: when.time,
            worst: hit.value,
            limit: hit.limit,
            unit: hit.unit,
            detail,
        };
        let open = Open { violation, severity: hit.severity, sample: when.sample };
        if let Some(over) = self.open.insert(hit.about, open) {
            self.closed.push(over.violation);
        }
    }

    /// All of them by time, and those of one time by kind.
    pub(super) fn finished(mut self) -> Vec<Violation> {
        self.closed.extend(self.open.into_values().map(|open| open.violation));
        self.closed.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.kind.cmp(&b.kind)));
        self.closed
    }
}
