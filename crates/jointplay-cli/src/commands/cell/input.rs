//! Cells and programs, as given on the command line.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::cell::check::{CheckOptions, Report, Verdict};
use jointplay::cell::program::{Place, Program, ProgramError, ProgramProblem, name_errors};
use jointplay::cell::robot::EffectorId;
use jointplay::cell::trajectory::{StepError, Trajectory, TrajectoryOptions};
use jointplay::cell::workcell::Cell;
use jointplay::cell::{IncrementalPlanner, Progress as JobProgress};
use jointplay::format::cell::explain_trajectory::explain_step;
use jointplay::format::place::Error as Placed;
use jointplay::format::{cell, program};
use jointplay::interop::export::{self, MotionExport, ViolationNote};
use jointplay::report;

use super::text::counted;
use crate::arguments::TextFormat;
use crate::failure::{Failure, Wrong};
use crate::progress::{Progress, Reporter};
use crate::source::{self, Kind, STANDARD, Source, read_text};

/// What the example is called, in place of a file.
pub(super) const EXAMPLE: &str = "example";
/// What names of programs end in.
const PROGRAM: &str = "program";

/// A cell file, and how the answer is told.
#[derive(Args)]
pub(super) struct CellArgs {
    /// Cell file (TOML); without it, the example that comes along
    #[arg(value_name = "CELL")]
    file: Option<PathBuf>,
    /// How the answer is printed
    #[arg(long, value_enum, default_value = "text")]
    format: TextFormat,
}

/// A cell and a program for it.
#[derive(Args)]
pub(super) struct InputArgs {
    #[command(flatten)]
    cell: CellArgs,
    /// Program; without it, the file beside the cell with the same name that ends in .program
    #[arg(value_name = "PROGRAM")]
    program: Option<PathBuf>,
}

/// A cell, and what it is called in messages and names of files.
pub(super) struct Named {
    pub(super) cell: Cell,
    pub(super) label: String,
    pub(super) stem: String,
    pub(super) text: String,
    /// Where files that it names lie; `None` for the example.
    pub(super) folder: Option<PathBuf>,
}

impl Named {
    pub(super) fn read(
        label: String,
        stem: String,
        text: String,
        folder: Option<PathBuf>,
    ) -> Result<Self, Failure> {
        let read = cell::read(&text, &mut |name| beside(folder.as_deref(), name));
        let cell = read.map_err(|problems| Failure::Wrong(wrong(&problems, &label)))?;
        Ok(Self { cell, label, stem, text, folder })
    }
}

/// A cell with a program that it can do something with.
pub(super) struct Input {
    pub(super) named: Named,
    pub(super) program: Program,
    /// Text of the program, and what messages call it.
    pub(super) text: String,
    pub(super) label: String,
}

/// A program as it runs, and what is wrong with it.
pub(super) struct Planned {
    pub(super) input: Input,
    pub(super) motion: Trajectory,
    pub(super) report: Report,
    pub(super) violation_notes: Vec<ViolationNote>,
}

impl CellArgs {
    pub(super) fn json(&self) -> bool {
        self.format == TextFormat::Json
    }

    pub(super) fn is_standard_input(&self) -> bool {
        self.file.as_deref() == Some(Path::new(STANDARD))
    }

    fn is_example(&self) -> bool {
        self.file.as_ref().is_none_or(|path| path == Path::new(EXAMPLE) && !path.exists())
    }

    pub(super) fn load(&self) -> Result<Named, Failure> {
        match &self.file {
            Some(path) if !self.is_example() => {
                let stem = source::stem(path);
                let folder = path.parent().map(Path::to_owned).unwrap_or_default();
                let Source { label, text } = {
                    let source = Source::read(path, cell::MAX_BYTES)?;
                    source.require(&[Kind::Cell], "a work cell")?;
                    source
                };
                Named::read(label, stem, text, Some(folder))
            }
            _ => {
                let label = format!("{EXAMPLE}.toml");
                Named::read(label, EXAMPLE.to_owned(), cell::EXAMPLE.to_owned(), None)
            }
        }
    }
}

impl InputArgs {
    pub(super) fn json(&self) -> bool {
        self.cell.json()
    }

    pub(super) fn load(&self) -> Result<Input, Failure> {
        // What is wrong with either is told at once.
        let (named, text) = (self.cell.load(), self.text());
        let (text, label) = match (text, &named) {
            (Ok(found), _) => found,
            (Err(program), Ok(_)) => return Err(program),
            (Err(program), Err(cell)) => return Err(Failure::Robot(format!("{cell}\n{program}"))),
        };
        let (program, problems) = program::parse_recovering(&text);
        if problems.is_empty() {
            return Ok(Input { named: named?, program, text, label });
        }
        let unread = wrong(&problems, &label);
        Err(match named {
            Ok(named) => {
                let misfits = name_errors(&named.cell, &program);
                let mut all = unread;
                all.extend(misfits.iter().map(|one| told(&named.cell, one, &text, &label)));
                all.sort_by_key(|one| (one.line, one.column));
                Failure::Wrong(all)
            }
            Err(Failure::Wrong(cell)) => Failure::Wrong(cell.into_iter().chain(unread).collect()),
            Err(cell) => cell,
        })
    }

