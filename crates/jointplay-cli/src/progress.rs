//! How far long work has come.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// A bar on standard error, for people only, and only when the work takes more than a second; gone with the work.
pub(crate) struct Progress {
    start: Instant,
    total: u64,
    done: u64,
    stage: String,
    bar: Option<ProgressBar>,
}

impl Progress {
    pub(crate) fn new(total: usize) -> Self {
        Self {
            start: Instant::now(),
            total: total as u64,
            done: 0,
            stage: String::new(),
            bar: None,
        }
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
        if self.bar.is_none() && self.start.elapsed() > Duration::from_secs(1) {
            let style = ProgressStyle::with_template("{msg:>16} {wide_bar} {percent}%  {eta} left")
                .expect("the template is well-formed");
            self.bar = Some(ProgressBar::new(self.total).with_style(style));
        }
        if let Some(bar) = &self.bar {
            bar.set_message(self.stage.clone());
            bar.set_position(self.done + within_part as u64);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}
