//! Incremental planning: expansion, trajectory and check of a program, with results of the previous plan reused.

use crate::check::{CheckCache, CheckOptions, Report};
use crate::incremental::{CacheStats, Interrupted, JobContext, Observer, Progress, StopRequested};
use crate::program::{Expansion, IkCache, Program, ProgramError, RobotState, expand_by};
use crate::trajectory::{SegmentCache, Trajectory, TrajectoryError, TrajectoryOptions};
use crate::validate::InvalidPart;
use crate::workcell::Cell;

/// Plans and checks programs; results of the previous plan are reused where their inputs have not changed.
///
/// Inverse kinematics is solved again where the station or the preceding position of the robot has changed.
/// A segment is planned and checked again where any of its inputs has changed by a bit: its ends, its limits, the held wafers, and the collision objects within reach of its path.
/// The results are equal, to the bit, to those of a new planner: [`expand`](crate::program::expand), [`plan_trajectory`](crate::trajectory::plan_trajectory) and [`check`](crate::check::check).
///
/// The cache contains results of the previous plan only.
/// Segments are planned and checked in parallel, on the threads of the current rayon pool; the results do not depend on their number.
///
/// # Example
/// ```
/// use jointplay_cell::IncrementalPlanner;
///
/// let planner = IncrementalPlanner::default();
/// assert_eq!(planner.findings_cache_stats().misses, 0);
/// ```
pub struct IncrementalPlanner {
    ik_cache: IkCache,
    segment_cache: SegmentCache,
    checks: CheckCache,
    observer: Box<Observer>,
}

/// Options of [`IncrementalPlanner::plan`].
#[derive(Clone, Copy)]
pub struct PlanOptions<'a> {
    /// Options of the trajectory.
    pub trajectory: TrajectoryOptions,
    /// Options of the check.
    pub check: CheckOptions,
    /// Polled between instructions and between segments; true stops the computation.
    pub stop: StopRequested<'a>,
    /// Called at the start of each stage.
    pub on_stage: &'a dyn Fn(PlanStage),
}

/// Stage of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlanStage {
    /// From the program to steps.
    Expansion,
    /// From steps to the trajectory.
    Trajectory,
    /// Check of the trajectory.
    Check,
}

impl Default for PlanOptions<'_> {
    fn default() -> Self {
        let (trajectory, check) = (TrajectoryOptions::default(), CheckOptions::default());
        Self { trajectory, check, stop: &|| false, on_stage: &|_| {} }
    }
}

/// A checked trajectory, and the state of the robot at its end.
pub(crate) struct PlannedMotion {
    pub(crate) trajectory: Trajectory,
    pub(crate) report: Report,
    pub(crate) end: RobotState,
}

/// Why [`IncrementalPlanner::plan`] returns no trajectory.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The cell is invalid.
    #[error("the description of the cell has {} errors, the first: {}", .0.len(), .0.first().map_or_else(String::new, ToString::to_string))]
    Cell(Vec<InvalidPart>),
    /// The computation was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The program has errors.
    #[error("the program has {} errors", .0.len())]
    Program(Vec<ProgramError>),
    /// No trajectory exists for some steps.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
}

impl Default for IncrementalPlanner {
    fn default() -> Self {
        Self::with_observer(|_| {})
    }
}

impl IncrementalPlanner {
    /// A planner without a previous plan, whose progress is observed.
    ///
    /// # Arguments
    /// * `observer` – called from several threads, when jobs begin and when each of them ends
    #[must_use]
    pub fn with_observer(observer: impl Fn(Progress) + Send + Sync + 'static) -> Self {
        Self {
            ik_cache: IkCache::default(),
            segment_cache: SegmentCache::default(),
            checks: CheckCache::default(),
            observer: Box::new(observer),
        }
    }

    /// Validates the cell, then expands, plans and checks a program; the computation can be stopped.
    ///
    /// Results computed before a stop are reused by the next plan.
    ///
    /// # Errors
    /// [`PlanError`]
    pub fn plan(
        &mut self,
        cell: &Cell,
        program: &Program,
        options: &PlanOptions<'_>,
    ) -> Result<(Trajectory, Report), PlanError> {
        cell.validate().map_err(PlanError::Cell)?;
        let start = RobotState::home(&cell.robot);
        let plan = self.plan_from(cell, program, &start, options)?;
        Ok((plan.trajectory, plan.report))
    }

    /// As [`Self::plan`], of a valid cell and from a state of the robot that is within its limits.
    ///
    /// # Errors
    /// [`PlanError`]
    pub(crate) fn plan_from(
        &mut self,
        cell: &Cell,
        program: &Program,
        start: &RobotState,
        options: &PlanOptions<'_>,
    ) -> Result<PlannedMotion, PlanError> {
        let PlanOptions { trajectory, check, stop, on_stage } = *options;
        let context = JobContext { stop, observer: &*self.observer };
        on_stage(PlanStage::Expansion);
        let expanded = expand_by(cell, program, start, &mut self.ik_cache, stop)?;
        let Expansion { steps, end } = expanded.map_err(PlanError::Program)?;
        on_stage(PlanStage::Trajectory);
        let planned = self.segment_cache.plan_trajectory(cell, steps, &trajectory, context)??;
        on_stage(PlanStage::Check);
        let report = self.checks.check(cell, &planned, &check, context)?;
        Ok(PlannedMotion { trajectory: planned, report, end })
    }

    /// Cache statistics of the inverse kinematics of the last program.
    #[must_use]
    pub fn ik_cache_stats(&self) -> CacheStats {
        self.ik_cache.stats()
    }

    /// Cache statistics of the segments of the last trajectory.
    #[must_use]
    pub fn segment_cache_stats(&self) -> CacheStats {
        self.segment_cache.stats()
    }

    /// Cache statistics of the findings of the last check that concern no pair of bodies: limits, slip and safe zones.
    #[must_use]
    pub fn findings_cache_stats(&self) -> CacheStats {
        self.checks.findings_stats()
    }

    /// Cache statistics of the distances of the last check.
    #[must_use]
    pub fn distance_cache_stats(&self) -> CacheStats {
        self.checks.distance_stats()
    }
}
