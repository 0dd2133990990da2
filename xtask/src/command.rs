//! The `jointplay` command, built so that nothing is compiled twice.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Asks cargo for the features of `cargo test --workspace --all-features`, whose dependencies are then there already.
///
/// A test is named because what only tests depend on turns on features of what everything depends on.
pub(crate) const AS_TESTED: [&str; 4] = ["--workspace", "--all-features", "--test", "cli"];

/// The path of the command of the workspace at `root`, built now; prints an error if it cannot be built.
pub(crate) fn built(root: &Path) -> Option<PathBuf> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build.args(["build", "--quiet", "--bin", "jointplay"]).args(AS_TESTED).current_dir(root);
    if !build.status().is_ok_and(|status| status.success()) {
        eprintln!("the command `jointplay` cannot be built");
        return None;
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    let name = format!("jointplay{}", std::env::consts::EXE_SUFFIX);
    Some(root.join(target).join("debug").join(name))
}
