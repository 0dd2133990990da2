//! `cargo xtask page`: build the studio's page, and test it in a browser.
//!
//! The work is done by `studio/test.mjs`; here a Node is found that runs it, and the command is built that serves the page.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::command;

/// Fails on a Node that is too old for the page's tools.
const NEW_ENOUGH: &str = "const [major, minor] = process.versions.node.split('.').map(Number); \
                          process.exit(major > 20 || (major === 20 && minor >= 19) ? 0 : 1)";

/// Builds and tests the page at `root`; true if all passed.
pub(crate) fn run(root: &Path) -> bool {
    let Some(node) = find() else { return false };
    let test = |command: Option<PathBuf>| {
        let mut test = Command::new(node);
        test.arg("studio/test.mjs").args(command).current_dir(root);
        test.status().is_ok_and(|status| status.success())
    };
    // The command that serves the page is built when the page has been.
    test(None) && command::built(root).is_some_and(|command| test(Some(command)))
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
