//! Cells and programs given on the command line, and their plan.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::cell::check::{CheckOptions, CheckResult, Report, remedies};
use jointplay::cell::program::{Program, ProgramError, SourceLocation, name_errors};
use jointplay::cell::trajectory::{StepError, Trajectory};
use jointplay::cell::workcell::Cell;
use jointplay::cell::{
    IncrementalPlanner, PlanError, PlanOptions, PlanStage, Progress as JobProgress,
};
use jointplay::format::cell::explain_trajectory::explain_step;
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::number::counted;
use jointplay::format::program::Setting;
use jointplay::format::{cell, program};
use jointplay::interop::export::{self, MotionExport, ViolationNote};
use jointplay::report;

use crate::arguments::finite;
use crate::failure::{Diagnostic, Failure};
use crate::output::FormatArgs;
use crate::progress::{Progress, Reporter};
use crate::source::{self, Kind, STANDARD, Source};

/// Name of the included example, in place of a file.
pub(super) const EXAMPLE: &str = "example";
/// Prefix of the names of parameters of the cell.
const OF_CELL: &str = "cell.";
/// Extension of program files.
const PROGRAM: &str = "program";

/// A cell file, and the output format.
#[derive(Args, Clone)]
pub(super) struct CellArgs {
    /// Cell file (TOML) [default: the included example]
    #[arg(value_name = "CELL")]
    file: Option<PathBuf>,
    #[command(flatten)]
    pub(super) format: FormatArgs,
}

/// A cell and a program for it.
#[derive(Args)]
pub(super) struct InputArgs {
    #[command(flatten)]
    cell: CellArgs,
    /// Program [default: the file next to the cell with the same name that ends in .program]
    #[arg(value_name = "PROGRAM")]
    program: Option<PathBuf>,
    /// Values of parameters: of the program, numbers with the unit of the parameter; of the cell, `cell.NAME=VALUE` in the units of the file
    #[arg(long, value_name = "PARAMETER=VALUE", value_delimiter = ',', value_parser = setting)]
    set: Vec<Setting>,
}

pub(super) fn setting(text: &str) -> Result<Setting, String> {
    let (name, value) = text
        .rsplit_once('=')
        .ok_or_else(|| format!("invalid value {text:?}: expected PARAMETER=VALUE"))?;
    Ok(Setting { name: name.trim().to_owned(), value: value.trim().to_owned() })
}

/// Values of parameters that are set.
#[derive(Default)]
pub(super) struct Settings {
    /// Of the cell: names and values in the units of the file.
    pub(super) of_cell: Vec<(String, f64)>,
    /// Of the program.
    pub(super) of_program: Vec<Setting>,
}

/// A cell with its text, its name in messages, and the name of its result files.
pub(super) struct CellSource {
    pub(super) cell: Cell,
    pub(super) label: String,
    pub(super) stem: String,
    pub(super) text: String,
    /// Folder of the files that the cell refers to; `None` for the example.
    pub(super) folder: Option<PathBuf>,
    /// Names of the files that were read for the cell, with SHA-256 of their contents.
    pub(super) files: BTreeMap<String, String>,
}

impl CellSource {
    pub(super) fn parse(
        label: String,
        stem: String,
        text: String,
        folder: Option<PathBuf>,
        parameters: &[(String, f64)],
    ) -> Result<Self, Failure> {
        let mut files = BTreeMap::new();
        let read = cell::read_with(&text, parameters, &mut |name| {
            let bytes = read_relative(folder.as_deref(), name)?;
            files.insert(name.to_owned(), report::sha256(&bytes));
            Ok(bytes)
        });
        let cell = read.map_err(|problems| Failure::invalid_cell(&problems, &label))?;
        Ok(Self { cell, label, stem, text, folder, files })
    }
}

/// Reads a program file.
pub(super) fn program_source(path: &Path) -> Result<Source, Failure> {
    let source = Source::read(path, program::MAX_BYTES)?;
    source.require(&[Kind::Program], "a program of a work cell")?;
    Ok(source)
}

