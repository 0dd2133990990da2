//! The plan of a program in a cell, with all data of the responses.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

use jointplay::cell::check::Report;
use jointplay::cell::program::{
    Command, Instruction, Program, ProgramError, Quantity, SourceLocation, Unit, expand,
    name_errors,
};
use jointplay::cell::trajectory::{
    Trajectory, TrajectoryError, TrajectoryOptions, plan_trajectory,
};
use jointplay::cell::workcell::Cell;
use jointplay::cell::{
    IncrementalPlanner, Interrupted, InvalidPart, PlanError, PlanOptions, StopRequested,
};
use jointplay::format::cell::explain::explain;
use jointplay::format::cell::explain_trajectory::explain_step;
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::program;
use jointplay::interop::export::{self, MotionExport, Timeline, ViolationNote};
use jointplay::report;

use crate::cell_files::{CellFiles, NamedFiles};
use crate::wire::cell::{Diagnostic, SourceText};

/// Plan of a program in a cell, as far as planning succeeded.
pub(crate) struct Plan {
    /// Hash of both texts, of the files that the cell names, and of the units.
    pub(crate) key: String,
    /// Units of lengths in messages.
    units: DisplayUnits,
    cell_text: String,
    program_text: String,
    /// The files that the cell names.
    named: NamedFiles,
    pub(crate) cell: Option<Cell>,
    /// The 3D scene of the cell.
    pub(crate) scene: Option<Arc<Scene>>,
    /// All errors that prevent a motion.
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) motion: Option<Trajectory>,
    /// The check of the motion.
    pub(crate) check: Option<Report>,
    /// Report as from `jointplay cell check`.
    pub(crate) report: Option<report::CellReport>,
    pub(crate) timeline: Option<Timeline>,
    violation_notes: Vec<ViolationNote>,
}

/// The cell with the robot at home, as binary glTF.
pub(crate) struct Scene {
    /// Hash of the file.
    pub(crate) key: String,
    pub(crate) file: Vec<u8>,
}

impl Scene {
    /// `None` if the robot cannot be at home.
    fn new(cell: &Cell) -> Option<Self> {
        let motion = rest_at_home(cell)?;
        let still = MotionExport { cell, motion: &motion, program: "", violation_notes: &[] };
        let file = export::gltf(&still, 1.0).ok()?;
        Some(Self { key: hashed(&file), file })
    }
}

/// Hash of a value in hexadecimal digits.
fn hashed(of: impl Hash) -> String {
    let digits = |seed: u64| {
        let mut hasher = DefaultHasher::new();
        (seed, env!("CARGO_PKG_VERSION")).hash(&mut hasher);
        of.hash(&mut hasher);
        hasher.finish()
    };
    format!("{:016x}{:016x}", digits(0), digits(1))
}

impl Plan {
    /// Plans a program.
    ///
    /// # Arguments
    /// * `units` – of lengths in messages
    /// * `last` – the previous plan, whose results are reused
    pub(crate) fn new(
        files: &CellFiles,
        (cell_text, program_text): (String, String),
        units: DisplayUnits,
        memory: &mut IncrementalPlanner,
        last: Option<&Self>,
        stop: StopRequested<'_>,
    ) -> Result<Self, Interrupted> {
        let (cell, named) = files.parse_with_named(&cell_text);
        let mut plan = Self {
            key: hashed((&cell_text, &program_text, &named, units.unit())),
            units,
            cell_text,
            program_text,
            named,
            cell: None,
            scene: None,
            diagnostics: Vec::new(),
            motion: None,
            check: None,
            report: None,
            timeline: None,
            violation_notes: Vec::new(),
        };
        match cell {
            Ok(cell) => {
                // Compared by value: mesh files may have changed with an unchanged text.
                let reusable = last.filter(|last| last.cell.as_ref() == Some(&cell));
                let reusable = reusable.and_then(|last| last.scene.clone());
                plan.scene = reusable.or_else(|| Scene::new(&cell).map(Arc::new));
                plan.cell = Some(cell);
            }
            Err(problems) => plan.diagnostics.extend(
                problems
                    .iter()
                    .map(|one| Diagnostic::new(SourceText::Cell, &one.place, one.to_string())),
            ),
        }
        let (program, unread) = program::parse_recovering(&plan.program_text);
        let mut errors: Vec<Diagnostic> = unread
            .iter()
            .map(|one| Diagnostic::new(SourceText::Program, &one.place, one.to_string()))
            .collect();
        if let (Some(cell), false) = (&plan.cell, errors.is_empty()) {
            errors.extend(PlanningError::Steps(name_errors(cell, &program)).diagnostics(
                cell,
                &plan.program_text,
                units,
            ));
            errors.sort_by_key(|one| (one.line, one.column));
        }
        let readable = errors.is_empty();
        plan.diagnostics.append(&mut errors);
        let Some(cell) = plan.cell.as_ref().filter(|_| readable) else { return Ok(plan) };
        let options = PlanOptions { stop, ..PlanOptions::default() };
        let error = match memory.plan(cell, &program, &options) {
            Ok((motion, report)) => {
                plan.take(motion, report, last, stop)?;
                return Ok(plan);
            }
            Err(PlanError::Interrupted(interrupted)) => return Err(interrupted),
            Err(PlanError::Cell(invalid)) => PlanningError::Cell(invalid),
            Err(PlanError::Program(errors)) => PlanningError::Steps(errors),
            Err(PlanError::Trajectory(error)) => PlanningError::Times(error),
        };
        plan.diagnostics.extend(error.diagnostics(cell, &plan.program_text, units));
        Ok(plan)
    }

