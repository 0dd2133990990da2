//! Progress and interruption of long computations.

use std::io::Write as _;
use std::sync::Once;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::failure::INTERRUPTED;
use crate::output::short;
use crate::{console, folder};

/// A progress bar on standard error, if that is a terminal; shown after one second, and removed at the end.
pub(crate) struct Progress {
    start: Instant,
    /// Samples or parts at the start.
    begun: u64,
    done: u64,
    bar: ProgressBar,
    /// Closed at the end; the thread shows the bar after a second.
    working: Option<Sender<()>>,
    shows: Option<JoinHandle<()>>,
}

/// The unit of progress.
#[derive(Clone, Copy)]
enum Kind {
    /// Named parts.
    Parts,
    /// Samples, with their rate.
    Samples,
    /// One computation of unknown duration.
    Work,
}

/// Delay before the bar appears.
const DELAY: Duration = Duration::from_secs(1);
/// Interval at which the bar is redrawn.
const TICK: Duration = Duration::from_millis(200);

impl Progress {
    /// Progress over a number of parts; Ctrl-C ends the command.
    pub(crate) fn new(total: usize) -> Self {
        end_on_interrupt();
        Self::of(Kind::Parts, total as u64, 0)
    }

    /// Progress of one computation; Ctrl-C ends the command.
    pub(crate) fn of_work(name: &str) -> Self {
        end_on_interrupt();
        let mut progress = Self::of(Kind::Work, 0, 0);
        progress.stage(name);
        progress
    }

    /// Progress over a number of samples, some of which may be computed already.
    pub(crate) fn of_samples(total: u64, begun: u64) -> Self {
        Self::of(Kind::Samples, total, begun)
    }

    fn of(kind: Kind, total: u64, begun: u64) -> Self {
        let target = ProgressDrawTarget::hidden();
        let bar = match kind {
            Kind::Work => ProgressBar::with_draw_target(None, target),
            Kind::Parts | Kind::Samples => ProgressBar::with_draw_target(Some(total), target),
        };
        let bar = bar.with_position(begun).with_style(kind.style());
        let (working, ended) = channel();
        let shown = bar.clone();
        let show = move || {
            if ended.recv_timeout(DELAY) == Err(RecvTimeoutError::Timeout) {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(TICK);
            }
        };
        // Without a thread there is no bar, but the computation continues.
        let shows = (!console::is_quiet())
            .then(|| std::thread::Builder::new().name("progress".to_owned()).spawn(show).ok());
        let (start, shows) = (Instant::now(), shows.flatten());
        Self { start, begun, done: begun, bar, working: Some(working), shows }
    }

    /// A handle for reporting from other threads.
    pub(crate) fn reporter(&self) -> Reporter {
        Reporter(self.bar.clone())
    }

    pub(crate) fn stage(&mut self, name: &str) {
        self.bar.set_message(name.to_owned());
    }

    pub(crate) fn part_done(&mut self, count: usize) {
        self.done += count as u64;
        self.at(0);
    }

    pub(crate) fn at(&mut self, within_part: usize) {
        self.bar.set_position(self.done + within_part as u64);
    }

    /// Sets the number of samples computed.
    pub(crate) fn samples(&mut self, samples: u64) {
        self.done = samples;
        self.at(0);
    }

    /// Rate (samples/s) and time since the start (s).
    pub(crate) fn pace(&self) -> (f64, f64) {
        let time = self.start.elapsed().as_secs_f64();
        ((self.done - self.begun) as f64 / time, time)
    }
}

/// A handle of a [`Progress`] for other threads.
#[derive(Clone)]
pub(crate) struct Reporter(ProgressBar);

impl Reporter {
    /// Starts a named stage.
    pub(crate) fn stage(&self, name: &str) {
        self.0.set_message(name.to_owned());
    }

    /// Sets the number of parts of the stage.
    pub(crate) fn parts(&self, total: usize) {
        self.0.set_length(total as u64);
        self.0.set_position(0);
    }

    /// Completes one part.
    pub(crate) fn part_done(&self) {
        self.0.inc(1);
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
            Self::Work => "{spinner} {msg}  {elapsed}",
        };
        let style = ProgressStyle::with_template(template).expect("the template is well-formed");
        style.with_key("rate", rate).with_key("left", left)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.working = None;
        if let Some(shows) = self.shows.take() {
            // A panicked thread has nothing to clear.
            drop(shows.join());
        }
        self.bar.finish_and_clear();
    }
}

/// Makes Ctrl-C end the command with its exit code, unless the command handles it; files are written last and completely.
fn end_on_interrupt() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let end = || {
            folder::discard_pending();
            drop(writeln!(anstream::stderr(), "\ninterrupted"));
            #[expect(clippy::exit, reason = "the computation has no cancellation point")]
            std::process::exit(i32::from(INTERRUPTED));
        };
        // Without a handler the signal ends the command.
        drop(ctrlc::set_handler(end));
    });
}
