//! The repository's top folder, wherever the command was started.

use std::path::{Path, PathBuf};

/// The folder above this crate's manifest, as cargo reports it at run time.
///
/// The path compiled in is the fallback for a binary started without cargo.
pub(crate) fn find() -> PathBuf {
    let manifest = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    let crate_folder = manifest.unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")));
    crate_folder.parent().map_or_else(|| PathBuf::from("."), Path::to_path_buf)
}
