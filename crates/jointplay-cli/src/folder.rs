//! Result files, written whole or not at all.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};

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
