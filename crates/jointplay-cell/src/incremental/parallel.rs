//! Parallel map over independent jobs.

use std::collections::{BTreeMap, BTreeSet};

use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

use super::fingerprint::Fingerprint;
use super::interruption::{Execution, Interrupted, Progress};

/// Computes one result for each number below `count`, on the threads of the current rayon pool.
///
/// The results are in the order of the numbers, and do not depend on the number of threads.
pub(crate) fn parallel_map<T: Send>(
    count: usize,
    execution: Execution<'_>,
    compute: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, Interrupted> {
    (execution.observer)(Progress::Started { jobs: count });
    let job = |number: usize| {
        execution.check_interruption()?;
        let result = compute(number);
        (execution.observer)(Progress::JobDone);
        Ok(result)
    };
    // Jobs differ in cost by orders of magnitude: one per task keeps all cores busy.
    (0..count).into_par_iter().with_max_len(1).map(job).collect()
}

/// Computes one result for each distinct fingerprint.
///
/// # Arguments
/// * `inputs` – number and fingerprint of each job; of jobs with equal fingerprints the first is computed
pub(crate) fn compute_missing<'f, T: Send>(
    inputs: impl Iterator<Item = (usize, &'f Fingerprint)>,
    execution: Execution<'_>,
    compute: impl Fn(usize) -> T + Sync,
) -> Result<BTreeMap<Fingerprint, T>, Interrupted> {
    let mut seen = BTreeSet::new();
    let jobs: Vec<(usize, &Fingerprint)> =
        inputs.filter(|(_, fingerprint)| seen.insert(*fingerprint)).collect();
    let results = parallel_map(jobs.len(), execution, |job| compute(jobs[job].0))?;
    Ok(jobs.into_iter().map(|(_, fingerprint)| fingerprint.clone()).zip(results).collect())
}
