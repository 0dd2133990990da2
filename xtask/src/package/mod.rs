//! `cargo xtask package`: the archives of the published crates, unpacked and checked.
//!
//! With `--build`, the unpacked archives are also compiled and run, with nothing else of the repository in reach.

mod archives;
mod contents;
mod trial;

use std::path::Path;

use crate::finding;

pub(crate) use archives::archives;
pub(crate) use trial::exercise;

/// Packages the published crates of the workspace at `root` and checks the contents; with `build`, also compiles and runs them. True if all passed.
pub(crate) fn run(root: &Path, build: bool) -> bool {
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
        && (!build || trial::works(&unpacked))
}
