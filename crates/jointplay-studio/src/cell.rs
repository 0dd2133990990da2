//! The cell that this server was started with: its two files, and what a program comes to in it.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use jointplay::cell::cell::Cell;
use jointplay::cell::check::{CheckOptions, Report};
use jointplay::cell::motion::{Motion, MotionError, MotionOptions};
use jointplay::cell::program::{Command, Instruction, Place, Program, ProgramError, wrong_lines};
use jointplay::cell::{Job, Memory};
use jointplay::format::export::{Flaw, Recording};
use jointplay::format::{cell, program, report};
use rayon::prelude::*;

use crate::wire::cell::{Of, ProblemAt};

/// What the example is called, in place of a file.
pub const EXAMPLE: &str = "example";

/// Where a cell and its program come from.
#[derive(Debug, Clone)]
pub struct CellFiles {
    /// Where the cell is kept; none for the example.
    path: Option<PathBuf>,
    cell: String,
    program: String,
}

impl CellFiles {
    /// The example that comes along.
    #[must_use]
    pub fn example() -> Self {
        Self { path: None, cell: cell::EXAMPLE.to_owned(), program: program::EXAMPLE.to_owned() }
    }

    /// A cell file, with the program beside it that has its name and ends in `.program`; without one, an empty program.
    ///
    /// What is wrong with the texts is no error: they can be mended in the studio, and [`Self::wrong`] says it.
    ///
    /// # Errors
    /// What the system says.
    pub fn open(path: &Path) -> Result<Self, String> {
        Self::from_disk(path)
    }

    /// What is wrong with the cell, each thing with its line.
    #[must_use]
    pub fn wrong(&self) -> Vec<String> {
        let label = self.path.as_ref().map_or_else(String::new, |path| path.display().to_string());
        let problems = self.read(&self.cell).err().unwrap_or_default();
        problems.iter().map(|problem| problem.with_excerpt(&label)).collect()
    }

    fn from_disk(path: &Path) -> Result<Self, String> {
        let cannot = |path: &Path, error| format!("cannot read {}: {error}", path.display());
        let cell = std::fs::read_to_string(path).map_err(|error| cannot(path, error))?;
        let beside = path.with_extension("program");
        let program = match std::fs::read_to_string(&beside) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(cannot(&beside, error)),
        };
        Ok(Self { path: Some(path.to_owned()), cell, program })
    }

    /// The same as it stands on the disk now.
    fn again(&self) -> Result<Self, String> {
        self.path.as_deref().map_or_else(|| Ok(self.clone()), Self::from_disk)
    }

    /// What tells these texts from others.
    pub(crate) fn version(&self) -> String {
        let mut hasher = DefaultHasher::new();
        (&self.cell, &self.program).hash(&mut hasher);
        format!("{:016x}", hasher.finish())
    }

    /// The texts of cell and program.
    pub(crate) fn into_texts(self) -> (String, String) {
        (self.cell, self.program)
    }

    /// What the cell's file is called.
    pub(crate) fn name(&self) -> Option<String> {
        let name = self.path.as_ref()?.file_name()?;
        Some(name.to_string_lossy().into_owned())
    }

    /// Reads the text of a cell that names files beside this one.
    fn read(&self, text: &str) -> Result<Cell, Vec<cell::Problem>> {
        let folder = self.path.as_deref().and_then(Path::parent);
        cell::read(text, &mut |name| {
            let folder = folder.ok_or("the example has no files beside it")?;
            let allowed = cell::MAX_MESH_BYTES as u64;
            jointplay_files::read(folder, name, allowed).map_err(|why| why.to_string())
        })
    }

    /// Writes both files, whole, or neither.
    fn write(&self) -> Result<(), String> {
        let path = self.path.as_ref().ok_or("the example is not a file: start the studio with one of your own, which `jointplay cell example` makes")?;
        let program = path.with_extension("program");
        let before = std::fs::read(path).ok();
        let (new_cell, new_program) = (beside(path, &self.cell)?, beside(&program, &self.program)?);
        put(&new_cell, path)?;
        put(&new_program, &program).inspect_err(|_| {
            // The cell as it was, beside a program as it was.
            if let Some(before) = before {
                let _ = std::fs::write(&new_cell, before)
                    .and_then(|()| std::fs::rename(&new_cell, path));
            }
        })
    }
}

