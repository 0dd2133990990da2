//! Map over jobs, sequential or parallel.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use super::fingerprint::Key;
use super::interruption::{Interrupted, Stop};

/// What is to be done for each number.
pub type Job<'j> = &'j (dyn Fn(usize) + Sync);

/// How jobs are run, and when they stop.
#[derive(Clone, Copy)]
pub(crate) struct Run<'r> {
    pub(crate) jobs: &'r dyn Fn(usize, Job<'_>),
    pub(crate) stop: Stop<'r>,
}

impl Run<'static> {
    /// One job after the other, to the end.
    pub(crate) fn one_by_one() -> Self {
        Self { jobs: &one_by_one, stop: &never }
    }
}

impl Run<'_> {
    /// Stops where a stop is asked for.
    pub(crate) fn poll(&self) -> Result<(), Interrupted> {
        if (self.stop)() { Err(Interrupted) } else { Ok(()) }
    }
}

/// Does a job for one number after the other.
fn one_by_one(count: usize, job: Job<'_>) {
    (0..count).for_each(job);
}

pub(crate) fn never() -> bool {
    false
}

/// Makes something for each number below one.
pub(crate) fn each<T: Send + Sync>(
    count: usize,
    run: Run<'_>,
    make: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, Interrupted> {
    let made: Vec<OnceLock<T>> = (0..count).map(|_| OnceLock::new()).collect();
    let stop = run.stop;
    let job = |number: usize| {
        if let Some(place) = made.get(number)
            && !stop()
        {
            place.get_or_init(|| make(number));
        }
    };
    (run.jobs)(count, &job);
    // The runner may have left some.
    let of = |(number, made): (usize, OnceLock<T>)| match made.into_inner() {
        Some(made) => Ok(made),
        None => run.poll().map(|()| make(number)),
    };
    made.into_iter().enumerate().map(of).collect()
}

/// Makes something for each of some keys, with their numbers; once for those that are alike.
pub(crate) fn anew<'k, T: Send + Sync>(
    keys: impl Iterator<Item = (usize, &'k Key)>,
    run: Run<'_>,
    make: impl Fn(usize) -> T + Sync,
) -> Result<BTreeMap<Key, T>, Interrupted> {
    let mut seen = BTreeSet::new();
    let jobs: Vec<(usize, &Key)> = keys.filter(|(_, key)| seen.insert(*key)).collect();
    let made = each(jobs.len(), run, |place| make(jobs[place].0))?;
    Ok(jobs.into_iter().map(|(_, key)| key.clone()).zip(made).collect())
}
