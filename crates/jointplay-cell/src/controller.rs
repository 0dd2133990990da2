//! A simulated controller: a robot that executes one program after another, each checked before it moves.

use crate::EntityId;
use crate::check::{CheckResult, Report};
use crate::planner::{IncrementalPlanner, PlanError, PlanOptions};
use crate::program::{Program, RobotState, WaferLocation, WaferLocations};
use crate::station::WaferRules;
use crate::trajectory::Trajectory;
use crate::validate::InvalidPart;
use crate::workcell::Cell;

/// Robot, wafers and settings between the programs of a host.
///
/// Each program starts where the last one ended: with the positions of the axes, the locations of the wafers, and the settings of `SPEED` and `BLEND`.
/// The time between two programs is not simulated: process times of stations count within one program only, and the rules for stays and visits of wafers are not checked, because they concern whole lots.
///
/// # Example
/// ```
/// use jointplay_cell::controller::Controller;
/// use jointplay_cell::workcell::Cell;
///
/// /// Whether a controller of a cell starts at home.
/// fn is_at_home(cell: Cell) -> bool {
///     let Ok(controller) = Controller::new(cell) else { return false };
///     let axes = &controller.cell().robot.axes;
///     axes.iter().zip(&controller.state().positions).all(|(axis, &at)| axis.home == at)
/// }
/// ```
pub struct Controller {
    /// The cell, with the present locations of the wafers.
    cell: Cell,
    at_start: Cell,
    /// Identity at the start of each wafer, in the order of the present locations.
    wafers: Vec<EntityId>,
    state: RobotState,
    planner: IncrementalPlanner,
}

/// A program that the check has passed, ready to be executed.
#[derive(Debug, Clone)]
pub struct Execution {
    /// The motion.
    pub trajectory: Trajectory,
    /// Its report.
    pub report: Report,
    end: RobotState,
}

/// Why a controller does not execute a program.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// No trajectory exists.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The check found violations.
    #[error("the check found {} violations", .0.violations.len())]
    Violations(Box<Report>),
}

impl Controller {
    /// A controller with the robot at home, and the wafers where the cell has them.
    ///
    /// # Errors
    /// All invalid parts of the cell.
    pub fn new(cell: Cell) -> Result<Self, Vec<InvalidPart>> {
        cell.validate()?;
        let cell = Cell { rules: WaferRules::default(), ..cell };
        let state = RobotState::home(&cell.robot);
        let (wafers, planner) = (identities(&cell), IncrementalPlanner::default());
        Ok(Self { at_start: cell.clone(), cell, wafers, state, planner })
    }

    /// The cell, with the present locations of the wafers.
    #[must_use]
    pub fn cell(&self) -> &Cell {
        &self.cell
    }

    /// Identities of all wafers at the start, in the order of [`Self::locations`]: a wafer keeps its identity wherever it is placed.
    #[must_use]
    pub fn wafers(&self) -> &[EntityId] {
        &self.wafers
    }

    /// The state of the robot after the last program.
    #[must_use]
    pub fn state(&self) -> &RobotState {
        &self.state
    }

    /// Plans and checks a program from the present state, which does not change.
    ///
    /// # Errors
    /// [`Refusal`]
    pub fn plan(
        &mut self,
        program: &Program,
        options: &PlanOptions<'_>,
    ) -> Result<Execution, Refusal> {
        let plan = self.planner.plan_from(&self.cell, program, &self.state, options)?;
        match plan.report.result {
            CheckResult::Passed | CheckResult::NoMotion => {
                let (trajectory, report, end) = (plan.trajectory, plan.report, plan.end);
                Ok(Execution { trajectory, report, end })
            }
            CheckResult::Failed => Err(Refusal::Violations(Box::new(plan.report))),
        }
    }

    /// Moves to the end of an execution that was planned from the present state.
    pub fn complete(&mut self, execution: &Execution) {
        self.hand_off(execution, execution.trajectory.steps.len());
        self.state = execution.end.clone();
    }

    /// Moves to the end of a step of an execution that was planned from the present state; the steps after it are not executed.
    ///
    /// # Arguments
    /// * `step` – the last executed step, see [`Execution::stopping_step`]
    pub fn stop_after(&mut self, execution: &Execution, step: usize) {
        let Some(last) = execution.trajectory.steps.get(step) else {
            return self.complete(execution);
        };
        let (positions, speed_scaling) = (last.to.clone(), last.speed_scaling);
        let blend_radius = last.blend_radius;
        self.hand_off(execution, step + 1);
        // Whether the arms are retracted there is not recorded: the next turn retracts them.
        self.state = RobotState { positions, arms_retracted: false, speed_scaling, blend_radius };
    }

    /// Locations of the wafers after the last program.
    #[must_use]
    pub fn locations(&self) -> WaferLocations {
        WaferLocations::at_start(&self.cell)
    }

    /// Moves the robot home and the wafers to where they were at the start.
    pub fn reset(&mut self) {
        self.cell = self.at_start.clone();
        self.wafers = identities(&self.cell);
        self.state = RobotState::home(&self.cell.robot);
    }

    /// Applies the hand-offs of the first steps.
    fn hand_off(&mut self, execution: &Execution, steps: usize) {
        let steps = &execution.trajectory.steps[..steps];
        let locations = WaferLocations::of_steps(&self.cell, steps);
        let mut all: Vec<(WaferLocation, EntityId)> = locations
            .wafers()
            .map(|wafer| (locations.location(wafer), self.wafers[wafer]))
            .collect();
        // Slots come first, as in the order of locations at the start.
        all.sort_unstable_by_key(|(location, _)| *location);
        let places = || all.iter().map(|(location, _)| *location);
        self.cell.occupied = places().filter_map(WaferLocation::slot).collect();
        self.cell.loaded_effectors = places().filter_map(WaferLocation::effector).collect();
        self.wafers = all.iter().map(|(_, wafer)| *wafer).collect();
    }
}

/// Identities of all wafers at the start.
fn identities(cell: &Cell) -> Vec<EntityId> {
    let locations = WaferLocations::at_start(cell);
    locations.wafers().map(|wafer| locations.wafer_id(wafer)).collect()
}

impl Execution {
    /// Locations of the wafers at a time of the motion (s).
    ///
    /// # Arguments
    /// * `cell` – the cell of the controller before this execution
    #[must_use]
    pub fn locations_at(&self, cell: &Cell, time: f64) -> WaferLocations {
        let ended = self.trajectory.step_at(time);
        WaferLocations::of_steps(cell, &self.trajectory.steps[..ended])
    }

    /// The step after whose end the robot can be at rest, if a stop is commanded at a time (s): the first end of a step from that time on that is not blended with the next step.
    #[must_use]
    pub fn stopping_step(&self, time: f64) -> usize {
        let trajectory = &self.trajectory;
        let present = trajectory.step_at(time);
        let at_rest = |step: &usize| trajectory.blend(*step).is_none();
        (present..trajectory.steps.len()).find(at_rest).unwrap_or(present)
    }
}
