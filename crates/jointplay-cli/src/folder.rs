//! Result files, written whole or not at all.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::NamedTempFile;

use crate::failure::Failure;

/// Files on their way are named so; one that is found was left by a run that was killed.
const PARTIAL: &str = ".jointplay-partial-";

/// Finds out before long work whether files can be made in a folder, or the folder itself; leaves nothing behind.
pub(crate) fn probe(folder: &Path) -> Result<(), Failure> {
    let here = Path::new(".");
    let mut places =
        folder.ancestors().map(|path| if path.as_os_str().is_empty() { here } else { path });
    let there = places.find(|path| path.exists()).unwrap_or(folder);
    tempfile::tempfile_in(there).map_err(|error| failed(folder)(error.kind().into()))?;
    Ok(())
}

/// Writes files into a folder, made if missing: each appears whole, under its name, or not at all.
pub(crate) fn write(folder: &Path, files: &[(String, Vec<u8>)]) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(failed(folder))?;
    if let Some(path) = files.iter().map(|(name, _)| folder.join(name)).find(|path| path.is_dir()) {
        let source =
            std::io::Error::new(std::io::ErrorKind::IsADirectory, "a folder is in its place");
        return Err(Failure::Write { path, source });
    }
    // All contents first: a full disk is found out before anything is replaced.
    let mut ready = Vec::with_capacity(files.len());
    for (name, bytes) in files {
        let path = folder.join(name);
        let file = partial(folder, &path, bytes)?;
        ready.push((path, file));
    }
    for (path, file) in ready {
        persist(file, &path)?;
    }
    Ok(())
}

/// Files on their way into a folder: written one after the other under temporary names, and renamed together.
pub(crate) struct Staged {
    folder: PathBuf,
    /// Whether the folder was made for them.
    made: bool,
    ready: Vec<(PathBuf, NamedTempFile, u64)>,
}

impl Staged {
    /// Into a folder, made if missing.
    pub(crate) fn into(folder: &Path) -> Result<Self, Failure> {
        let made = !folder.exists();
        std::fs::create_dir_all(folder).map_err(failed(folder))?;
        Ok(Self { folder: folder.to_owned(), made, ready: Vec::new() })
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
            let source = std::io::Error::new(kind, "a folder is in its place");
            return Err(Failure::Write { path, source });
        }
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
            persist(file, &path)?;
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

/// Ends the command with the exit code of an interruption when Ctrl-C is pressed; files that are not complete are removed.
pub(crate) fn listen() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        for path in pending(std::mem::take) {
            // What cannot be removed bears a name by which the next run knows it.
            let _ = std::fs::remove_file(path);
        }
        #[expect(clippy::exit, reason = "the work is interrupted, and nothing is left to do")]
        std::process::exit(crate::failure::INTERRUPTED.into());
    })
    .map_err(|error| Failure::Misused(format!("cannot listen for Ctrl-C: {error}")))
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

/// Writes one file; it replaces one of the same name.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    persist(partial(folder, path, bytes)?, path)
}

/// Writes one file into a folder, made if missing, unless something of its name is there.
pub(crate) fn write_new(folder: &Path, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(failed(folder))?;
    let file = partial(folder, path, bytes)?;
    readable(&file, path)?;
    file.persist_noclobber(path).map_err(|error| {
        let plain = match error.error.kind() {
            std::io::ErrorKind::AlreadyExists => {
                std::io::Error::new(error.error.kind(), "something of this name is there already")
            }
            _ => error.error,
        };
        failed(path)(plain)
    })?;
    Ok(())
}

/// The contents of the file to come at `path`, whole, under a temporary name.
fn partial(folder: &Path, path: &Path, bytes: &[u8]) -> Result<NamedTempFile, Failure> {
    // The temporary name in the error would tell nobody anything.
    let plain = |error: std::io::Error| failed(path)(error.kind().into());
    let mut file = tempfile::Builder::new().prefix(PARTIAL).tempfile_in(folder).map_err(plain)?;
    file.write_all(bytes).map_err(plain)?;
    Ok(file)
}

fn persist(file: NamedTempFile, path: &Path) -> Result<(), Failure> {
    readable(&file, path)?;
    file.persist(path).map_err(|error| failed(path)(error.error))?;
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

/// Names in a folder that are neither files in `own` nor left by a killed run; none if there is no folder.
pub(crate) fn foreign(folder: &Path, own: &BTreeSet<String>) -> Result<Vec<String>, Failure> {
    let ours = |name: &String| {
        (own.contains(name) || name.starts_with(PARTIAL)) && !folder.join(name).is_dir()
    };
    Ok(names(folder)?.into_iter().filter(|name| !ours(name)).collect())
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
