//! One sample of a study of a cell: its cell and its program, planned and checked.

use std::collections::BTreeMap;
use std::sync::Arc;

use jointplay_cell::check::{CheckResult, KeyFigures};
use jointplay_cell::program::Unit as ProgramUnit;
use jointplay_cell::workcell::Cell;
use jointplay_cell::{IncrementalPlanner, PlanError, PlanOptions};
use jointplay_study::plan::{Outcome, ProgramOutcome};

use super::sources::from_files;
use crate::cell::{self, Change};
use crate::program::{self, Setting};
use crate::units::{m_from_mm, mm};

/// A number that each sample of a cell has, in its SI unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CellQuantity {
    /// Duration of the program (s); of programs that pass the check.
    CycleTime,
    /// Wafers per hour of the repeated program (1/h); of programs that pass the check.
    WafersPerHour,
    /// Minimum distance of all pairs within the reporting range (m).
    MinimumDistance,
    /// Largest utilization of the velocity limits.
    Velocity,
    /// Largest utilization of the acceleration limits.
    Acceleration,
    /// Largest utilization of the jerk limits.
    Jerk,
    /// Largest utilization of the tilt limit.
    Tilt,
    /// Largest utilization of the play budget.
    Play,
    /// Largest utilization of friction.
    Slip,
    /// Number of violations.
    Violations,
}

impl CellQuantity {
    /// Its value, NaN if the program has none.
    fn of(self, figures: &KeyFigures, result: CheckResult) -> f64 {
        let passed = |value: Option<f64>| value.filter(|_| result == CheckResult::Passed);
        let value = match self {
            Self::CycleTime => passed(Some(figures.duration)),
            Self::WafersPerHour => passed(figures.wafers_per_hour),
            Self::MinimumDistance => figures.minimum_distance,
            Self::Velocity => figures.velocity,
            Self::Acceleration => figures.acceleration,
            Self::Jerk => figures.jerk,
            Self::Tilt => Some(figures.tilt),
            Self::Play => Some(figures.play),
            Self::Slip => figures.slip,
            Self::Violations => Some(figures.violations as f64),
        };
        value.unwrap_or(f64::NAN)
    }
}

/// A program of the study.
#[derive(Debug, Clone)]
pub(super) struct SweptProgram {
    /// How the study calls it.
    pub(super) name: String,
    pub(super) text: String,
    /// Its parameters, with their units.
    pub(super) parameters: Vec<(String, Option<ProgramUnit>)>,
}

/// Input that a value of a sample replaces.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum SweptInput {
    /// The number of the program, from 1.
    Program,
    /// A parameter of the cell, in the units of its file.
    CellParameter(String),
    /// A parameter of the program, in its unit.
    ProgramParameter(String),
    /// Displacement of a station along an axis of the base frame (m).
    Displacement {
        /// Index of the station.
        station: usize,
        /// 0 for x, 1 for y, 2 for z.
        axis: usize,
    },
}

/// The cell and the programs of a study.
pub(super) struct Subject {
    /// Text of the cell file.
    pub(super) cell: String,
    /// Files of the cell, by the names that it has for them.
    pub(super) files: BTreeMap<String, Vec<u8>>,
    pub(super) programs: Vec<SweptProgram>,
    pub(super) inputs: Vec<SweptInput>,
    pub(super) quantities: Vec<CellQuantity>,
}

impl Subject {
    /// The text of the cell file with displaced stations.
    ///
    /// # Arguments
    /// * `cell` – the cell of the text
    /// * `displaced` – station, axis, and displacement (m)
    ///
    /// # Errors
    /// Why a station cannot be displaced.
    pub(super) fn displaced(
        &self,
        cell: &Cell,
        displaced: &[(usize, usize, f64)],
    ) -> Result<String, String> {
        let mut text = self.cell.clone();
        let mut stations: Vec<usize> = displaced.iter().map(|(station, ..)| *station).collect();
        stations.dedup();
        for index in stations {
            let station = &cell.stations[index];
            let mut position = station.base_from_station.translation.vector;
            for &(_, axis, by) in displaced.iter().filter(|(other, ..)| *other == index) {
                // In millimetres, the unit of the file: as if typed there.
                position[axis] = m_from_mm(mm(position[axis]) + mm(by));
            }
            text = cell::set_station(&text, &station.name, &[Change::Position(position)])
                .map_err(|problem| problem.to_string())?;
        }
        Ok(text)
    }