/// The text of a program and its name in messages.
struct ProgramText {
    text: String,
    label: String,
}

/// A cell and a program that parses.
pub(super) struct Input {
    pub(super) cell: CellSource,
    pub(super) program: Program,
    /// Text of the program.
    pub(super) text: String,
    /// Name of the program in messages.
    pub(super) label: String,
}

/// The trajectory of a program with its check report.
pub(super) struct Planned {
    pub(super) input: Input,
    pub(super) motion: Trajectory,
    pub(super) report: Report,
    pub(super) violation_notes: Vec<ViolationNote>,
}

impl CellArgs {
    pub(super) fn is_standard_input(&self) -> bool {
        self.file.as_deref() == Some(Path::new(STANDARD))
    }

    /// Path of the cell file; `None` for the example.
    pub(super) fn path(&self) -> Option<&Path> {
        self.file.as_deref().filter(|_| !self.is_example())
    }

    fn is_example(&self) -> bool {
        self.file.as_ref().is_none_or(|path| path == Path::new(EXAMPLE) && !path.exists())
    }

    pub(super) fn load(&self) -> Result<CellSource, Failure> {
        self.load_with(&[])
    }

    /// The cell with other values of some of its parameters, in the units of the file.
    fn load_with(&self, parameters: &[(String, f64)]) -> Result<CellSource, Failure> {
        match &self.file {
            Some(path) if !self.is_example() => {
                let stem = source::stem(path);
                let folder = path.parent().map(Path::to_owned).unwrap_or_default();
                let Source { label, text, .. } = {
                    let source = Source::read(path, cell::MAX_BYTES)?;
                    source.require(&[Kind::Cell], "a work cell")?;
                    source
                };
                CellSource::parse(label, stem, text, Some(folder), parameters)
            }
            _ => {
                let label = format!("{EXAMPLE}.toml");
                let text = cell::EXAMPLE.to_owned();
                CellSource::parse(label, EXAMPLE.to_owned(), text, None, parameters)
            }
        }
    }
}

impl InputArgs {
    /// The same cell with another program.
    ///
    /// # Arguments
    /// * `set` – values of its parameters in place of those of this program; values of the cell's parameters replace those of the same name
    pub(super) fn with_program(&self, program: &Path, set: Option<&[Setting]>) -> Self {
        let replaced = |one: &&Setting| {
            let of_cell = one.name.starts_with(OF_CELL);
            set.is_some_and(|set| !of_cell || set.iter().any(|other| other.name == one.name))
        };
        let mut all: Vec<Setting> = self.set.iter().filter(|one| !replaced(one)).cloned().collect();
        all.extend(set.into_iter().flatten().cloned());
        Self { cell: self.cell.clone(), program: Some(program.to_owned()), set: all }
    }

    pub(super) fn format(&self) -> FormatArgs {
        self.cell.format
    }

    /// The cell alone.
    pub(super) fn load_cell(&self) -> Result<CellSource, Failure> {
        let Settings { of_cell, of_program } = self.settings()?;
        if let Some(one) = of_program.first() {
            let name = &one.name;
            let text = format!(
                "--set {name}: no program is read here; a parameter of the cell is set by --set cell.{name}=VALUE"
            );
            return Err(Failure::Usage(text));
        }
        self.cell.load_with(&of_cell)
    }

