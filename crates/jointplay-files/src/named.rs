//! Access to files referenced by input files, such as the meshes of a cell.
//!
//! A referenced file must be in the folder of the input file or below.
//! Absolute paths, `..`, and symbolic links that leave the folder are refused.

use std::fmt;
use std::io::{self, Read as _};
use std::path::{Component, Path, PathBuf};

use crate::explain_read;

/// Why a referenced file is not read.
#[derive(Debug)]
#[non_exhaustive]
pub enum Refused {
    /// The name is not a path below the folder.
    Name,
    /// A symbolic link leaves the folder.
    Outside,
    /// There is no such file in the folder.
    Missing {
        /// The folder.
        folder: PathBuf,
    },
    /// A folder or a device has this name.
    NotAFile,
    /// The file is larger than the limit.
    TooLong {
        /// The limit, in bytes.
        allowed: u64,
    },
    /// The system cannot read the file.
    Unreadable(io::Error),
}

impl fmt::Display for Refused {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name => to.write_str(
                "it must be in the folder of the input file or below: use a relative path without `..`",
            ),
            Self::Outside => to.write_str("it leads out of the folder of the input file"),
            Self::Missing { folder } if *folder == Path::new("") || *folder == Path::new(".") => {
                to.write_str("there is no such file in this folder")
            }
            Self::Missing { folder } => write!(to, "there is no such file in {}", folder.display()),
            Self::NotAFile => to.write_str("it is not a file"),
            Self::TooLong { allowed } => {
                write!(to, "it is larger than the limit of {allowed} bytes")
            }
            Self::Unreadable(error) => to.write_str(&explain_read(error)),
        }
    }
}

impl std::error::Error for Refused {}

/// The canonical path of a file referenced by another file.
///
/// Symbolic links are resolved at each call, since they may change between calls.
///
/// # Arguments
/// * `folder` – the folder of the input file; empty for the current folder
/// * `allowed` – largest accepted size, in bytes
///
/// # Errors
/// [`Refused`], with the reason.
pub fn find(folder: &Path, name: &str, allowed: u64) -> Result<PathBuf, Refused> {
    let below = |part| matches!(part, Component::Normal(_));
    if name.is_empty() || !Path::new(name).components().all(below) {
        return Err(Refused::Name);
    }
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let failed = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound => Refused::Missing { folder: folder.to_owned() },
        _ => Refused::Unreadable(error),
    };
    let root = here.canonicalize().map_err(failed)?;
    let file = root.join(name).canonicalize().map_err(failed)?;
    if !file.starts_with(&root) {
        return Err(Refused::Outside);
    }
    let found = file.metadata().map_err(failed)?;
    if !found.is_file() {
        return Err(Refused::NotAFile);
    }
    if found.len() > allowed { Err(Refused::TooLong { allowed }) } else { Ok(file) }
}

/// The contents of a file referenced by another file, located by [`find`].
///
/// # Errors
/// [`Refused`], with the reason.
pub fn read(folder: &Path, name: &str, allowed: u64) -> Result<Vec<u8>, Refused> {
    let path = find(folder, name, allowed)?;
    let file = std::fs::File::open(path).map_err(Refused::Unreadable)?;
    let mut bytes = Vec::new();
    // Counted while reading: the file may have grown since it was found.
    file.take(allowed + 1).read_to_end(&mut bytes).map_err(Refused::Unreadable)?;
    if bytes.len() as u64 > allowed { Err(Refused::TooLong { allowed }) } else { Ok(bytes) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn refused(folder: &Path, name: &str, reason: &str) {
        let error = read(folder, name, 10).unwrap_err().to_string();
        assert!(error.contains(reason), "{name}: {error}");
    }

    #[test]
    fn files_are_read_from_their_folder_and_below_only() {
        let outer = tempfile::tempdir().unwrap();
        let folder = outer.path().join("cell");
        std::fs::create_dir_all(folder.join("shapes")).unwrap();
        std::fs::write(outer.path().join("secret.stl"), "secret").unwrap();
        std::fs::write(folder.join("shapes/wall.stl"), "wall").unwrap();
        std::fs::write(folder.join("long.stl"), "12345678901").unwrap();
        assert_eq!(read(&folder, "shapes/wall.stl", 10).unwrap(), b"wall");
        for name in ["../secret.stl", "shapes/../../secret.stl", "/etc/hostname", ""] {
            refused(&folder, name, "must be in the folder");
        }
        refused(&folder, "missing.stl", "there is no such file in ");
        refused(&folder, "shapes", "not a file");
        refused(&folder, "long.stl", "the limit of 10 bytes");
    }

    #[cfg(unix)]
    #[test]
    fn symbolic_links_within_the_folder_are_followed_and_others_refused() {
        use std::os::unix::fs::symlink;
        let outer = tempfile::tempdir().unwrap();
        let folder = outer.path().join("cell");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(outer.path().join("secret.stl"), "secret").unwrap();
        std::fs::write(folder.join("wall.stl"), "wall").unwrap();
        symlink("wall.stl", folder.join("same.stl")).unwrap();
        symlink(outer.path().join("secret.stl"), folder.join("link.stl")).unwrap();
        symlink(outer.path(), folder.join("up")).unwrap();
        assert_eq!(read(&folder, "same.stl", 10).unwrap(), b"wall");
        refused(&folder, "link.stl", "leads out of the folder");
        refused(&folder, "up/secret.stl", "leads out of the folder");
        // The folder itself may be reached by a link.
        symlink(&folder, outer.path().join("other")).unwrap();
        assert_eq!(read(&outer.path().join("other"), "wall.stl", 10).unwrap(), b"wall");
    }
}
