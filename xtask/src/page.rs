//! `cargo xtask page`: build the studio's page, and test it in a browser.
//!
//! The work is done by `studio/test.mjs`; here is only the search for a Node that runs it.

use std::path::Path;
use std::process::{Command, Stdio};

/// Fails on a Node that is too old for the page's tools.
const NEW_ENOUGH: &str = "const [major, minor] = process.versions.node.split('.').map(Number); \
                          process.exit(major > 20 || (major === 20 && minor >= 19) ? 0 : 1)";

/// Builds and tests the page at `root`; true if all passed.
pub(crate) fn run(root: &Path) -> bool {
    let Some(node) = find() else { return false };
    match Command::new(node).arg("studio/test.mjs").current_dir(root).status() {
        Ok(status) => status.success(),
        Err(error) => {
            eprintln!("page: cannot start {node}: {error}");
            false
        }
    }
}

/// The name of a Node that is new enough; says so where there is none.
pub(crate) fn find() -> Option<&'static str> {
    let mut probe = Command::new("node");
    probe.args(["--eval", NEW_ENOUGH]).stdout(Stdio::null()).stderr(Stdio::null());
    if !probe.status().is_ok_and(|status| status.success()) {
        eprintln!(
            "page: no Node 20.19 or newer on the path; install one with npm, from https://nodejs.org or your system"
        );
        return None;
    }
    Some("node")
}