    pub(super) fn load(&self) -> Result<Input, Failure> {
        // Errors of both files are reported together.
        let Settings { of_cell, of_program } = self.settings()?;
        let (cell, program) = (self.cell.load_with(&of_cell), self.program_with(&of_program));
        let (cell, ProgramText { text, label }) = match (cell, program) {
            (cell, Ok(found)) => (cell, found),
            (Ok(_), Err(program)) => return Err(program),
            // A file of another kind has no program of its name.
            (Err(cell), Err(_)) if self.program.is_none() && matches!(cell, Failure::Usage(_)) => {
                return Err(cell);
            }
            (Err(cell), Err(program)) => {
                let (cell, program) = (Box::new(cell), Box::new(program));
                return Err(Failure::CellAndProgram { cell, program });
            }
        };
        let (program, problems) = program::parse_recovering(&text);
        if problems.is_empty() {
            return Ok(Input { cell: cell?, program, text, label });
        }
        let syntax_errors = Diagnostic::list(&problems, &label);
        Err(match cell {
            Ok(source) => {
                let unknown_names = name_errors(&source.cell, &program);
                let mut all = syntax_errors;
                all.extend(
                    unknown_names
                        .iter()
                        .map(|one| program_diagnostic(&source.cell, one, &text, &label)),
                );
                all.sort_by_key(|one| (one.line, one.column));
                Failure::Invalid(all)
            }
            Err(Failure::Invalid(cell)) => {
                Failure::Invalid(cell.into_iter().chain(syntax_errors).collect())
            }
            Err(cell) => cell,
        })
    }

    /// Reads the program.
    fn program_text(&self) -> Result<ProgramText, Failure> {
        let path = match (&self.program, &self.cell.file) {
            (Some(path), _) => path.clone(),
            (None, Some(cell)) if !self.cell.is_example() => {
                let path = cell.with_extension(PROGRAM);
                if !path.exists() {
                    return Err(Failure::Usage(format!(
                        "{} does not exist: give the program after the cell",
                        path.display()
                    )));
                }
                path
            }
            _ => {
                let label = format!("{EXAMPLE}.{PROGRAM}");
                return Ok(ProgramText { text: program::EXAMPLE.to_owned(), label });
            }
        };
        let Source { text, label, .. } = program_source(&path)?;
        Ok(ProgramText { text, label })
    }

    /// The parameters that are set, of the cell and of the program.
    pub(super) fn settings(&self) -> Result<Settings, Failure> {
        let mut settings = Settings::default();
        for one in &self.set {
            match one.name.strip_prefix(OF_CELL) {
                Some(name) => {
                    let value = finite(&one.value)
                        .map_err(|why| Failure::Usage(format!("--set {}: {why}", one.name)))?;
                    settings.of_cell.push((name.to_owned(), value));
                }
                None => settings.of_program.push(one.clone()),
            }
        }
        Ok(settings)
    }

    /// The program with the parameters that are set.
    fn program_with(&self, parameters: &[Setting]) -> Result<ProgramText, Failure> {
        let ProgramText { text, label } = self.program_text()?;
        let text = program::with_parameters(&text, parameters)
            .map_err(|problems| Failure::invalid(&problems, &label))?;
        Ok(ProgramText { text, label })
    }

    /// Expands the program, plans its trajectory and checks it.
    pub(super) fn plan(&self) -> Result<Planned, Failure> {
        let input = self.load()?;
        let progress = Progress::new(1);
        let mut planner = with_progress(progress.reporter());
        let reporter = progress.reporter();
        let on_stage = |stage| {
            reporter.stage(match stage {
                PlanStage::Expansion => "expanding",
                PlanStage::Trajectory => "timing",
                PlanStage::Check => "checking",
            });
        };
        let cell = &input.cell.cell;
        let options = PlanOptions { on_stage: &on_stage, ..PlanOptions::default() };
        let planned = planner.plan(cell, &input.program, &options);
        let (motion, report) = planned.map_err(|error| input.failure(&error))?;
        if report.result == CheckResult::NoMotion {
            return Err(Failure::NoMotion { program: input.label });
        }
        drop(progress);
        let violation_notes = export::violation_notes(cell, &report);
        Ok(Planned { input, motion, report, violation_notes })
    }
}

impl Input {
    /// A message with its line of the program and a caret.
    pub(super) fn excerpt(&self, at: SourceLocation, message: &str) -> String {
        report::excerpt(&self.text, at, message, &self.label)
    }

