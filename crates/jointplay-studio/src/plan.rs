//! What a program comes to in a cell, with all that answers need of it.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

use jointplay::cell::check::Report;
use jointplay::cell::program::{Command, Instruction, Place, Program, ProgramError, name_errors};
use jointplay::cell::trajectory::{Trajectory, TrajectoryError, TrajectoryOptions};
use jointplay::cell::workcell::Cell;
use jointplay::cell::{IncrementalPlanner, Interrupted, PlanError, PlanOptions, Stop};
use jointplay::format::cell::explain_trajectory::explain_step;
use jointplay::format::program;
use jointplay::interop::export::{self, MotionExport, Timeline, ViolationNote};
use jointplay::report;

use crate::cell_files::CellFiles;
use crate::wire::cell::{Of, ProblemAt};

/// What a program comes to in a cell, as far as it comes.
pub(crate) struct Plan {
    /// Hash of both texts.
    pub(crate) key: String,
    cell_text: String,
    program_text: String,
    pub(crate) cell: Option<Cell>,
    /// The cell standing still.
    pub(crate) scene: Option<Arc<Scene>>,
    /// All that is wrong before anything moves.
    pub(crate) problems: Vec<ProblemAt>,
    pub(crate) motion: Option<Trajectory>,
    /// What `jointplay cell check` says of it.
    pub(crate) report: Option<report::CellReport>,
    pub(crate) timeline: Option<Timeline>,
    violation_notes: Vec<ViolationNote>,
}

/// The cell standing still, as binary glTF.
pub(crate) struct Scene {
    /// Hash of it.
    pub(crate) key: String,
    pub(crate) file: Vec<u8>,
}

impl Scene {
    /// Where the cell cannot stand at home, there is nothing to see.
    fn new(cell: &Cell) -> Option<Self> {
        let motion = standing(cell)?;
        let still = MotionExport { cell, motion: &motion, program: "", violation_notes: &[] };
        let file = export::gltf(&still, 1.0).ok()?;
        Some(Self { key: hashed(&file), file })
    }
}

