//! What was found of the last plan, so that a change costs what it changes.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, OnceLock};

use crate::cell::Cell;
use crate::check::{CheckOptions, Checks, Report};
use crate::program::{IkCache, Program, ProgramError, Step, expand_by};
use crate::trajectory::{SegmentCache, Trajectory, TrajectoryError, TrajectoryOptions};

/// Steps, motions and checks of the last plan, move by move.
///
/// A place is looked for anew where its station is another or the robot comes from elsewhere.
/// A move is timed and checked anew where anything that it depends on has other bits than in the last plan: its ends, limits, what is carried, and what stands within reach of its way.
/// What comes out is the same as without a memory, to the bit: [`expand`](crate::program::expand), [`plan_trajectory`](crate::trajectory::plan_trajectory) and [`check`](crate::check::check) are these functions of an empty one.
///
/// It holds what the last plan came to, and no more.
pub struct Memory {
    places: IkCache,
    ways: SegmentCache,
    checks: Checks,
    run: Box<dyn Fn(usize, Job<'_>) + Send>,
}

/// What is to be done for each number.
pub type Job<'j> = &'j (dyn Fn(usize) + Sync);

/// Returns true when the computation shall stop; it is called between instructions and between moves.
pub type Stop<'s> = &'s (dyn Fn() -> bool + Sync);

/// The computation was stopped before its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the computation was stopped before its end")]
pub struct Interrupted;

/// Why [`Memory::plan`] returns no motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unplanned {
    /// It was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The program has errors.
    #[error("the program has {} errors", .0.len())]
    Program(Vec<ProgramError>),
    /// Steps of it cannot be timed.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
}

/// How jobs are run, and when they stop.
#[derive(Clone, Copy)]
pub(crate) struct Run<'r> {
    jobs: &'r dyn Fn(usize, Job<'_>),
    stop: Stop<'r>,
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

fn never() -> bool {
    false
}

/// The result of a computation that nothing stops.
pub(crate) fn whole<T>(result: Result<T, Interrupted>) -> T {
    result.expect("a computation that is never asked to stop runs to its end")
}

impl Default for Memory {
    fn default() -> Self {
        Self::run_by(one_by_one)
    }
}

/// How much of the last plan was made anew, and how much was known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Reuse {
    /// Known from the plan before.
    pub known: usize,
    /// The same as an earlier one of this plan.
    pub repeated: usize,
    /// Made anew.
    pub anew: usize,
}