    /// The cell of a text, with values of its parameters.
    pub(super) fn cell(
        &self,
        text: &str,
        parameters: &[(String, f64)],
    ) -> Result<Cell, cell::Errors> {
        cell::read_with(text, parameters, &mut from_files(&self.files))
    }

    /// The cell of a sample; `None` if its values make no valid cell.
    fn cell_of(&self, values: &[f64]) -> Option<Cell> {
        let (mut parameters, mut displaced) = (Vec::new(), Vec::new());
        for (input, &value) in self.inputs.iter().zip(values) {
            match input {
                SweptInput::CellParameter(name) => parameters.push((name.clone(), value)),
                SweptInput::Displacement { station, axis } => {
                    displaced.push((*station, *axis, value));
                }
                SweptInput::Program | SweptInput::ProgramParameter(_) => {}
            }
        }
        let cell = self.cell(&self.cell, &parameters).ok()?;
        if displaced.is_empty() {
            return Some(cell);
        }
        self.cell(&self.displaced(&cell, &displaced).ok()?, &parameters).ok()
    }

    /// The text of the program of a sample; `None` if a value does not suit its parameter.
    fn program_of(&self, values: &[f64]) -> Option<String> {
        let inputs = || self.inputs.iter().zip(values);
        let number = inputs().find(|(input, _)| **input == SweptInput::Program);
        // From a list of these numbers.
        let program = &self.programs[number.map_or(0, |(_, number)| *number as usize - 1)];
        let settings = inputs().filter_map(|(input, &value)| {
            let SweptInput::ProgramParameter(name) = input else { return None };
            let (_, unit) = program.parameters.iter().find(|(known, _)| known == name)?;
            Some(Setting { name: name.clone(), value: program::value_text(value, *unit) })
        });
        program::with_parameters(&program.text, &settings.collect::<Vec<_>>()).ok()
    }

    /// Plans and checks a sample.
    ///
    /// # Arguments
    /// * `row` – receives the quantities; NaN before
    fn check(
        &self,
        planner: &mut IncrementalPlanner,
        values: &[f64],
        row: &mut [f64],
    ) -> ProgramOutcome {
        let Some(cell) = self.cell_of(values) else { return ProgramOutcome::InvalidCell };
        let Some(text) = self.program_of(values) else { return ProgramOutcome::InvalidProgram };
        let Ok(program) = program::parse(&text) else { return ProgramOutcome::InvalidProgram };
        let (trajectory, report) = match planner.plan(&cell, &program, &PlanOptions::default()) {
            Ok(planned) => planned,
            Err(PlanError::Cell(_)) => return ProgramOutcome::InvalidCell,
            Err(PlanError::Program(errors)) => {
                return match errors.iter().all(|error| error.problem.is_infeasible()) {
                    true => ProgramOutcome::OutOfReach,
                    false => ProgramOutcome::InvalidProgram,
                };
            }
            Err(PlanError::Trajectory(_)) => return ProgramOutcome::NoTrajectory,
            Err(PlanError::Interrupted(_)) => unreachable!("nothing stops the plan"),
        };
        if trajectory.steps.is_empty() {
            return ProgramOutcome::NoMotion;
        }
        let figures = KeyFigures::of(&report);
        for (entry, quantity) in row.iter_mut().zip(&self.quantities) {
            *entry = quantity.of(&figures, report.result);
        }
        match report.result {
            CheckResult::Passed => ProgramOutcome::Passed,
            CheckResult::Failed => ProgramOutcome::Violations,
        }
    }

    /// A function that computes samples one after the other; the planner reuses what is equal in both, which changes no bit.
    pub(super) fn function(subject: &Arc<Self>) -> jointplay_study::plan::SampleFunction {
        let (subject, mut planner) = (subject.clone(), IncrementalPlanner::default());
        Box::new(move |values, row| Outcome::Program(subject.check(&mut planner, values, row)))
    }
}
