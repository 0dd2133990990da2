//! Result files: written completely or not at all, and replaced only with `--force`.
//!
//! All commands follow this policy; `docs/reference/command.md` describes it for users.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use clap::Args;
use jointplay_files::{NewFile, PARTIAL_PREFIX};

use crate::console;
use crate::failure::Failure;

/// Whether files that exist may be replaced.
#[derive(Args, Clone, Copy)]
pub(crate) struct ForceArgs {
    /// Replace existing files, and write into a folder that contains files
    #[arg(long)]
    force: bool,
}

impl ForceArgs {
    /// No permission to replace files.
    pub(crate) const KEEP: Self = Self { force: false };

    /// Permission to change a file given by the user, as `--write` does.
    pub(crate) const REPLACE: Self = Self { force: true };

    /// Whether existing files may be replaced.
    pub(crate) fn is_given(self) -> bool {
        self.force
    }
}

/// Checks before a long computation whether a folder, and files in it, can be created; leaves nothing behind.
fn probe(folder: &Path) -> Result<(), Failure> {
    let here = Path::new(".");
    let mut places =
        folder.ancestors().map(|path| if path.as_os_str().is_empty() { here } else { path });
    let there = places.find(|path| path.exists()).unwrap_or(folder);
    tempfile::tempfile_in(there).map_err(|error| failed(folder)(error.kind().into()))?;
    Ok(())
}

/// Refuses a file that exists.
pub(crate) fn check_file(path: &Path, force: ForceArgs) -> Result<(), Failure> {
    // A dangling link is also a file.
    if force.force || path.symlink_metadata().is_err() {
        Ok(())
    } else {
        Err(Failure::Exists { path: path.to_owned() })
    }
}

/// Refuses a results folder that contains files, other than those left by a killed run.
///
/// Also checks that files can be created there, before a long computation.
pub(crate) fn check_folder(folder: &Path, force: ForceArgs) -> Result<(), Failure> {
    let found = names(folder)?.into_iter().filter(|name| !name.starts_with(PARTIAL_PREFIX));
    let found: Vec<String> = found.collect();
    if !found.is_empty() && !force.force {
        return Err(Failure::NotEmpty { folder: folder.to_owned(), names: found });
    }
    probe(folder)
}

/// Writes files into a folder, created if missing: each file appears complete or not at all.
pub(crate) fn write(
    folder: &Path,
    files: &[(String, Vec<u8>)],
    force: ForceArgs,
) -> Result<(), Failure> {
    let mut staged = Staged::into(folder, force)?;
    for (name, bytes) in files {
        staged.add(name, |writer| Ok(writer.write_all(bytes)?))?;
    }
    staged.publish().map(drop)
}

/// Files to be added to a folder: written one after the other under temporary names, and renamed together.
pub(crate) struct Staged {
    folder: PathBuf,
    /// Whether the folder was created for them.
    made: bool,
    force: ForceArgs,
    ready: Vec<Ready>,
}

/// A complete file under its temporary name.
struct Ready {
    path: PathBuf,
    file: NewFile,
    /// (bytes)
    length: u64,
}

/// A file written.
pub(crate) struct WrittenFile {
    pub(crate) path: PathBuf,
    /// (bytes)
    pub(crate) length: u64,
}

impl Staged {
    /// Starts with no files; the folder is created if missing.
    pub(crate) fn into(folder: &Path, force: ForceArgs) -> Result<Self, Failure> {
        let made = !folder.exists();
        std::fs::create_dir_all(folder).map_err(failed(folder))?;
        Ok(Self { folder: folder.to_owned(), made, force, ready: Vec::new() })
    }

    /// Writes the contents of one file.
    pub(crate) fn add(
        &mut self,
        name: &str,
        contents: impl FnOnce(&mut (dyn std::io::Write + Send)) -> Result<(), Contents>,
    ) -> Result<(), Failure> {
        let path = self.folder.join(name);
        if path.is_dir() {
            return Err(failed(&path)(std::io::ErrorKind::IsADirectory.into()));
        }
        check_file(&path, self.force)?;
        let file = NewFile::begin(&path).map_err(failed(&path))?;
        pending(|paths| paths.push(file.temporary_path().to_owned()));
        let mut writer = std::io::BufWriter::new(file);
        match contents(&mut writer) {
            Ok(()) => {}
            Err(Contents::Write(error)) => return Err(failed(&path)(error)),
            Err(Contents::Other(failure)) => return Err(failure),
        }
        let file = writer.into_inner().map_err(|error| failed(&path)(error.into_error()))?;
        let length = file.length().map_err(failed(&path))?;
        self.ready.push(Ready { path, file, length });
        Ok(())
    }

