//! Free space of a disk.

use std::path::Path;

/// Free space of the disk that holds a folder [bytes]; `None` where it is not known.
#[cfg(unix)]
pub(crate) fn free(folder: &Path) -> Option<f64> {
    let found = rustix::fs::statvfs(folder).ok()?;
    Some(found.f_bavail as f64 * found.f_frsize as f64)
}

/// Free space of the disk that holds a folder [bytes]; `None` where it is not known.
#[cfg(not(unix))]
pub(crate) fn free(_folder: &Path) -> Option<f64> {
    None
}
