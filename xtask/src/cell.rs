//! `cargo xtask cell`: exported motions, read by other programs.
//!
//! The work is done by `validation/exported.py`; here the command is built, and a Python found that runs it.

use std::path::Path;

use crate::python;

/// Has other programs read what the command of the workspace at `root` exports; true if all passed.
pub(crate) fn run(root: &Path) -> bool {
    python::with_command("validation/exported.py", root, None)
}
