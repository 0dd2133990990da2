//! `cargo xtask package`: the archives of the published crates, unpacked and checked.
//!
//! With `--build`, the unpacked archives are also compiled and run, with nothing else of the repository in reach; with `--test`, their tests pass too.

mod archives;
mod contents;
mod trial;

use std::path::Path;

use crate::finding;

pub(crate) use archives::archives;
pub(crate) use trial::exercise;

/// What is tried with the unpacked archives; each includes those before it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Trial {
    /// Their contents and dependencies.
    Contents,
    /// The command, installed and run.
    Command,
    /// All tests in them: those at the end of sources, examples, and those in documentation.
    Tests,
}

/// Packages the published crates of the workspace at `root` and tries them; true if all passed.
pub(crate) fn run(root: &Path, trial: Trial) -> bool {
    let unpacked = match archives::unpack(root) {
        Ok(unpacked) => unpacked,
        Err(error) => {
            eprintln!("package: {error}");
            return false;
        }
    };
    let findings = match contents::check(root, &unpacked) {
        Ok(findings) => findings,
        Err(error) => {
            eprintln!("package: cannot read the archives: {error}");
            return false;
        }
    };
    finding::report("package", findings)
        && trial::resolves(&unpacked)
        && (trial < Trial::Command || trial::works(&unpacked))
        && (trial < Trial::Tests || trial::passes(&unpacked))
}
