//! The cell that this server was started with: its two files, and what a program comes to in it.

use std::collections::VecDeque;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use jointplay::cell::workcell::Cell;
use jointplay::cell::{Interrupted, Job, Memory, Stop};
use jointplay::format::{cell, program};
use rayon::prelude::*;

use crate::cell_plan::{Plan, Scene};

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

    /// A hash of the file's absolute path; constant for the example, which is not a file.
    pub(crate) fn identity(&self) -> String {
        let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let mut hasher = DefaultHasher::new();
        self.path.as_deref().map(absolute).hash(&mut hasher);
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
    pub(crate) fn read(&self, text: &str) -> Result<Cell, Vec<cell::Problem>> {
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

/// Plans that are remembered: that of the page, and one more.
const PLANS: usize = 2;

/// The two files as they stand, and the last plans made of them or of changes to them.
#[derive(Clone)]
pub(crate) struct Desk(Arc<Inner>);

struct Inner {
    files: Mutex<CellFiles>,
    /// The last ones, the newest at the end.
    plans: Mutex<VecDeque<Arc<Plan>>>,
    /// What its moves came to, for the next plan.
    memory: Mutex<Memory>,
}

impl Desk {
    pub(crate) fn new(files: CellFiles) -> Self {
        let (files, plans) = (Mutex::new(files), Mutex::default());
        // One by one: no core is left with a bundle of them while others have none.
        let all_cores =
            |count, job: Job<'_>| (0..count).into_par_iter().with_max_len(1).for_each(job);
        Self(Arc::new(Inner { files, plans, memory: Mutex::new(Memory::run_by(all_cores)) }))
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

    fn plans(&self) -> MutexGuard<'_, VecDeque<Arc<Plan>>> {
        self.0.plans.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What a program comes to in a cell; the last questions are remembered.
    pub(crate) fn plan(
        &self,
        cell: String,
        program: String,
        stop: Stop<'_>,
    ) -> Result<Arc<Plan>, Interrupted> {
        let known = || self.plans().iter().find(|plan| plan.is_of(&cell, &program)).map(Arc::clone);
        if let Some(plan) = known() {
            return Ok(plan);
        }
        // One plan after the other: each begins with what the one before came to.
        let mut memory = self.0.memory.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(plan) = known() {
            return Ok(plan);
        }
        if stop() {
            return Err(Interrupted);
        }
        let last = self.plans().back().map(Arc::clone);
        let texts = (cell, program);
        let plan = Arc::new(Plan::new(&self.files(), texts, &mut memory, last.as_deref(), stop)?);
        let mut plans = self.plans();
        plans.push_back(Arc::clone(&plan));
        while plans.len() > PLANS {
            plans.pop_front();
        }
        Ok(plan)
    }

    /// A plan that is remembered.
    pub(crate) fn planned(&self, key: &str) -> Option<Arc<Plan>> {
        self.plans().iter().find(|plan| plan.key == key).map(Arc::clone)
    }

    /// The picture of a cell standing still that is remembered.
    pub(crate) fn scene(&self, key: &str) -> Option<Arc<Scene>> {
        let plans = self.plans();
        let mut scenes = plans.iter().filter_map(|plan| plan.scene.as_ref());
        scenes.find(|scene| scene.key == key).map(Arc::clone)
    }

    /// The content of a window of a plan that is remembered.
    pub(crate) fn window(
        &self,
        key: &str,
    ) -> Option<Result<Vec<u8>, jointplay::format::export::Error>> {
        let plans: Vec<Arc<Plan>> = self.plans().iter().map(Arc::clone).collect();
        plans.iter().rev().find_map(|plan| plan.window(key))
    }

    /// Keys of the plans that are remembered.
    #[cfg(test)]
    pub(crate) fn remembered(&self) -> Vec<String> {
        self.plans().iter().map(|plan| plan.key.clone()).collect()
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
