//! The robot of a host as an observer of its session sees it.

use std::collections::VecDeque;
use std::sync::Arc;

use jointplay_cell::controller::{Controller, Execution};
use jointplay_cell::program::{WaferLocation, WaferLocations};
use jointplay_cell::trajectory::{Trajectory, TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::Cell;

use super::refusal::RefusalReason;
use crate::export::{Error, Frame, MotionExport, frames};

/// Number of events that are kept for observers.
const MOST_EVENTS: usize = 20;

/// Outcome of a command of a host.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Its motion started.
    Accepted {
        /// Duration of the motion (s).
        duration: f64,
    },
    /// Its motion ended as planned.
    Completed {
        /// Duration of the motion (s).
        duration: f64,
    },
    /// Its motion was stopped.
    Stopped {
        /// Duration of the executed part of the motion (s).
        duration: f64,
    },
    /// It was refused.
    Refused {
        /// Kind of the refusal.
        reason: RefusalReason,
        /// Why, in words.
        message: String,
    },
}

/// A command of a host and what became of it.
#[derive(Debug, Clone, PartialEq)]
pub struct HostEvent {
    /// When, by the clock of the caller of the session (s).
    pub time: f64,
    /// Text of the command.
    pub command: String,
    /// Outcome of the command.
    pub outcome: Outcome,
}

/// The last events of a session, the oldest first.
#[derive(Debug, Clone, Default)]
pub(super) struct EventLog {
    pub(super) now: f64,
    events: VecDeque<HostEvent>,
}

impl EventLog {
    pub(super) fn push(&mut self, command: &str, outcome: Outcome) {
        if self.events.len() == MOST_EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(HostEvent { time: self.now, command: command.to_owned(), outcome });
    }
}

/// A motion in execution.
#[derive(Clone)]
pub(super) struct Executed {
    pub(super) command: String,
    pub(super) execution: Arc<Execution>,
    /// When it started, by the clock of the caller (s).
    pub(super) start: f64,
    /// Time of the motion at which it ends (s).
    pub(super) end: f64,
}

/// The robot of a host from one event of its session to the next, independent of the session.
#[derive(Clone)]
pub struct HostSnapshot {
    cell: Cell,
    wafer_names: Vec<String>,
    positions: Vec<f64>,
    executed: Option<Executed>,
    speed: f64,
    events: Vec<HostEvent>,
}

/// State of the robot of a host at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct HostState {
    /// The command in execution; `None` at rest.
    pub command: Option<String>,
    /// Time since the start of the motion, by the time of the robot (s); zero at rest.
    pub elapsed: f64,
    /// Duration of the motion, by the time of the robot (s); zero at rest.
    pub duration: f64,
    /// Positions of all axes, rods first ((m), (rad)).
    pub positions: Vec<f64>,
    /// All wafers by their names at the start, with their present locations.
    pub wafers: Vec<(String, WaferLocation)>,
}

impl HostSnapshot {
    pub(super) fn new(
        controller: &Controller,
        executed: Option<Executed>,
        speed: f64,
        log: &EventLog,
    ) -> Self {
        let cell = controller.cell();
        Self {
            cell: cell.clone(),
            wafer_names: controller.wafers().iter().map(|&id| cell.entity_name(id)).collect(),
            positions: controller.state().positions.clone(),
            executed,
            speed,
            events: log.events.iter().cloned().collect(),
        }
    }

    /// The cell, with the wafers where they were before the motion in execution.
    #[must_use]
    pub fn cell(&self) -> &Cell {
        &self.cell
    }

    /// The last commands and what became of them, the oldest first.
    #[must_use]
    pub fn events(&self) -> &[HostEvent] {
        &self.events
    }

    /// Time of the motion in execution at a time of the caller's clock (s).
    fn elapsed(&self, executed: &Executed, now: f64) -> f64 {
        ((now - executed.start) * self.speed).clamp(0.0, executed.end)
    }

    /// The state of the robot.
    ///
    /// # Arguments
    /// * `now` – by the clock of the caller of the session (s)
    #[must_use]
    pub fn state_at(&self, now: f64) -> HostState {
        let named = |locations: &WaferLocations| {
            let names = self.wafer_names.iter().cloned();
            names.zip(locations.wafers().map(|wafer| locations.location(wafer))).collect()
        };
        match &self.executed {
            Some(executed) => {
                let elapsed = self.elapsed(executed, now);
                let trajectory = &executed.execution.trajectory;
                HostState {
                    command: Some(executed.command.clone()),
                    elapsed,
                    duration: executed.end,
                    positions: trajectory.sample_at(elapsed).positions,
                    wafers: named(&executed.execution.locations_at(&self.cell, elapsed)),
                }
            }
            None => HostState {
                command: None,
                elapsed: 0.0,
                duration: 0.0,
                positions: self.positions.clone(),
                wafers: named(&WaferLocations::at_start(&self.cell)),
            },
        }
    }

    /// All moving frames at a time, named as in the scene of the cell at the start; see [`frames`](crate::export::frames).
    ///
    /// # Arguments
    /// * `now` – by the clock of the caller of the session (s)
    ///
    /// # Errors
    /// [`Error::Placing`]
    pub fn frames_at(&self, now: f64) -> Result<Vec<Frame>, Error> {
        let found = match &self.executed {
            Some(executed) => {
                let elapsed = self.elapsed(executed, now);
                let motion = &executed.execution.trajectory;
                self.frames_of(motion, elapsed, &motion.sample_at(elapsed).positions)
            }
            None => {
                let rest = plan_trajectory(&self.cell, Vec::new(), &TrajectoryOptions::default());
                let Ok(rest) = rest else { return Ok(Vec::new()) };
                self.frames_of(&rest, 0.0, &self.positions)
            }
        };
        found.map(|mut found| {
            let first = found.len().saturating_sub(self.wafer_names.len());
            for (frame, name) in found[first..].iter_mut().zip(&self.wafer_names) {
                frame.name.clone_from(name);
            }
            found
        })
    }

    fn frames_of(
        &self,
        motion: &Trajectory,
        time: f64,
        positions: &[f64],
    ) -> Result<Vec<Frame>, Error> {
        let motion_export =
            MotionExport { cell: &self.cell, motion, program: "", violation_notes: &[] };
        frames(&motion_export, time, positions).map(|(frames, _)| frames)
    }
}
