//! `cargo xtask python`: build the wheel, and test it in clean environments.
//!
//! The work is done by `python/test.py`; here is only the search for a Python that runs it.

use std::path::Path;
use std::process::{Command, Stdio};

/// Names under which a Python may be found; the first that is new enough is taken.
const NAMES: [&str; 7] =
    ["python3", "python", "python3.14", "python3.13", "python3.12", "python3.11", "python3.10"];

/// Says by its exit code whether this Python is new enough.
const NEW_ENOUGH: &str = "import sys; sys.exit(sys.version_info < (3, 10))";

/// Runs the tests of the Python package at `root`; true if all passed.
pub(crate) fn run(root: &Path) -> bool {
    let Some(python) = find() else { return false };
    match Command::new(python).arg("python/test.py").current_dir(root).status() {
        Ok(status) => status.success(),
        Err(error) => {
            eprintln!("python: cannot start {python}: {error}");
            false
        }
    }
}

/// The name of a Python that is new enough; says so where there is none.
pub(crate) fn find() -> Option<&'static str> {
    let found = NAMES.into_iter().find(|name| is_new_enough(name));
    if found.is_none() {
        eprintln!(
            "python: no Python 3.10 or newer on the path; install one, from https://python.org or your system"
        );
    }
    found
}

fn is_new_enough(python: &str) -> bool {
    let mut command = Command::new(python);
    command.args(["-c", NEW_ENOUGH]).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}
