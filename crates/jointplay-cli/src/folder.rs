//! Result files, written whole or not at all, and never over a file that exists unless `--force` is given.
//!
//! This is the one policy of all commands; `docs/reference/command.md` describes it for users.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use clap::Args;
use tempfile::NamedTempFile;

use crate::console;
use crate::failure::Failure;

/// Whether files that exist may be replaced.
#[derive(Args, Clone, Copy)]
pub(crate) struct ForceArgs {
    /// Replace files that exist, and write into a folder that holds files
    #[arg(long)]
    force: bool,
}

impl ForceArgs {
    /// For a file that the user names to be changed, as `--write` does.
    pub(crate) const REPLACE: Self = Self { force: true };
}

/// Files on their way are named so; one that is found was left by a run that was killed.
const PARTIAL: &str = ".jointplay-partial-";

/// Finds out before long work whether files can be made in a folder, or the folder itself; leaves nothing behind.
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
    // A link that leads nowhere is a file too.
    if force.force || path.symlink_metadata().is_err() {
        Ok(())
    } else {
        Err(Failure::Exists { path: path.to_owned() })
    }
}

/// Refuses a folder of results that holds files; those that a killed run left do not count.
///
/// Also finds out whether files can be made there: long work must not end in vain.
pub(crate) fn check_folder(folder: &Path, force: ForceArgs) -> Result<(), Failure> {
    let found = names(folder)?.into_iter().filter(|name| !name.starts_with(PARTIAL));
    let found: Vec<String> = found.collect();
    if !found.is_empty() && !force.force {
        return Err(Failure::NotEmpty { folder: folder.to_owned(), names: found });
    }
    probe(folder)
}

/// Writes files into a folder, made if missing: each appears whole, under its name, or not at all.
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

/// Files on their way into a folder: written one after the other under temporary names, and renamed together.
pub(crate) struct Staged {
    folder: PathBuf,
    /// Whether the folder was made for them.
    made: bool,
    force: ForceArgs,
    ready: Vec<(PathBuf, NamedTempFile, u64)>,
}

impl Staged {
    /// Into a folder, made if missing.
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
            let kind = std::io::ErrorKind::IsADirectory;
            let source = std::io::Error::new(kind, "a folder has this name");
            return Err(Failure::Write { path, source });
        }
        check_file(&path, self.force)?;
        let plain = |error: std::io::Error| failed(&path)(error.kind().into());
        let file = tempfile::Builder::new().prefix(PARTIAL).tempfile_in(&self.folder);
        let file = file.map_err(plain)?;
        pending(|paths| paths.push(file.path().to_owned()));
        let mut writer = std::io::BufWriter::new(file);
        match contents(&mut writer) {
            Ok(()) => {}
            Err(Contents::Write(error)) => return Err(plain(error)),
            Err(Contents::Other(failure)) => return Err(failure),
        }
        let mut file = writer.into_inner().map_err(|error| plain(error.into_error()))?;
        let length = file.as_file_mut().metadata().map_err(plain)?.len();
        self.ready.push((path, file, length));
        Ok(())
    }

    /// Gives all files their names; paths and lengths in bytes.
    pub(crate) fn publish(mut self) -> Result<Vec<(PathBuf, u64)>, Failure> {
        self.made = false;
        pending(Vec::clear);
        let mut written = Vec::with_capacity(self.ready.len());
        for (path, file, length) in std::mem::take(&mut self.ready) {
            persist(file, &path, self.force)?;
            written.push((path, length));
        }
        Ok(written)
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        self.ready.clear();
        pending(Vec::clear);
        if self.made {
            // Left as it was found; where something else was put into it, it stays.
            let _ = std::fs::remove_dir(&self.folder);
        }
    }
}

/// Temporary files of [`Staged`], which an interrupted command removes.
static PENDING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn pending<T>(change: impl FnOnce(&mut Vec<PathBuf>) -> T) -> T {
    change(&mut PENDING.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Removes files that are not complete; what cannot be removed bears a name by which the next run knows it.
pub(crate) fn discard_pending() {
    for path in pending(std::mem::take) {
        drop(std::fs::remove_file(path));
    }
}

/// Why the contents of a file are not written.
pub(crate) enum Contents {
    /// The disk or the folder.
    Write(std::io::Error),
    /// What they are made of.
    Other(Failure),
}

impl From<std::io::Error> for Contents {
    fn from(error: std::io::Error) -> Self {
        Self::Write(error)
    }
}

impl From<jointplay::format::export::Error> for Contents {
    fn from(error: jointplay::format::export::Error) -> Self {
        Self::Other(error.into())
    }
}

/// Writes one file.
pub(crate) fn write_file(path: &Path, bytes: &[u8], force: ForceArgs) -> Result<(), Failure> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    check_file(path, force)?;
    persist(partial(folder, path, bytes)?, path, force)
}

/// The contents of the file to come at `path`, whole, under a temporary name.
fn partial(folder: &Path, path: &Path, bytes: &[u8]) -> Result<NamedTempFile, Failure> {
    // The temporary name in the error would tell nobody anything.
    let plain = |error: std::io::Error| failed(path)(error.kind().into());
    let mut file = tempfile::Builder::new().prefix(PARTIAL).tempfile_in(folder).map_err(plain)?;
    file.write_all(bytes).map_err(plain)?;
    Ok(file)
}

fn persist(file: NamedTempFile, path: &Path, force: ForceArgs) -> Result<(), Failure> {
    readable(&file, path)?;
    let done = if force.force { file.persist(path) } else { file.persist_noclobber(path) };
    done.map_err(|error| match error.error.kind() {
        // It has come into being since it was checked.
        std::io::ErrorKind::AlreadyExists if !force.force => {
            Failure::Exists { path: path.to_owned() }
        }
        _ => failed(path)(error.error),
    })?;
    console::detail(&format!("{}: written", path.display()));
    Ok(())
}

/// Made private by default; results are as readable as any file of the user's.
#[cfg_attr(not(unix), expect(unused_variables, clippy::unnecessary_wraps))]
fn readable(file: &NamedTempFile, path: &Path) -> Result<(), Failure> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        let readable = std::fs::Permissions::from_mode(0o644);
        file.as_file().set_permissions(readable).map_err(failed(path))?;
    }
    Ok(())
}

/// Removes files of ours that this run did not write again, and what a killed run left.
pub(crate) fn remove_stale(
    folder: &Path,
    own: &BTreeSet<String>,
    written: &[(String, Vec<u8>)],
) -> Result<(), Failure> {
    for name in names(folder)? {
        let ours = own.contains(&name) || name.starts_with(PARTIAL);
        let path = folder.join(&name);
        if ours && !path.is_dir() && !written.iter().any(|(kept, _)| *kept == name) {
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
