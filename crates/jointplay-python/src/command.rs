//! The `jointplay` command, which the package includes.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command line `arguments`, of which the first is the name of the program, and returns the exit code.
///
/// It is meant for a process of its own: an interruption ends the process.
#[pyfunction]
#[pyo3(signature = (arguments, /))]
pub(crate) fn run_command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| jointplay_commands::run(arguments))
}
