//! Free disk space.

use std::path::Path;

/// Free space of the disk of a folder (bytes); `None` if unknown.
#[cfg(unix)]
pub(crate) fn free(folder: &Path) -> Option<f64> {
    let found = rustix::fs::statvfs(folder).ok()?;
    Some(found.f_bavail as f64 * found.f_frsize as f64)
}

/// Free space of the disk of a folder (bytes); `None` if unknown.
#[cfg(not(unix))]
pub(crate) fn free(_folder: &Path) -> Option<f64> {
    None
}