/// A text in a new file beside the one that it is for.
fn beside(path: &Path, text: &str) -> Result<PathBuf, String> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    let new = path.with_file_name(name);
    std::fs::write(&new, text).map_err(|error| {
        let _ = std::fs::remove_file(&new);
        format!("cannot write {}: {error}", path.display())
    })?;
    Ok(new)
}

/// Puts the new file where the old one was.
fn put(new: &Path, path: &Path) -> Result<(), String> {
    std::fs::rename(new, path).map_err(|error| {
        let _ = std::fs::remove_file(new);
        format!("cannot write {}: {error}", path.display())
    })
}

/// Why texts are not kept.
#[derive(Debug)]
pub(crate) enum NotKept {
    /// The files are others than those that were changed.
    Changed(String),
    /// They cannot be written.
    Unwritten(String),
}

/// The two files as they stand, and the last plan made of them or of changes to them.
#[derive(Clone)]
pub(crate) struct Desk(Arc<Inner>);

struct Inner {
    files: Mutex<CellFiles>,
    last: Mutex<Option<Arc<Plan>>>,
    /// What its moves came to, for the next plan.
    memory: Mutex<Memory>,
}

impl Desk {
    pub(crate) fn new(files: CellFiles) -> Self {
        let (files, last) = (Mutex::new(files), Mutex::new(None));
        // One by one: no core is left with a bundle of them while others have none.
        let all_cores =
            |count, job: Job<'_>| (0..count).into_par_iter().with_max_len(1).for_each(job);
        Self(Arc::new(Inner { files, last, memory: Mutex::new(Memory::run_by(all_cores)) }))
    }

    /// The files as they stand.
    pub(crate) fn files(&self) -> CellFiles {
        self.0.files.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The texts given, those of the files where none are.
    pub(crate) fn texts(&self, cell: Option<String>, program: Option<String>) -> (String, String) {
        let files = self.files();
        (cell.unwrap_or(files.cell), program.unwrap_or(files.program))
    }

    /// What a program comes to in a cell; the last question is remembered.
    pub(crate) fn plan(&self, cell: String, program: String) -> Arc<Plan> {
        let last = || self.0.last.lock().unwrap_or_else(PoisonError::into_inner);
        let known = || last().as_ref().filter(|plan| plan.is_of(&cell, &program)).map(Arc::clone);
        if let Some(plan) = known() {
            return plan;
        }
        // One plan after the other: each begins with what the one before came to.
        let mut memory = self.0.memory.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(plan) = known() {
            return plan;
        }
        let plan = Arc::new(Plan::new(&self.files(), cell, program, &mut memory));
        *last() = Some(Arc::clone(&plan));
        plan
    }

    /// How much of the distances in the last plan was known from the one before.
    #[cfg(test)]
    pub(crate) fn reuse(&self) -> jointplay::cell::Reuse {
        self.0.memory.lock().unwrap_or_else(PoisonError::into_inner).reuse_of_distances()
    }

    /// The files as they stand on the disk.
    pub(crate) fn read(&self) -> Result<CellFiles, String> {
        let mut files = self.0.files.lock().unwrap_or_else(PoisonError::into_inner);
        *files = files.again()?;
        Ok(files.clone())
    }

    /// Keeps both texts in the files that they came from, unless the files are no longer those of a version.
    pub(crate) fn save(
        &self,
        cell: String,
        program: String,
        replaces: Option<&str>,
    ) -> Result<CellFiles, NotKept> {
        let mut files = self.0.files.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(version) = replaces {
            let name = files.name().unwrap_or_default();
            let now = files.again().map_err(NotKept::Changed)?;
            if now.version() != version {
                let why = format!(
                    "{name} or its program has changed on the disk since it was read: read it again, or replace it all the same"
                );
                return Err(NotKept::Changed(why));
            }
        }
        let new = CellFiles { path: files.path.clone(), cell, program };
        new.write().map_err(NotKept::Unwritten)?;
        *files = new.clone();
        Ok(new)
    }
}

/// What a program comes to in a cell, as far as it comes.
pub(crate) struct Plan {
    cell_text: String,
    program_text: String,
    pub(crate) cell: Option<Cell>,
    /// All that is wrong before anything moves.
    pub(crate) problems: Vec<ProblemAt>,
    pub(crate) motion: Option<Motion>,
    pub(crate) report: Option<Report>,
    flaws: Vec<Flaw>,
}

impl Plan {
    fn new(
        files: &CellFiles,
        cell_text: String,
        program_text: String,
        memory: &mut Memory,
    ) -> Self {
        let mut plan = Self {
            cell_text,
            program_text,
            cell: None,
            problems: Vec::new(),
            motion: None,
            report: None,
            flaws: Vec::new(),
        };
        match files.read(&plan.cell_text) {
            Ok(cell) => plan.cell = Some(cell),
            Err(problems) => plan.problems.extend(
                problems.iter().map(|one| ProblemAt::new(Of::Cell, &one.place, one.to_string())),
            ),
        }
        let (program, unread) = program::parse_what_can_be(&plan.program_text);
        let mut wrong: Vec<ProblemAt> = unread
            .iter()
            .map(|one| ProblemAt::new(Of::Program, &one.place, one.to_string()))
            .collect();
        if let (Some(cell), false) = (&plan.cell, wrong.is_empty()) {
            wrong.extend(Stopped::Steps(wrong_lines(cell, &program)).told(&plan.program_text));
            wrong.sort_by_key(|one| (one.line, one.column));
        }
        let readable = wrong.is_empty();
        plan.problems.append(&mut wrong);
        if let (Some(cell), true) = (&plan.cell, readable) {
            match motion(cell, &program, memory) {
                Ok(motion) => {
                    let report = memory.check(cell, &motion, &CheckOptions::default());
                    plan.flaws = report::flaws(&report);
                    (plan.motion, plan.report) = (Some(motion), Some(report));
                }
                Err(stopped) => plan.problems.extend(stopped.told(&plan.program_text)),
            }
        }
        plan
    }

