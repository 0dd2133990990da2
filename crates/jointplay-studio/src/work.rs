//! Computations kept off the thread that serves.

use std::sync::Arc;
use std::time::Duration;

use axum::http::StatusCode;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::problem::Problem;

/// How long a request waits for its turn before it is turned away.
const LONGEST_WAIT: Duration = Duration::from_secs(10);

/// As many threads for computing as the machine has cores.
#[derive(Clone)]
pub(crate) struct Work {
    turns: Arc<Semaphore>,
}

impl Work {
    pub(crate) fn new() -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Self { turns: Arc::new(Semaphore::new(cores)) }
    }

    /// A turn to compute; given back where it is dropped.
    pub(crate) async fn turn(&self) -> Result<OwnedSemaphorePermit, Problem> {
        let turn = tokio::time::timeout(LONGEST_WAIT, Arc::clone(&self.turns).acquire_owned());
        match turn.await {
            Ok(Ok(turn)) => Ok(turn),
            _ => Err(Problem::unavailable(
                StatusCode::SERVICE_UNAVAILABLE,
                "all cores are busy with other requests; try again in a while",
            )),
        }
    }

    /// Computes an answer on a thread of its own.
    pub(crate) async fn run<T: Send + 'static>(
        &self,
        compute: impl FnOnce() -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let turn = self.turn().await?;
        let computed = tokio::task::spawn_blocking(move || {
            let answer = compute();
            drop(turn);
            answer
        });
        computed.await.unwrap_or_else(|_| {
            Err(Problem::unavailable(
                StatusCode::INTERNAL_SERVER_ERROR,
                "the computation broke down: a mistake of ours, please report it with this request",
            ))
        })
    }
}
