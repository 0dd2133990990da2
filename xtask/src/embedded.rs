//! `cargo xtask embedded`: the core without the standard library, on a simulated microcontroller.
//!
//! Any Rust checks that the core needs neither the standard library nor a heap: a program without both would not compile otherwise.
//! With the target of the microcontroller and QEMU, the program runs, and its output is compared with the committed one.

use std::path::Path;
use std::process::{Command, Stdio};
use std::{fs, io};

use crate::process;

/// A Cortex-M4 with a floating-point unit for single precision.
const TARGET: &str = "thumbv7em-none-eabihf";

const MANIFEST: &str = "examples/embedded/Cargo.toml";

/// Output of the program, one line each pose.
const OUTPUT: &str = "examples/embedded/poses.txt";

/// Checks the program on this computer's own target; true if it has neither a standard library nor a heap.
pub(crate) fn check(root: &Path) -> bool {
    done(process::succeed(cargo("check", root).arg("--quiet")))
}

/// Builds the program for the microcontroller, runs it in QEMU, and compares its output; true if it is the committed one.
pub(crate) fn run(root: &Path) -> bool {
    check(root) && done(run_in_qemu(root))
}

fn done(result: io::Result<()>) -> bool {
    result.inspect_err(|error| eprintln!("embedded: {error}")).is_ok()
}

fn cargo(what: &str, root: &Path) -> Command {
    let mut cargo = process::cargo();
    cargo.args([what, "--manifest-path", MANIFEST, "--target-dir"]);
    cargo.arg(process::target(root).join("embedded")).current_dir(root);
    cargo
}

fn run_in_qemu(root: &Path) -> io::Result<()> {
    add_target(TARGET)?;
    process::succeed(cargo("build", root).args(["--release", "--target", TARGET]))?;
    let program = process::target(root).join("embedded").join(TARGET).join("release/poses");
    let mut qemu = Command::new("qemu-system-arm");
    qemu.args(["-machine", "mps2-an386", "-nographic", "-semihosting-config"]);
    qemu.args(["enable=on,target=native", "-kernel"]).arg(program).stdin(Stdio::null());
    let found = process::output(&mut qemu).map_err(|error| {
        io::Error::other(format!("{error}; QEMU is in Debian's package qemu-system-arm"))
    })?;
    let expected = fs::read_to_string(root.join(OUTPUT))?;
    match difference(&found, &expected) {
        None => Ok(()),
        Some(line) => Err(io::Error::other(format!(
            "line {line} of {OUTPUT} is not what the microcontroller computes"
        ))),
    }
}

/// The number of the first line that differs, counted from 1.
fn difference(found: &str, expected: &str) -> Option<usize> {
    let mut lines = found.lines().zip(expected.lines());
    match lines.position(|(found, expected)| found != expected) {
        Some(line) => Some(line + 1),
        None if found.lines().count() == expected.lines().count() => None,
        None => Some(found.lines().count().min(expected.lines().count()) + 1),
    }
}

/// Has rustup fetch the core library of a target, unless it is there.
///
/// # Errors
/// If it cannot be had.
pub(crate) fn add_target(target: &str) -> io::Result<()> {
    let mut rustc = Command::new("rustc");
    rustc.args(["--print", "target-libdir", "--target", target]);
    let there = process::output(&mut rustc).is_ok_and(|folder| Path::new(folder.trim()).exists());
    if there {
        return Ok(());
    }
    println!("rustup fetches the core library of {target}");
    process::succeed(Command::new("rustup").args(["target", "add", target]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_line_that_differs_is_named() {
        let cases =
            [("a\nb\n", None), ("a\nc\n", Some(2)), ("a\n", Some(2)), ("a\nb\nc\n", Some(3))];
        for (found, line) in cases {
            assert_eq!(difference(found, "a\nb\n"), line, "{found}");
        }
    }
}