impl Memory {
    /// An empty one, whose moves somebody runs who may have threads for it.
    ///
    /// # Arguments
    /// * `run` – does a job for all numbers below the one given, in any order or at the same time: what comes out is the same
    ///
    /// # Example
    /// ```
    /// use jointplay_cell::Memory;
    ///
    /// let memory = Memory::run_by(|count, job| {
    ///     std::thread::scope(|scope| {
    ///         for first in 0..2 {
    ///             scope.spawn(move || (first..count).step_by(2).for_each(job));
    ///         }
    ///     });
    /// });
    /// assert_eq!(memory.reuse_of_moves().anew, 0);
    /// ```
    #[must_use]
    pub fn run_by(run: impl Fn(usize, Job<'_>) + Send + 'static) -> Self {
        let (places, ways, checks) =
            (IkCache::default(), SegmentCache::default(), Checks::default());
        Self { places, ways, checks, run: Box::new(run) }
    }

    /// As [`expand`](crate::program::expand).
    ///
    /// # Errors
    /// As [`expand`](crate::program::expand).
    pub fn expand(
        &mut self,
        cell: &Cell,
        program: &Program,
    ) -> Result<Vec<Step>, Vec<ProgramError>> {
        whole(expand_by(cell, program, &mut self.places, &never))
    }

    /// As [`plan_trajectory`](crate::trajectory::plan_trajectory).
    ///
    /// # Errors
    /// As [`plan_trajectory`](crate::trajectory::plan_trajectory).
    pub fn plan_trajectory(
        &mut self,
        cell: &Cell,
        steps: Vec<Step>,
        options: &TrajectoryOptions,
    ) -> Result<Trajectory, TrajectoryError> {
        let run = Run { jobs: &*self.run, stop: &never };
        whole(self.ways.plan_trajectory(cell, steps, options, run))
    }

    /// As [`check`](crate::check::check).
    #[must_use]
    pub fn check(&mut self, cell: &Cell, motion: &Trajectory, options: &CheckOptions) -> Report {
        whole(self.checks.check(cell, motion, options, Run { jobs: &*self.run, stop: &never }))
    }

    /// [`Self::expand`], [`Self::plan_trajectory`] and [`Self::check`] in one, which can be stopped.
    ///
    /// What was computed before a stop is reused by the next plan.
    ///
    /// # Arguments
    /// * `stop` – called between instructions and between moves; true stops the computation
    ///
    /// # Errors
    /// [`Unplanned`]
    pub fn plan(
        &mut self,
        cell: &Cell,
        program: &Program,
        (motion, check): (&TrajectoryOptions, &CheckOptions),
        stop: Stop<'_>,
    ) -> Result<(Trajectory, Report), Unplanned> {
        let run = Run { jobs: &*self.run, stop };
        let steps = expand_by(cell, program, &mut self.places, stop)?;
        let steps = steps.map_err(Unplanned::Program)?;
        let motion = self.ways.plan_trajectory(cell, steps, motion, run)??;
        let report = self.checks.check(cell, &motion, check, run)?;
        Ok((motion, report))
    }

    /// Of the places in the last program.
    #[must_use]
    pub fn reuse_of_places(&self) -> Reuse {
        self.places.reuse()
    }

    /// Of the ways of the axes in the last motion.
    #[must_use]
    pub fn reuse_of_ways(&self) -> Reuse {
        self.ways.reuse()
    }

    /// Of the moves by themselves in the last check: axes, tilt, play and slip.
    #[must_use]
    pub fn reuse_of_moves(&self) -> Reuse {
        self.checks.reuse_of_moves()
    }

    /// Of the moves among all bodies in the last check.
    #[must_use]
    pub fn reuse_of_distances(&self) -> Reuse {
        self.checks.reuse_of_distances()
    }
}

/// Inputs, bit by bit.
pub(crate) type Key = Vec<u64>;

/// Adds numbers to a key.
pub(crate) fn extend(key: &mut Key, numbers: &[f64]) {
    key.extend(numbers.iter().map(|number| number.to_bits()));
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

/// Results by their inputs: those of the last round, and those of this one.
pub(crate) struct Kept<T> {
    /// Inputs that all results share.
    shared: String,
    last: BTreeMap<Key, Arc<T>>,
    now: BTreeMap<Key, Arc<T>>,
    reuse: Reuse,
}

impl<T> Default for Kept<T> {
    fn default() -> Self {
        let (last, now) = (BTreeMap::new(), BTreeMap::new());
        Self { shared: String::new(), last, now, reuse: Reuse::default() }
    }
}

impl<T> Kept<T> {
    /// A round begins; nothing is known where the shared inputs are others.
    pub(crate) fn begin(&mut self, shared: &str) {
        // What is left of the round before last is of a round that was interrupted.
        self.last.append(&mut self.now);
        self.reuse = Reuse::default();
        if self.shared != shared {
            self.last.clear();
            shared.clone_into(&mut self.shared);
        }
    }

    /// The result for a key, made where it is not known.
    pub(crate) fn get<E>(
        &mut self,
        key: Key,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<Arc<T>, E> {
        if let Some(known) = self.now.get(&key) {
            self.reuse.repeated += 1;
            return Ok(Arc::clone(known));
        }
        let found = match self.last.remove(&key) {
            Some(known) => {
                self.reuse.known += 1;
                known
            }
            None => {
                self.reuse.anew += 1;
                Arc::new(make()?)
            }
        };
        self.now.insert(key, Arc::clone(&found));
        Ok(found)
    }

    /// Whether [`Self::get`] would not have to make it.
    pub(crate) fn knows(&self, key: &Key) -> bool {
        self.now.contains_key(key) || self.last.contains_key(key)
    }

    /// A round ends: what it did not ask for is forgotten.
    pub(crate) fn end(&mut self) {
        self.last.clear();
    }

    pub(crate) fn reuse(&self) -> Reuse {
        self.reuse
    }
}
