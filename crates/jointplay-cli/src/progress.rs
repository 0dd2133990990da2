//! How far long work has come.

use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
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

/// How often a bar is drawn.
const TICK: Duration = Duration::from_millis(100);

/// A bar as [`Progress`], drawn by a thread of its own: it shows that time passes where the work reports nothing for a while.
pub(crate) struct Steady {
    state: Arc<Mutex<State>>,
    /// Dropped where the work ends.
    end: Option<Sender<()>>,
    drawing: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct State {
    stage: String,
    done: u64,
    total: u64,
}

/// What reports to a [`Steady`] bar.
#[derive(Clone)]
pub(crate) struct Reporter(Arc<Mutex<State>>);

impl Steady {
    pub(crate) fn new() -> Self {
        let state = Arc::new(Mutex::new(State::default()));
        let (end, ended) = channel::<()>();
        let shown = Reporter(Arc::clone(&state));
        let draw = move || {
            if ended.recv_timeout(Duration::from_secs(1)) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            let template = "{spinner} {msg:>10} {wide_bar} {pos} of {len}  {elapsed}";
            let style =
                ProgressStyle::with_template(template).expect("the template is well-formed");
            let bar = ProgressBar::new(1).with_style(style);
            loop {
                shown.with(|state| {
                    bar.set_length(state.total.max(1));
                    bar.set_position(state.done);
                    bar.set_message(state.stage.clone());
                });
                bar.tick();
                if ended.recv_timeout(TICK) != Err(RecvTimeoutError::Timeout) {
                    bar.finish_and_clear();
                    return;
                }
            }
        };
        // Without a thread there is no bar, and the work is done all the same.
        let drawing = std::thread::Builder::new().spawn(draw).ok();
        Self { state, end: Some(end), drawing }
    }

    pub(crate) fn reporter(&self) -> Reporter {
        Reporter(Arc::clone(&self.state))
    }
}

impl Reporter {
    fn with(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// Work of a name begins.
    pub(crate) fn stage(&self, name: &str) {
        self.with(|state| name.clone_into(&mut state.stage));
    }

    /// So many parts of it follow.
    pub(crate) fn parts(&self, total: usize) {
        self.with(|state| (state.done, state.total) = (0, total as u64));
    }

    /// A part is done.
    pub(crate) fn part_done(&self) {
        self.with(|state| state.done += 1);
    }
}

impl Drop for Steady {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(drawing) = self.drawing.take() {
            // It panics nowhere; if it did, that would be no fault of the work.
            let _ = drawing.join();
        }
    }
}
