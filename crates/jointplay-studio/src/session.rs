//! The work cell that the server was started with: its files and the plans of its programs.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use jointplay::cell::{IncrementalPlanner, Interrupted, StopRequested};

use crate::cell_files::{CellFiles, SaveError};
use crate::display::display_units;
use crate::plan::{Plan, Scene};

/// Number of plans kept: that of the page, and one more.
const MAX_PLANS: usize = 2;

/// A work cell under edit: its files, and the last plans of these or of edited texts.
#[derive(Clone)]
pub(crate) struct WorkcellSession(Arc<Inner>);

struct Inner {
    files: Mutex<CellFiles>,
    /// The last plans, the newest at the end.
    plans: Mutex<VecDeque<Arc<Plan>>>,
    /// Cached results of planning, reused by the next plan.
    memory: Mutex<IncrementalPlanner>,
}

impl WorkcellSession {
    pub(crate) fn new(files: CellFiles) -> Self {
        let (files, plans) = (Mutex::new(files), Mutex::default());
        Self(Arc::new(Inner { files, plans, memory: Mutex::default() }))
    }

    /// The files as last read or saved.
    pub(crate) fn files(&self) -> CellFiles {
        self.0.files.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The given texts; a missing text is that of the file.
    pub(crate) fn texts(&self, cell: Option<String>, program: Option<String>) -> (String, String) {
        let (saved_cell, saved_program) = self.files().into_texts();
        (cell.unwrap_or(saved_cell), program.unwrap_or(saved_program))
    }

    fn plans(&self) -> MutexGuard<'_, VecDeque<Arc<Plan>>> {
        self.0.plans.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The plan of a program in a cell, from the cache where both texts and all files that the cell names are those of a kept plan, with messages in the units of the request.
    pub(crate) fn plan(
        &self,
        cell: String,
        program: String,
        stop: StopRequested<'_>,
    ) -> Result<Arc<Plan>, Interrupted> {
        let (units, files) = (display_units(), self.files());
        let cached = || {
            // Files are read without the lock.
            let plans = self.plans().clone();
            plans.into_iter().find(|plan| plan.is_of(&files, (&cell, &program), units))
        };
        if let Some(plan) = cached() {
            return Ok(plan);
        }
        // Plans are computed one after the other: each reuses the results of the previous one.
        let mut memory = self.0.memory.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(plan) = cached() {
            return Ok(plan);
        }
        if stop() {
            return Err(Interrupted);
        }
        let previous = self.plans().back().map(Arc::clone);
        let texts = (cell, program);
        let plan =
            Arc::new(Plan::new(&files, texts, units, &mut memory, previous.as_deref(), stop)?);
        let mut plans = self.plans();
        plans.push_back(Arc::clone(&plan));
        while plans.len() > MAX_PLANS {
            plans.pop_front();
        }
        Ok(plan)
    }

    /// The kept plan with a key.
    pub(crate) fn kept_plan(&self, key: &str) -> Option<Arc<Plan>> {
        self.plans().iter().find(|plan| plan.key == key).map(Arc::clone)
    }

    /// The 3D scene with a key, of a kept plan.
    pub(crate) fn scene(&self, key: &str) -> Option<Arc<Scene>> {
        let plans = self.plans();
        let mut scenes = plans.iter().filter_map(|plan| plan.scene.as_ref());
        scenes.find(|scene| scene.key == key).map(Arc::clone)
    }

    /// The contents of the window with a key, of a kept plan.
    pub(crate) fn window(
        &self,
        key: &str,
    ) -> Option<Result<Vec<u8>, jointplay::interop::export::Error>> {
        let plans: Vec<Arc<Plan>> = self.plans().iter().map(Arc::clone).collect();
        plans.iter().rev().find_map(|plan| plan.window(key))
    }

    /// Keys of the kept plans.
    #[cfg(test)]
    pub(crate) fn plan_keys(&self) -> Vec<String> {
        self.plans().iter().map(|plan| plan.key.clone()).collect()
    }

    /// Cache statistics of the minimum distances of the last plan.
    #[cfg(test)]
    pub(crate) fn reuse(&self) -> jointplay::cell::CacheStats {
        self.0.memory.lock().unwrap_or_else(PoisonError::into_inner).distance_cache_stats()
    }

    /// Reads the files from disk.
    pub(crate) fn reload(&self) -> Result<CellFiles, String> {
        let mut files = self.0.files.lock().unwrap_or_else(PoisonError::into_inner);
        *files = files.reload()?;
        Ok(files.clone())
    }

    /// Saves both texts; with `replaces`, only if the files on disk still have this version.
    pub(crate) fn save(
        &self,
        cell: String,
        program: String,
        replaces: Option<&str>,
    ) -> Result<CellFiles, SaveError> {
        let mut files = self.0.files.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(version) = replaces {
            let name = files.name().unwrap_or_default();
            let on_disk = files.reload().map_err(SaveError::Changed)?;
            if on_disk.version() != version {
                let why = format!(
                    "{name} or its program was changed on disk after it was read: reload it, or save without `replaces` to overwrite it"
                );
                return Err(SaveError::Changed(why));
            }
        }
        let new = files.with_texts(cell, program);
        new.write().map_err(SaveError::Unwritable)?;
        *files = new.clone();
        Ok(new)
    }
}
