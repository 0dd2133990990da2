//! Places of the library that units contain.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::{Path, PathBuf};

/// Where the library for C is that belongs to a command: built with it, or installed with it.
///
/// # Arguments
/// * `folder` – folder of the command
#[must_use]
pub fn library_places(folder: &Path) -> [PathBuf; 4] {
    let built = format!("{DLL_PREFIX}jointplay_c{DLL_SUFFIX}");
    let installed = format!("{DLL_PREFIX}jointplay{DLL_SUFFIX}");
    [
        folder.join(&built),
        // Cargo leaves it there while it builds tests.
        folder.join("deps").join(&built),
        folder.join(&installed),
        folder.join("..").join("lib").join(&installed),
    ]
}
