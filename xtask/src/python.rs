//! `cargo xtask python`: build the wheel, and test it in clean environments.
//!
//! The work is done by `python/test.py`; here a Python is found that runs it, and other programs of ours.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::command;

/// Names under which a Python may be found; the first that is new enough is taken.
const NAMES: [&str; 7] =
    ["python3", "python", "python3.14", "python3.13", "python3.12", "python3.11", "python3.10"];

/// Reports by its exit code whether this Python is new enough.
const NEW_ENOUGH: &str = "import sys; sys.exit(sys.version_info < (3, 10))";

/// Builds the wheel of the Python package at `root` and tests it; true if all passed.
pub(crate) fn run(root: &Path) -> bool {
    let Ok(stand_in) = std::env::current_exe() else {
        eprintln!("python: this program cannot be found");
        return false;
    };
    with_command("python/test.py", root, Some(("CARGO", stand_in)))
}

/// Runs one of our Python programs with the path of the `jointplay` command, built now; true if it succeeded.
pub(crate) fn with_command(
    program: &str,
    root: &Path,
    environment: Option<(&str, PathBuf)>,
) -> bool {
    let Some(python) = find() else { return false };
    let Some(command) = command::built(root) else { return false };
    let mut run = Command::new(python);
    run.arg(program).arg(command).current_dir(root).envs(environment);
    match run.status() {
        Ok(status) => status.success(),
        Err(error) => {
            eprintln!("cannot start {python}: {error}");
            false
        }
    }
}

/// Replaces the `cargo rustc` of maturin: what that wants of one crate is built with the features of the tests, whose dependencies are there already.
pub(crate) fn rustc(arguments: &[&str], root: &Path) -> bool {
    // Not what `CARGO` names, which is this program.
    let build = Command::new("cargo").args(as_tested(arguments)).current_dir(root).status();
    build.is_ok_and(|status| status.success())
}

/// Arguments of cargo that build what `cargo rustc` with these arguments would.
fn as_tested<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    // Arguments of the compiler, by which some systems link a module of Python, go to a crate alone.
    if arguments.contains(&"--") {
        return [&["rustc"], arguments].concat();
    }
    let manifest = arguments.iter().position(|&word| word == "--manifest-path");
    let of_crate = |i: usize| manifest.is_some_and(|at| i == at || i == at + 1);
    let others = arguments.iter().enumerate().filter(|&(i, _)| !of_crate(i)).map(|(_, &word)| word);
    ["build"].into_iter().chain(others).chain(command::AS_TESTED).collect()
}

/// The name of a Python that is new enough; prints an error if there is none.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_crate_is_built_as_tested() {
        let check = |arguments: &str, expect: &str| {
            let words: Vec<&str> = arguments.split(' ').collect();
            assert_eq!(as_tested(&words).join(" "), expect);
        };
        check(
            "--locked --manifest-path a/Cargo.toml --lib",
            "build --locked --lib --workspace --all-features --test cli",
        );
        let linked = "--manifest-path a/Cargo.toml --lib -- -C link-arg=-undefined";
        check(linked, &format!("rustc {linked}"));
    }
}
