//! Findings of one segment by itself: shares of limits, violations, swept boxes.

use std::ops::Range;

use super::report::Share;
use crate::collision::{Around, Lost};
use crate::violation::{Found, Stretch};

/// What is found of a step by itself; times are since its start.
#[derive(Debug)]
pub(super) struct Alone {
    pub(super) velocity: Option<Share>,
    pub(super) acceleration: Option<Share>,
    pub(super) jerk: Option<Share>,
    pub(super) slip: Option<Share>,
    pub(super) tilt: f64,
    pub(super) play: f64,
    /// Whether each axis moves.
    pub(super) moved: Vec<bool>,
    pub(super) samples: usize,
    pub(super) found: Vec<Stretch>,
    /// Samples between which it is known where everything is.
    pub(super) runs: Vec<Range<usize>>,
    /// The room around the way of each thing that moves.
    pub(super) around: Vec<Option<Around>>,
}

/// Keeps the largest share, and of those the earliest.
pub(super) fn raise(most: &mut Option<Share>, share: Share) {
    let is_more = |most: &Share| {
        share.share > most.share || (share.share == most.share && share.time < most.time)
    };
    if most.as_ref().is_none_or(is_more) {
        *most = Some(share);
    }
}

impl Alone {
    /// Adds what a later window of the step comes to.
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
        for (most, share) in peaks {
            if let Some(share) = share {
                raise(most, share);
            }
        }
        self.tilt = self.tilt.max(next.tilt);
        self.play = self.play.max(next.play);
        for (moved, also) in self.moved.iter_mut().zip(next.moved) {
            *moved |= also;
        }
        self.samples = first + next.samples;
        let mut found = Found::of(std::mem::take(&mut self.found));
        found.join(next.found, first);
        self.found = found.finished();
        for run in next.runs {
            let run = run.start + first..run.end + first;
            match self.runs.last_mut() {
                Some(last) if last.end >= run.start => last.end = run.end,
                _ => self.runs.push(run),
            }
        }
        for (around, next) in self.around.iter_mut().zip(next.around) {
            match (around.as_mut(), next) {
                (Some(around), Some(next)) => around.join(next),
                (None, next) => *around = next,
                (Some(_), None) => {}
            }
        }
    }

    /// Reports a pose that is unknown though the step was found to have all of them; its distances are not followed then.
    pub(super) fn lost(&mut self, lost: Lost) {
        let mut found = Found::default();
        lost.report(&mut found);
        self.found.extend(found.finished());
        self.found.sort_by_key(|stretch| stretch.first);
        self.runs.clear();
    }
}