    /// Renames all files to their final names.
    pub(crate) fn publish(mut self) -> Result<Vec<WrittenFile>, Failure> {
        self.made = false;
        pending(Vec::clear);
        let mut written = Vec::with_capacity(self.ready.len());
        for Ready { path, file, length } in std::mem::take(&mut self.ready) {
            persist(file, &path, self.force)?;
            written.push(WrittenFile { path, length });
        }
        Ok(written)
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        self.ready.clear();
        pending(Vec::clear);
        if self.made {
            // Removed only if empty: others may have added files.
            let _ = std::fs::remove_dir(&self.folder);
        }
    }
}

/// Temporary files of [`Staged`], removed if the command is interrupted.
static PENDING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn pending<T>(change: impl FnOnce(&mut Vec<PathBuf>) -> T) -> T {
    change(&mut PENDING.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Removes incomplete files; the next run recognizes the remaining ones by their prefix.
pub(crate) fn discard_pending() {
    for path in pending(std::mem::take) {
        drop(std::fs::remove_file(path));
    }
}

/// Why the contents of a file were not written.
pub(crate) enum Contents {
    /// An error of the disk or folder.
    Write(std::io::Error),
    /// An error in computing the contents.
    Other(Failure),
}

impl From<std::io::Error> for Contents {
    fn from(error: std::io::Error) -> Self {
        Self::Write(error)
    }
}

impl From<Failure> for Contents {
    fn from(failure: Failure) -> Self {
        Self::Other(failure)
    }
}

impl From<jointplay::interop::export::Error> for Contents {
    fn from(error: jointplay::interop::export::Error) -> Self {
        Self::Other(error.into())
    }
}

/// Writes one file.
pub(crate) fn write_file(path: &Path, bytes: &[u8], force: ForceArgs) -> Result<(), Failure> {
    check_file(path, force)?;
    persist(partial(path, bytes)?, path, force)
}

/// Writes one file and waits until the disk has it, so that it is complete even after a power cut.
pub(crate) fn write_durable(path: &Path, bytes: &[u8], force: ForceArgs) -> Result<(), Failure> {
    check_file(path, force)?;
    let mut file = partial(path, bytes)?;
    file.sync().map_err(failed(path))?;
    persist(file, path, force)
}

/// The contents of the future file at `path`, complete, under a temporary name.
fn partial(path: &Path, bytes: &[u8]) -> Result<NewFile, Failure> {
    let mut file = NewFile::begin(path).map_err(failed(path))?;
    file.write_all(bytes).map_err(failed(path))?;
    Ok(file)
}

fn persist(file: NewFile, path: &Path, force: ForceArgs) -> Result<(), Failure> {
    let done = if force.force { file.replace() } else { file.create() };
    done.map_err(|error| match error.kind() {
        // It was created after the check.
        std::io::ErrorKind::AlreadyExists if !force.force => {
            Failure::Exists { path: path.to_owned() }
        }
        _ => failed(path)(error),
    })?;
    console::detail(&format!("{}: written", path.display()));
    Ok(())
}

/// Removes files of the previous run that this run did not write, and temporary files of killed runs.
pub(crate) fn remove_stale(
    folder: &Path,
    own: &BTreeSet<String>,
    written: &[(String, Vec<u8>)],
) -> Result<(), Failure> {
    for name in names(folder)? {
        let ours = own.contains(&name) || name.starts_with(PARTIAL_PREFIX);
        let path = folder.join(&name);
        if ours && !path.is_dir() && !written.iter().any(|(new, _)| *new == name) {
            std::fs::remove_file(&path).map_err(failed(&path))?;
        }
    }
    Ok(())
}

fn names(folder: &Path) -> Result<Vec<String>, Failure> {
    let entries = match std::fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(failed(folder))?,
    };
    let mut names = Vec::new();
    for entry in entries {
        names.push(entry.map_err(failed(folder))?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}

fn failed(path: &Path) -> impl FnOnce(std::io::Error) -> Failure + use<> {
    let path: PathBuf = path.to_owned();
    move |source| Failure::Write { path, source }
}
