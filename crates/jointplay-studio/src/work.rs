//! Computations kept off the thread that serves.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::http::StatusCode;
use jointplay::cell::Stop;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::problem::Problem;

/// How long requests may take.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Deadlines {
    /// A request until its answer begins.
    pub(crate) request: Duration,
    /// A study, whoever reads it included.
    pub(crate) study: Duration,
}

impl Default for Deadlines {
    fn default() -> Self {
        Self { request: Duration::from_secs(60), study: Duration::from_secs(600) }
    }
}

/// How long a request waits for its turn before it is turned away.
const LONGEST_WAIT: Duration = Duration::from_secs(10);

/// The most studies that run at a time; apart from other questions, which need not wait for them.
const STUDIES: usize = 4;

/// As many threads for questions as the machine has cores, some for studies, how long they may take, and whether they are to stop.
#[derive(Clone)]
pub(crate) struct WorkerPool {
    turns: Arc<Semaphore>,
    studies: Arc<Semaphore>,
    stopping: Arc<AtomicBool>,
    pub(crate) deadlines: Deadlines,
}

impl WorkerPool {
    pub(crate) fn new(deadlines: Deadlines) -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Self {
            turns: Arc::new(Semaphore::new(cores)),
            studies: Arc::new(Semaphore::new(STUDIES)),
            stopping: Arc::new(AtomicBool::new(false)),
            deadlines,
        }
    }

    /// A turn to run a study; given back where it is dropped.
    pub(crate) fn study(&self) -> Result<OwnedSemaphorePermit, Problem> {
        Arc::clone(&self.studies).try_acquire_owned().map_err(|_| {
            let detail = format!("{STUDIES} studies are running; end one, or wait for it");
            Problem::unavailable(StatusCode::SERVICE_UNAVAILABLE, detail)
        })
    }

    /// Computes an answer on a thread of its own.
    pub(crate) async fn run<T: Send + 'static>(
        &self,
        compute: impl FnOnce() -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        self.run_while_awaited(|_| compute()).await
    }

    /// The same of a computation that asks now and then whether it shall stop: when the client is gone, when it took too long, and when the server ends.
    pub(crate) async fn run_while_awaited<T: Send + 'static>(
        &self,
        compute: impl FnOnce(Stop<'_>) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        // Dropped with this future, which nobody awaits any more then.
        let awaited = Arc::new(());
        let (gone, stopping) = (Arc::downgrade(&awaited), Arc::clone(&self.stopping));
        let turn = Arc::clone(&self.turns).acquire_owned();
        let Ok(Ok(turn)) = tokio::time::timeout(LONGEST_WAIT, turn).await else {
            let detail = "all cores are busy with other requests; try again in a while";
            return Err(Problem::unavailable(StatusCode::SERVICE_UNAVAILABLE, detail));
        };
        let computed = tokio::task::spawn_blocking(move || {
            let stop = move || gone.strong_count() == 0 || stopping.load(Ordering::Relaxed);
            let answer = compute(&stop);
            drop(turn);
            answer
        });
        let answer = computed.await;
        drop(awaited);
        answer.unwrap_or_else(|_| Err(Problem::broken("the computation broke down")))
    }

    /// Computations that run at the moment.
    #[cfg(test)]
    pub(crate) fn running(&self) -> usize {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        cores - self.turns.available_permits()
    }

    /// Tells long computations to end.
    pub(crate) fn stop(&self) {
        self.stopping.store(true, Ordering::Relaxed);
    }

    /// Whether a long computation is to end.
    pub(crate) fn stopping(&self) -> bool {
        self.stopping.load(Ordering::Relaxed)
    }
}
