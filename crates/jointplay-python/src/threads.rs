//! On how many cores work is done.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors;

/// Pools by number of threads, and the process that they belong to.
type Pools = (u32, BTreeMap<usize, Arc<ThreadPool>>);

/// The pools that were made.
///
/// A process made by `fork` has none of its parent's threads, so that pools of the parent would wait for ever there.
static POOLS: Mutex<Option<Pools>> = Mutex::new(None);

/// So few poses are done before another thread has taken them over.
const FEW: usize = 4096;

/// The most threads that are started.
const MOST: usize = jointplay::study::parallel::MOST_THREADS;

/// Where work is to be done.
pub(crate) enum Threads {
    /// In the calling thread.
    Here,
    /// On the threads of a pool.
    Pool(Arc<ThreadPool>),
}

impl Threads {
    /// The threads asked for; without a number as many as there are cores, if there is enough to do for them.
    pub(crate) fn of(threads: Option<&Bound<'_, PyAny>>, poses: usize) -> PyResult<Self> {
        let count = checked_count(threads)?;
        if count == 1 || poses <= FEW { Ok(Self::Here) } else { pool(count).map(Self::Pool) }
    }
}

/// A pool of the threads asked for; without a number as many as there are cores.
pub(crate) fn pool_of(threads: Option<&Bound<'_, PyAny>>) -> PyResult<Arc<ThreadPool>> {
    pool(checked_count(threads)?)
}

/// The number of threads asked for; without a number as many as there are cores.
pub(crate) fn checked_count(threads: Option<&Bound<'_, PyAny>>) -> PyResult<usize> {
    match threads {
        None => Ok(std::thread::available_parallelism().map_or(1, usize::from).min(MOST)),
        Some(given) => given
            .extract::<usize>()
            .ok()
            .filter(|count| (1..=MOST).contains(count))
            .ok_or_else(|| refused(given)),
    }
}

/// Error for an invalid number of threads.
fn refused(given: &Bound<'_, PyAny>) -> PyErr {
    let found = given.str().map(|text| text.to_string()).unwrap_or_default();
    let found: String = found.chars().take(20).collect();
    let message = format!(
        "threads is {found}, but has to be None, for all cores, or a number from 1 to {MOST}"
    );
    errors::input(given.py(), &message)
}

fn pool(count: usize) -> PyResult<Arc<ThreadPool>> {
    let mut kept = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let here = std::process::id();
    if kept.as_ref().is_some_and(|(process, _)| *process != here) {
        // Dropping would wait for threads that this process does not have.
        std::mem::forget(kept.take());
    }
    let (_, pools) = kept.get_or_insert_with(|| (here, BTreeMap::new()));
    if let Some(pool) = pools.get(&count) {
        return Ok(Arc::clone(pool));
    }
    let made = ThreadPoolBuilder::new()
        .num_threads(count)
        .thread_name(|index| format!("jointplay-{index}"))
        .build()
        .map_err(|error| pyo3::exceptions::PyRuntimeError::new_err(error.to_string()))?;
    Ok(Arc::clone(pools.entry(count).or_insert(Arc::new(made))))
}