    /// Diagnostics at positions of the program, without duplicates.
    fn at(&self, messages: impl Iterator<Item = (SourceLocation, String)>) -> Vec<Diagnostic> {
        let mut all: Vec<Diagnostic> = Vec::new();
        for (at, message) in messages {
            let (file, excerpt) = (self.label.clone(), self.excerpt(at, &message));
            let one = Diagnostic { file, line: at.line, column: at.column, message, excerpt };
            if !all.contains(&one) {
                all.push(one);
            }
        }
        all
    }

    fn failure(&self, error: &PlanError) -> Failure {
        match error {
            PlanError::Program(errors) => self.refused(errors),
            PlanError::Trajectory(error) => {
                let robot = &self.cell.cell.robot;
                let explained =
                    |one: &StepError| (one.place, explain_step(robot, one, DisplayUnits::Metric));
                Failure::Infeasible(self.at(error.steps.iter().map(explained)))
            }
            PlanError::Cell(_) | PlanError::Interrupted(_) => Failure::Robot(error.to_string()),
        }
    }

    /// The failure for errors of the program in its cell: infeasible if all of them concern reach and limits, else invalid input.
    pub(super) fn refused(&self, errors: &[ProgramError]) -> Failure {
        let all = errors
            .iter()
            .map(|one| program_diagnostic(&self.cell.cell, one, &self.text, &self.label))
            .collect();
        if errors.iter().all(|one| one.problem.is_infeasible()) {
            Failure::Infeasible(all)
        } else {
            Failure::Invalid(all)
        }
    }
}

impl Planned {
    pub(super) fn cell(&self) -> &Cell {
        &self.input.cell.cell
    }

    pub(super) fn passed(&self) -> bool {
        self.report.result == CheckResult::Passed
    }

    pub(super) fn motion_export(&self) -> MotionExport<'_> {
        MotionExport {
            cell: self.cell(),
            motion: &self.motion,
            program: &self.input.text,
            violation_notes: &self.violation_notes,
        }
    }

    /// The report, with remedies of violations.
    pub(super) fn document(&self) -> report::CellReport {
        let progress = Progress::new(1);
        progress.reporter().stage("searching remedies");
        let (cell, options) = (self.cell(), CheckOptions::default());
        let remedies = remedies(cell, &self.motion, &options, &self.report, &|| false).ok();
        let remedies =
            remedies.map(|found| report::remedy_reports(cell, &found, DisplayUnits::Metric));
        let document =
            report::cell(cell, &self.input.text, &self.motion, &self.report, DisplayUnits::Metric);
        report::CellReport { remedies, ..document }
    }

    /// Fails if the report has violations.
    pub(super) fn exit(&self) -> Result<(), Failure> {
        if self.passed() {
            return Ok(());
        }
        let count = counted(self.report.violations.len(), "violation");
        Err(Failure::Unsolved(format!("{}: {count}, not safe to run", self.input.label)))
    }
}

/// A planner that reports its progress.
fn with_progress(reporter: Reporter) -> IncrementalPlanner {
    IncrementalPlanner::with_observer(move |progress| match progress {
        JobProgress::Started { jobs } => reporter.parts(jobs),
        JobProgress::JobDone => reporter.part_done(),
    })
}

/// The diagnostic of an error of a program in its cell.
fn program_diagnostic(cell: &Cell, error: &ProgramError, text: &str, label: &str) -> Diagnostic {
    Diagnostic::new(&program::explain(&cell.robot, text, error, DisplayUnits::Metric), label)
}

/// Reads a file that a cell refers to, in the folder of the cell or below.
pub(super) fn read_relative(folder: Option<&Path>, name: &str) -> Result<Vec<u8>, String> {
    let folder = folder.ok_or("the included example has no folder for other files")?;
    let allowed = cell::MAX_MESH_BYTES as u64;
    jointplay_files::read(folder, name, allowed).map_err(|why| why.to_string())
}
