//! What was found of the last plan, so that a change costs what it changes.

use crate::check::{CheckOptions, Checks, Report};
use crate::incremental::{CacheStats, Interrupted, Job, Run, Stop, never, whole};
use crate::program::{IkCache, Program, ProgramError, Step, expand_by};
use crate::trajectory::{SegmentCache, Trajectory, TrajectoryError, TrajectoryOptions};
use crate::workcell::Cell;

/// Steps, motions and checks of the last plan, move by move.
///
/// A place is looked for anew where its station is another or the robot comes from elsewhere.
/// A move is plan_trajectory and checked anew where anything that it depends on has other bits than in the last plan: its ends, limits, what is carried, and what stands within reach of its way.
/// What comes out is the same as without a memory, to the bit: [`expand`](crate::program::expand), [`plan_trajectory`](crate::trajectory::plan_trajectory) and [`check`](crate::check::check) are these functions of an empty one.
///
/// It holds what the last plan came to, and no more.
pub struct IncrementalPlanner {
    places: IkCache,
    ways: SegmentCache,
    checks: Checks,
    run: Box<dyn Fn(usize, Job<'_>) + Send>,
}

/// Why [`IncrementalPlanner::plan`] returns no motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// It was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The program has errors.
    #[error("the program has {} errors", .0.len())]
    Program(Vec<ProgramError>),
    /// Steps of it cannot be plan_trajectory.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
}

impl Default for IncrementalPlanner {
    fn default() -> Self {
        Self::run_by(|count, job| (0..count).for_each(job))
    }
}

impl IncrementalPlanner {
    /// An empty one, whose moves somebody runs who may have threads for it.
    ///
    /// # Arguments
    /// * `run` – does a job for all numbers below the one given, in any order or at the same time: what comes out is the same
    ///
    /// # Example
    /// ```
    /// use jointplay_cell::IncrementalPlanner;
    ///
    /// let memory = IncrementalPlanner::run_by(|count, job| {
    ///     std::thread::scope(|scope| {
    ///         for first in 0..2 {
    ///             scope.spawn(move || (first..count).step_by(2).for_each(job));
    ///         }
    ///     });
    /// });
    /// assert_eq!(memory.limit_cache_stats().misses, 0);
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
    /// [`PlanError`]
    pub fn plan(
        &mut self,
        cell: &Cell,
        program: &Program,
        (motion, check): (&TrajectoryOptions, &CheckOptions),
        stop: Stop<'_>,
    ) -> Result<(Trajectory, Report), PlanError> {
        let run = Run { jobs: &*self.run, stop };
        let steps = expand_by(cell, program, &mut self.places, stop)?;
        let steps = steps.map_err(PlanError::Program)?;
        let motion = self.ways.plan_trajectory(cell, steps, motion, run)??;
        let report = self.checks.check(cell, &motion, check, run)?;
        Ok((motion, report))
    }

    /// Of the places in the last program.
    #[must_use]
    pub fn ik_cache_stats(&self) -> CacheStats {
        self.places.reuse()
    }

    /// Of the ways of the axes in the last motion.
    #[must_use]
    pub fn segment_cache_stats(&self) -> CacheStats {
        self.ways.reuse()
    }

    /// Of the moves by themselves in the last check: axes, tilt, play and slip.
    #[must_use]
    pub fn limit_cache_stats(&self) -> CacheStats {
        self.checks.limit_cache_stats()
    }

    /// Of the moves among all bodies in the last check.
    #[must_use]
    pub fn distance_cache_stats(&self) -> CacheStats {
        self.checks.distance_cache_stats()
    }
}