    fn is_of(&self, cell: &str, program: &str) -> bool {
        self.cell_text == cell && self.program_text == program
    }

    /// What `jointplay cell check` says of it.
    pub(crate) fn document(&self) -> Option<report::CellReport> {
        let (cell, motion, report) =
            (self.cell.as_ref()?, self.motion.as_ref()?, self.report.as_ref()?);
        Some(report::cell(cell, &self.program_text, motion, report))
    }

    /// The motion as exports take it.
    pub(crate) fn recording(&self) -> Option<Recording<'_>> {
        Some(Recording {
            cell: self.cell.as_ref()?,
            motion: self.motion.as_ref()?,
            program: &self.program_text,
            flaws: &self.flaws,
        })
    }
}

/// Why a program comes to no motion.
enum Stopped {
    Steps(Vec<ProgramError>),
    Times(MotionError),
}

impl Stopped {
    /// All that is wrong with the text, the same at one place once.
    fn told(&self, text: &str) -> Vec<ProblemAt> {
        let mut told: Vec<ProblemAt> = Vec::new();
        let mut tell = |problem: ProblemAt| {
            if !told.contains(&problem) {
                told.push(problem);
            }
        };
        match self {
            Self::Steps(errors) => errors.iter().for_each(|error| {
                let error = program::explain(text, error);
                tell(ProblemAt::new(Of::Program, &error.place, error.to_string()));
            }),
            Self::Times(error) => error.problems.iter().for_each(|one| {
                let Place { line, column } = one.place;
                let message = one.message.clone();
                tell(ProblemAt { of: Of::Program, line, column, width: 0, message });
            }),
        }
        told
    }
}

fn motion(cell: &Cell, program: &Program, memory: &mut Memory) -> Result<Motion, Stopped> {
    let steps = memory.expand(cell, program).map_err(Stopped::Steps)?;
    memory.timed(cell, steps, &MotionOptions::default()).map_err(Stopped::Times)
}

/// The robot standing at home in a cell, for a picture of it where there is no motion.
pub(crate) fn standing(cell: &Cell) -> Option<Motion> {
    let place = Place { line: 1, column: 1 };
    let wait = Instruction { place, command: Command::Wait { seconds: 1.0 } };
    let program = Program { body: vec![wait], routines: Vec::new() };
    motion(cell, &program, &mut Memory::default()).ok()
}
