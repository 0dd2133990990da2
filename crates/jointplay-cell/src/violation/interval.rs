//! What is broken in one step, sample by sample, merged into stretches of time.

use super::kind::{Kind, Unit};

/// What something is about, so that it is known again at the next sample: kind, and indices of what takes part.
pub(crate) type About = (Kind, usize, usize);

/// One thing that is broken at one time.
#[derive(Debug, Clone)]
pub(crate) struct Hit {
    pub(crate) about: About,
    /// What it is called: of two bodies that come too near and then touch, the worse of the two.
    pub(crate) kind: Kind,
    /// Larger is worse, whatever the kind.
    pub(crate) severity: f64,
    pub(crate) value: f64,
    pub(crate) limit: f64,
    pub(crate) unit: Unit,
}

/// One thing that is broken without a break.
#[derive(Debug, Clone)]
pub(crate) struct Stretch {
    /// The worst of it.
    pub(crate) hit: Hit,
    /// When that is, since the start of the step [s].
    pub(crate) worst: f64,
    /// First and last time at which it is broken, since the start of the step [s].
    pub(crate) start: f64,
    pub(crate) end: f64,
    /// Numbers of the samples at which, or before which, that is.
    pub(crate) first: usize,
    pub(crate) last: usize,
    pub(crate) detail: String,
}

/// When something was found: since the start of the step [s], and at or before which of its samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct When {
    pub(crate) time: f64,
    pub(crate) sample: usize,
}

/// All that is broken in a step so far.
#[derive(Debug, Default)]
pub(crate) struct Found(Vec<Stretch>);

impl Found {
    /// What was found so far.
    pub(crate) fn of(stretches: Vec<Stretch>) -> Self {
        Self(stretches)
    }

    /// Adds what is broken, to what was broken at the sample before where that is the same; times of one thing grow.
    pub(crate) fn add(&mut self, when: When, hit: Hit, detail: impl FnOnce() -> String) {
        let When { time, sample } = when;
        // The last of its kind: nothing is found of it before that any more.
        let open = self.0.iter_mut().rev().find(|open| open.hit.about == hit.about);
        if let Some(open) = open.filter(|open| open.last + 1 >= sample) {
            (open.end, open.last) = (time, sample);
            if hit.severity > open.hit.severity {
                (open.hit, open.worst) = (hit, time);
            }
            return;
        }
        let (first, last) = (sample, sample);
        let (worst, start, end) = (time, time, time);
        self.0.push(Stretch { hit, worst, start, end, first, last, detail: detail() });
    }

    /// Adds what was found in the next window, whose first sample is the last of the window before.
    ///
    /// # Arguments
    /// * `first` – number of that sample in the step
    pub(crate) fn join(&mut self, next: Vec<Stretch>, first: usize) {
        for mut stretch in next {
            (stretch.first, stretch.last) = (stretch.first + first, stretch.last + first);
            let open = self.0.iter_mut().rev().find(|open| open.hit.about == stretch.hit.about);
            match open.filter(|open| open.last + 1 >= stretch.first) {
                Some(open) => {
                    (open.end, open.last) = (stretch.end, stretch.last);
                    if stretch.hit.severity > open.hit.severity {
                        (open.hit, open.worst) = (stretch.hit, stretch.worst);
                    }
                }
                None => self.0.push(stretch),
            }
        }
    }

    /// All of it, what began first at the front.
    pub(crate) fn finished(mut self) -> Vec<Stretch> {
        self.0.sort_by_key(|stretch| stretch.first);
        self.0
    }
}