/// Hash of something as hexadecimal digits.
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
    /// * `last` – the plan before: what is the same in it is not made again
    pub(crate) fn new(
        files: &CellFiles,
        (cell_text, program_text): (String, String),
        memory: &mut IncrementalPlanner,
        last: Option<&Self>,
        stop: Stop<'_>,
    ) -> Result<Self, Interrupted> {
        let mut plan = Self {
            key: key(&cell_text, &program_text),
            cell_text,
            program_text,
            cell: None,
            scene: None,
            problems: Vec::new(),
            motion: None,
            report: None,
            timeline: None,
            violation_notes: Vec::new(),
        };
        match files.parse(&plan.cell_text) {
            Ok(cell) => {
                // Files that it names may have changed, too.
                let known = last.filter(|last| last.cell.as_ref() == Some(&cell));
                let known = known.and_then(|last| last.scene.clone());
                plan.scene = known.or_else(|| Scene::new(&cell).map(Arc::new));
                plan.cell = Some(cell);
            }
            Err(problems) => plan.problems.extend(
                problems.iter().map(|one| ProblemAt::new(Of::Cell, &one.place, one.to_string())),
            ),
        }
        let (program, unread) = program::parse_recovering(&plan.program_text);
        let mut wrong: Vec<ProblemAt> = unread
            .iter()
            .map(|one| ProblemAt::new(Of::Program, &one.place, one.to_string()))
            .collect();
        if let (Some(cell), false) = (&plan.cell, wrong.is_empty()) {
            wrong
                .extend(Stopped::Steps(name_errors(cell, &program)).told(cell, &plan.program_text));
            wrong.sort_by_key(|one| (one.line, one.column));
        }
        let readable = wrong.is_empty();
        plan.problems.append(&mut wrong);
        let Some(cell) = plan.cell.as_ref().filter(|_| readable) else { return Ok(plan) };
        let stopped = match memory.plan(cell, &program, &PlanOptions::default(), stop) {
            Ok((motion, report)) => {
                plan.take(motion, &report, last, stop)?;
                return Ok(plan);
            }
            Err(PlanError::Interrupted(interrupted)) => return Err(interrupted),
            Err(PlanError::Program(errors)) => Stopped::Steps(errors),
            Err(PlanError::Trajectory(error)) => Stopped::Times(error),
        };
        plan.problems.extend(stopped.told(cell, &plan.program_text));
        Ok(plan)
    }

    fn take(
        &mut self,
        motion: Trajectory,
        report: &Report,
        last: Option<&Self>,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let go_on = || if stop() { Err(Interrupted) } else { Ok(()) };
        go_on()?;
        let Some(cell) = &self.cell else { return Ok(()) };
        self.violation_notes = export::violation_notes(cell, report);
        let document = report::cell(cell, &self.program_text, &motion, report);
        go_on()?;
        let violation_notes = self.violation_notes.as_slice();
        let motion_export =
            MotionExport { cell, motion: &motion, program: &self.program_text, violation_notes };
        let last = last.and_then(|last| last.timeline.as_ref());
        // A robot that cannot be placed somewhere moves all the same; its report says where.
        self.timeline = Timeline::new(&motion_export, &document.violations, last).ok();
        (self.motion, self.report) = (Some(motion), Some(document));
        go_on()
    }

    pub(crate) fn is_of(&self, cell: &str, program: &str) -> bool {
        self.cell_text == cell && self.program_text == program
    }

    /// Both texts, the cell's first.
    pub(crate) fn texts(&self) -> (&str, &str) {
        (&self.cell_text, &self.program_text)
    }

    /// The motion as exports take it.
    pub(crate) fn motion_export(&self) -> Option<MotionExport<'_>> {
        Some(MotionExport {
            cell: self.cell.as_ref()?,
            motion: self.motion.as_ref()?,
            program: &self.program_text,
            violation_notes: &self.violation_notes,
        })
    }

    /// The content of one of its windows; `None` where it has none of that key.
    pub(crate) fn window(&self, key: &str) -> Option<Result<Vec<u8>, export::Error>> {
        let (timeline, motion_export) = (self.timeline.as_ref()?, self.motion_export()?);
        let index = timeline.find(key)?;
        let violations = self.report.as_ref().map_or(&[][..], |report| &report.violations);
        Some(timeline.content(&motion_export, violations, index))
    }
}

/// Hash of two texts.
pub(crate) fn key(cell: &str, program: &str) -> String {
    hashed((cell, program))
}

/// Why a program comes to no motion.
enum Stopped {
    Steps(Vec<ProgramError>),
    Times(TrajectoryError),
}

impl Stopped {
    /// All that is wrong with the text, the same at one place once.
    fn told(&self, cell: &Cell, text: &str) -> Vec<ProblemAt> {
        let mut told: Vec<ProblemAt> = Vec::new();
        let mut tell = |problem: ProblemAt| {
            if !told.contains(&problem) {
                told.push(problem);
            }
        };
        match self {
            Self::Steps(errors) => errors.iter().for_each(|error| {
                let error = program::explain(&cell.robot, text, error);
                tell(ProblemAt::new(Of::Program, &error.place, error.to_string()));
            }),
            Self::Times(error) => error.steps.iter().for_each(|one| {
                let Place { line, column } = one.place;
                let message = explain_step(&cell.robot, one);
                tell(ProblemAt { of: Of::Program, line, column, width: 0, message });
            }),
        }
        told
    }
}

/// The robot standing at home in a cell, for a picture of it where there is no motion.
pub(crate) fn standing(cell: &Cell) -> Option<Trajectory> {
    let place = Place { line: 1, column: 1 };
    let wait = Instruction { place, command: Command::Wait { seconds: 1.0 } };
    let program = Program { body: vec![wait], routines: Vec::new() };
    let mut memory = IncrementalPlanner::default();
    let steps = memory.expand(cell, &program).ok()?;
    memory.plan_trajectory(cell, steps, &TrajectoryOptions::default()).ok()
}