    /// The program, and what messages call it.
    fn text(&self) -> Result<(String, String), Failure> {
        let path = match (&self.program, &self.cell.file) {
            (Some(path), _) => path.clone(),
            (None, Some(cell)) if !self.cell.is_example() => {
                let path = cell.with_extension(PROGRAM);
                if !path.exists() {
                    return Err(Failure::Misused(format!(
                        "there is no {} beside the cell: name the program after the cell",
                        path.display()
                    )));
                }
                path
            }
            _ => return Ok((program::EXAMPLE.to_owned(), format!("{EXAMPLE}.{PROGRAM}"))),
        };
        let text = read_text(&path, program::MAX_BYTES as u64)?;
        Ok((text, source::label(&path)))
    }

    /// Expands, times and checks the program.
    pub(super) fn plan(&self) -> Result<Planned, Failure> {
        let input = self.load()?;
        let progress = Progress::new(1);
        let mut memory = counted_by(progress.reporter());
        let reporter = progress.reporter();
        reporter.stage("expanding");
        let cell = &input.named.cell;
        let steps = memory.expand(cell, &input.program).map_err(|errors| input.refused(&errors))?;
        if steps.is_empty() {
            return Err(Failure::Robot(format!(
                "{}: nothing moves in this program: every axis starts at home, and no command takes one from there",
                input.label
            )));
        }
        reporter.stage("timing");
        let motion = memory.plan_trajectory(cell, steps, &TrajectoryOptions::default()).map_err(
            |error| {
                let of = |one: &StepError| (one.place, explain_step(&cell.robot, one));
                Failure::CannotDo(input.at(error.steps.iter().map(of)))
            },
        )?;
        reporter.stage("checking");
        let report = memory.check(cell, &motion, &CheckOptions::default());
        drop(progress);
        let violation_notes = export::violation_notes(cell, &report);
        Ok(Planned { input, motion, report, violation_notes })
    }
}

impl Input {
    /// A message at a place of the program, with its line.
    pub(super) fn excerpt(&self, at: Place, message: &str) -> String {
        report::excerpt(&self.text, at, message, &self.label)
    }

    /// Messages at places of the program; the same at one place once.
    fn at(&self, messages: impl Iterator<Item = (Place, String)>) -> Vec<Wrong> {
        let mut all: Vec<Wrong> = Vec::new();
        for (at, message) in messages {
            let (file, excerpt) = (self.label.clone(), self.excerpt(at, &message));
            let one = Wrong { file, line: at.line, column: at.column, message, excerpt };
            if !all.contains(&one) {
                all.push(one);
            }
        }
        all
    }

    /// Why the program cannot run in this cell: bad input, or the answer is no where it is all about reach and limits.
    fn refused(&self, errors: &[ProgramError]) -> Failure {
        let all =
            errors.iter().map(|one| told(&self.named.cell, one, &self.text, &self.label)).collect();
        let out_of_reach = |one: &ProgramError| {
            matches!(
                one.problem,
                ProgramProblem::Range { .. }
                    | ProgramProblem::Limits { .. }
                    | ProgramProblem::Unreachable { .. }
            )
        };
        if errors.iter().all(out_of_reach) { Failure::CannotDo(all) } else { Failure::Wrong(all) }
    }
}

impl Planned {
    pub(super) fn cell(&self) -> &Cell {
        &self.input.named.cell
    }

    pub(super) fn is_sound(&self) -> bool {
        self.report.verdict == Verdict::Sound
    }

    pub(super) fn motion_export(&self) -> MotionExport<'_> {
        MotionExport {
            cell: self.cell(),
            motion: &self.motion,
            program: &self.input.text,
            violation_notes: &self.violation_notes,
        }
    }

    pub(super) fn document(&self) -> report::CellReport {
        report::cell(self.cell(), &self.input.text, &self.motion, &self.report)
    }

    /// All effectors of the robot.
    pub(super) fn effectors(&self) -> Vec<EffectorId> {
        self.cell().robot.effectors().collect()
    }

    /// Ends the command as the verdict says.
    pub(super) fn verdict(&self) -> Result<(), Failure> {
        if self.is_sound() {
            return Ok(());
        }
        let count = counted(self.report.violations.len(), "violation");
        Err(Failure::Unsolved(format!("{}: {count}, not safe to run", self.input.label)))
    }
}

/// A planner that reports its progress.
fn counted_by(reporter: Reporter) -> IncrementalPlanner {
    IncrementalPlanner::with_observer(move |progress| match progress {
        JobProgress::Started { jobs } => reporter.parts(jobs),
        JobProgress::JobDone => reporter.part_done(),
    })
}

/// What is wrong with a file.
pub(super) fn wrong<P: std::fmt::Display>(problems: &[Placed<P>], label: &str) -> Vec<Wrong> {
    problems.iter().map(|one| Wrong::new(one, label)).collect()
}

/// What is wrong with a program in its cell.
fn told(cell: &Cell, error: &ProgramError, text: &str, label: &str) -> Wrong {
    Wrong::new(&program::explain(&cell.robot, text, error), label)
}

/// A file that a cell names: in its folder or below, and nowhere else.
fn beside(folder: Option<&Path>, name: &str) -> Result<Vec<u8>, String> {
    let folder = folder.ok_or("the example has no files beside it")?;
    let allowed = cell::MAX_MESH_BYTES as u64;
    jointplay_files::read(folder, name, allowed).map_err(|why| why.to_string())
}
