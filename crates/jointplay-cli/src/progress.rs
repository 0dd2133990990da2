//! How far long work has come.

use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};

use crate::output::short;

/// A bar on standard error, for people only, and only when the work takes more than a second; gone with the work.
pub(crate) struct Progress {
    start: Instant,
    kind: Kind,
    total: u64,
    /// Where it began, and where it is.
    begun: u64,
    done: u64,
    stage: String,
    bar: Option<ProgressBar>,
}

/// What the work is made of.
#[derive(Clone, Copy)]
enum Kind {
    /// Parts, each with a name.
    Parts,
    /// Samples, many a second.
    Samples,
}

impl Progress {
    /// Of so many parts.
    pub(crate) fn new(total: usize) -> Self {
        Self::of(Kind::Parts, total as u64, 0)
    }

    /// Of so many samples, some of which may be there already.
    pub(crate) fn of_samples(total: u64, begun: u64) -> Self {
        Self::of(Kind::Samples, total, begun)
    }

    fn of(kind: Kind, total: u64, begun: u64) -> Self {
        let (start, stage) = (Instant::now(), String::new());
        Self { start, kind, total, begun, done: begun, stage, bar: None }
    }

    pub(crate) fn stage(&mut self, name: &str) {
        name.clone_into(&mut self.stage);
        self.at(0);
    }

    pub(crate) fn part_done(&mut self, count: usize) {
        self.done += count as u64;
        self.at(0);
    }

    pub(crate) fn at(&mut self, within_part: usize) {
        self.show(self.done + within_part as u64);
    }

    /// So many samples are there now.
    pub(crate) fn samples(&mut self, samples: u64) {
        self.done = samples;
        self.show(samples);
    }

    /// Samples a second, and seconds since the beginning.
    pub(crate) fn pace(&self) -> (f64, f64) {
        let time = self.start.elapsed().as_secs_f64();
        ((self.done - self.begun) as f64 / time, time)
    }

    fn show(&mut self, position: u64) {
        if self.bar.is_none() && self.start.elapsed() > Duration::from_secs(1) {
            let bar = ProgressBar::new(self.total).with_position(self.begun);
            self.bar = Some(bar.with_style(self.kind.style()));
        }
        if let Some(bar) = &self.bar {
            bar.set_message(self.stage.clone());
            bar.set_position(position);
        }
    }
}

impl Kind {
    fn style(self) -> ProgressStyle {
        let rate = |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            let _ = write!(text, "{}", short(state.per_sec()));
        };
        let left = |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            let _ = write!(text, "{}", HumanDuration(state.eta()));
        };
        let template = match self {
            Self::Parts => "{msg:>16} {wide_bar} {percent}%  {left} left",
            Self::Samples => {
                "{human_pos} of {human_len} samples {wide_bar} {percent}%  {rate}/s  {left} left"
            }
        };
        let style = ProgressStyle::with_template(template).expect("the template is well-formed");
        style.with_key("rate", rate).with_key("left", left)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}
