//! Computations on worker threads, apart from the thread that serves requests.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::http::StatusCode;
use jointplay::cell::StopRequested;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::display::{display_units, with_units};
use crate::problem::Problem;

/// Deadlines of requests.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Deadlines {
    /// From the start of a request to the start of its response.
    pub(crate) request: Duration,
    /// From the start to the end of a study, including its transfer.
    pub(crate) study: Duration,
}

impl Default for Deadlines {
    fn default() -> Self {
        Self { request: Duration::from_secs(60), study: Duration::from_secs(600) }
    }
}

/// Longest time that a request waits for a free worker.
const MAX_WAIT: Duration = Duration::from_secs(10);

/// Maximum number of concurrent studies; they do not block other requests.
const MAX_STUDIES: usize = 4;

/// Maximum number of concurrent exports, of which each takes much memory, and one worker.
const MAX_EXPORTS: usize = 1;

/// Workers for requests, one per core, and for studies and exports, with deadlines and a stop flag.
#[derive(Clone)]
pub(crate) struct WorkerPool {
    workers: Arc<Semaphore>,
    studies: Arc<Semaphore>,
    exports: Arc<Semaphore>,
    stopping: Arc<AtomicBool>,
    pub(crate) deadlines: Deadlines,
}

impl WorkerPool {
    pub(crate) fn new(deadlines: Deadlines) -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Self {
            workers: Arc::new(Semaphore::new(cores)),
            studies: Arc::new(Semaphore::new(MAX_STUDIES)),
            exports: Arc::new(Semaphore::new(MAX_EXPORTS)),
            stopping: Arc::new(AtomicBool::new(false)),
            deadlines,
        }
    }

    /// A permit to run a study, returned on drop.
    pub(crate) fn study(&self) -> Result<OwnedSemaphorePermit, Problem> {
        Arc::clone(&self.studies).try_acquire_owned().map_err(|_| {
            let detail = format!(
                "{MAX_STUDIES} studies are running, which is the maximum; stop one or wait"
            );
            Problem::unavailable(StatusCode::SERVICE_UNAVAILABLE, detail)
        })
    }

    /// A permit to export, returned on drop: an export that has been abandoned blocks the next one, and no other request.
    pub(crate) fn export(&self) -> Result<OwnedSemaphorePermit, Problem> {
        Arc::clone(&self.exports).try_acquire_owned().map_err(|_| {
            let detail = "another export is running; wait for it to end";
            Problem::unavailable(StatusCode::SERVICE_UNAVAILABLE, detail)
        })
    }

    /// Runs a computation on a worker thread.
    pub(crate) async fn run<T: Send + 'static>(
        &self,
        compute: impl FnOnce() -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        self.run_while_awaited(|_| compute()).await
    }

    /// Runs a computation that polls whether to stop: the client has disconnected, the deadline has passed, or the server is shutting down.
    pub(crate) async fn run_while_awaited<T: Send + 'static>(
        &self,
        compute: impl FnOnce(StopRequested<'_>) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        // Dropped with this future when the client disconnects.
        let awaited = Arc::new(());
        let (gone, stopping) = (Arc::downgrade(&awaited), Arc::clone(&self.stopping));
        let permit = Arc::clone(&self.workers).acquire_owned();
        let Ok(Ok(permit)) = tokio::time::timeout(MAX_WAIT, permit).await else {
            let detail = "all workers are busy with other requests; try again later";
            return Err(Problem::unavailable(StatusCode::SERVICE_UNAVAILABLE, detail));
        };
        let units = display_units();
        let computed = tokio::task::spawn_blocking(move || {
            let stop = move || gone.strong_count() == 0 || stopping.load(Ordering::Relaxed);
            let answer = with_units(units, || compute(&stop));
            drop(permit);
            answer
        });
        let answer = computed.await;
        drop(awaited);
        answer.unwrap_or_else(|_| Err(Problem::broken("the computation failed unexpectedly")))
    }

    /// Number of running computations.
    #[cfg(test)]
    pub(crate) fn running(&self) -> usize {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        cores - self.workers.available_permits()
    }

    /// Requests that all computations stop.
    pub(crate) fn stop(&self) {
        self.stopping.store(true, Ordering::Relaxed);
    }

    /// Whether computations are to stop.
    pub(crate) fn stopping(&self) -> bool {
        self.stopping.load(Ordering::Relaxed)
    }
}
