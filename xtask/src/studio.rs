//! `cargo xtask studio`: the studio's server against its own description.
//!
//! The work is done by `studio/test_api.py`; here the command is built, and a Python found that runs it.

use std::path::Path;
use std::process::Command;

use crate::python;

/// Builds the command of the workspace at `root` and tests its server; true if all passed.
pub(crate) fn run(root: &Path) -> bool {
    let Some(python) = python::find() else { return false };
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    // With the features of the other tests, so that it is there already when they have run.
    let arguments = ["build", "--workspace", "--all-features", "--bin", "jointplay"];
    let built = Command::new(cargo).args(arguments).current_dir(root).status();
    if !built.is_ok_and(|status| status.success()) {
        eprintln!("studio: the command cannot be built");
        return false;
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    let name = format!("jointplay{}", std::env::consts::EXE_SUFFIX);
    let command = root.join(target).join("debug").join(name);
    let run =
        Command::new(python).arg("studio/test_api.py").arg(command).current_dir(root).status();
    match run {
        Ok(status) => status.success(),
        Err(error) => {
            eprintln!("studio: cannot start {python}: {error}");
            false
        }
    }
}
