//! Parallel map over independent jobs.

use std::collections::{HashMap, HashSet};

use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

use super::cache_key::CacheKey;
use super::interruption::{Interrupted, JobContext, Progress};

/// Computes one result for each number below `count`, on the threads of the current rayon pool.
///
/// The results are in the order of the numbers, and do not depend on the number of threads.
pub(crate) fn parallel_map<T: Send>(
    count: usize,
    context: JobContext<'_>,
    compute: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, Interrupted> {
    (context.observer)(Progress::Started { jobs: count });
    let job = |number: usize| {
        context.check_interruption()?;
        let result = compute(number);
        (context.observer)(Progress::JobDone);
        Ok(result)
    };
    // Jobs differ in cost by orders of magnitude: one per task keeps all cores busy.
    (0..count).into_par_iter().with_max_len(1).map(job).collect()
}

/// Computes one result for each distinct cache key.
///
/// # Arguments
/// * `inputs` – number and cache key of each job; of jobs with equal cache keys the first is computed
pub(crate) fn compute_missing<'f, T: Send>(
    inputs: impl Iterator<Item = (usize, &'f CacheKey)>,
    context: JobContext<'_>,
    compute: impl Fn(usize) -> T + Sync,
) -> Result<HashMap<CacheKey, T>, Interrupted> {
    let mut seen = HashSet::new();
    let jobs: Vec<(usize, &CacheKey)> = inputs.filter(|(_, key)| seen.insert(*key)).collect();
    let results = parallel_map(jobs.len(), context, |job| compute(jobs[job].0))?;
    Ok(jobs.into_iter().map(|(_, key)| key.clone()).zip(results).collect())
}
