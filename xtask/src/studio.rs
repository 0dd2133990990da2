//! `cargo xtask studio`: the studio's server against its own description.
//!
//! The work is done by `studio/test_api.py`; here the command is built, and a Python found that runs it.

use std::path::Path;

use crate::python;

/// Tests the server of the workspace at `root`; true if all passed.
pub(crate) fn run(root: &Path) -> bool {
    python::with_command("studio/test_api.py", root, None)
}