    fn take(
        &mut self,
        motion: Trajectory,
        report: Report,
        last: Option<&Self>,
        stop: StopRequested<'_>,
    ) -> Result<(), Interrupted> {
        let go_on = || if stop() { Err(Interrupted) } else { Ok(()) };
        go_on()?;
        let Some(cell) = &self.cell else { return Ok(()) };
        self.violation_notes = export::violation_notes(cell, &report);
        let document = report::cell(cell, &self.program_text, &motion, &report, self.units);
        go_on()?;
        let violation_notes = self.violation_notes.as_slice();
        let motion_export =
            MotionExport { cell, motion: &motion, program: &self.program_text, violation_notes };
        let last = last.and_then(|last| last.timeline.as_ref());
        // Without a timeline if the platform has no pose at some time; the report lists this.
        self.timeline = Timeline::new(&motion_export, &document.violations, last).ok();
        (self.motion, self.check, self.report) = (Some(motion), Some(report), Some(document));
        go_on()
    }

    /// Whether it is the plan of these texts and of the present contents of the files that the cell names, with messages in these units.
    pub(crate) fn is_of(
        &self,
        files: &CellFiles,
        (cell, program): (&str, &str),
        units: DisplayUnits,
    ) -> bool {
        self.cell_text == cell
            && self.program_text == program
            && self.units == units
            && files.still_have(&self.named)
    }

    /// Both texts, the cell first.
    pub(crate) fn texts(&self) -> (&str, &str) {
        (&self.cell_text, &self.program_text)
    }

    /// The motion in the form of exports; `None` if nothing moves.
    pub(crate) fn motion_export(&self) -> Option<MotionExport<'_>> {
        Some(MotionExport {
            cell: self.cell.as_ref()?,
            motion: self.motion.as_ref().filter(|motion| !motion.steps.is_empty())?,
            program: &self.program_text,
            violation_notes: &self.violation_notes,
        })
    }

    /// The contents of the window with a key; `None` for an unknown key.
    pub(crate) fn window(&self, key: &str) -> Option<Result<Vec<u8>, export::Error>> {
        let (timeline, motion_export) = (self.timeline.as_ref()?, self.motion_export()?);
        let index = timeline.find(key)?;
        let violations = self.report.as_ref().map_or(&[][..], |report| &report.violations);
        Some(timeline.content(&motion_export, violations, index))
    }
}

/// Why a program has no motion.
enum PlanningError {
    Cell(Vec<InvalidPart>),
    Steps(Vec<ProgramError>),
    Times(TrajectoryError),
}

impl PlanningError {
    /// The errors with their positions in the text, without duplicates.
    fn diagnostics(&self, cell: &Cell, text: &str, units: DisplayUnits) -> Vec<Diagnostic> {
        let mut found: Vec<Diagnostic> = Vec::new();
        let mut add = |problem: Diagnostic| {
            if !found.contains(&problem) {
                found.push(problem);
            }
        };
        match self {
            // A cell that was read from a text is valid.
            Self::Cell(invalid) => invalid.iter().for_each(|one| {
                let message = explain(&one.error, units);
                add(Diagnostic { source: SourceText::Cell, line: 1, column: 1, width: 0, message });
            }),
            Self::Steps(errors) => errors.iter().for_each(|error| {
                let error = program::explain(&cell.robot, text, error, units);
                add(Diagnostic::new(SourceText::Program, &error.place, error.to_string()));
            }),
            Self::Times(error) => error.steps.iter().for_each(|one| {
                let SourceLocation { line, column } = one.place;
                let message = explain_step(&cell.robot, one, units);
                add(Diagnostic { source: SourceText::Program, line, column, width: 0, message });
            }),
        }
        found
    }
}

/// A motion with the robot at rest at home.
pub(crate) fn rest_at_home(cell: &Cell) -> Option<Trajectory> {
    let place = SourceLocation { line: 1, column: 1 };
    let wait = Instruction {
        place,
        command: Command::Wait { duration: Quantity::from_si(1.0, Unit::Second) },
    };
    let program = Program { body: vec![wait], ..Program::default() };
    let steps = expand(cell, &program).ok()?;
    plan_trajectory(cell, steps, &TrajectoryOptions::default()).ok()
}
