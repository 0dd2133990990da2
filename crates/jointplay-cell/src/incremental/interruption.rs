//! Interruption and progress of a computation.

/// Returns true when the computation is to stop; polled between instructions and between segments.
pub type StopRequested<'s> = &'s (dyn Fn() -> bool + Sync);

/// The computation was stopped before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the computation was stopped before its end")]
pub struct Interrupted;

/// Progress of a computation that is divided into jobs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// A number of jobs starts.
    Started {
        /// Number of jobs.
        jobs: usize,
    },
    /// One job has ended.
    JobDone,
}

/// Observer of the progress; called from several threads.
pub(crate) type Observer = dyn Fn(Progress) + Send + Sync;

/// Stop condition and progress observer of a computation.
#[derive(Clone, Copy)]
pub(crate) struct JobContext<'e> {
    pub(crate) stop: StopRequested<'e>,
    pub(crate) observer: &'e Observer,
}

impl JobContext<'static> {
    /// Without a stop condition and without an observer.
    pub(crate) fn unmonitored() -> Self {
        Self { stop: &|| false, observer: &|_| {} }
    }
}

impl JobContext<'_> {
    /// Fails once the stop condition holds.
    pub(crate) fn check_interruption(&self) -> Result<(), Interrupted> {
        if (self.stop)() { Err(Interrupted) } else { Ok(()) }
    }
}

/// The result of a computation without a stop condition.
pub(crate) fn uninterrupted<T>(result: Result<T, Interrupted>) -> T {
    result.expect("a computation without a stop condition runs to its end")
}
