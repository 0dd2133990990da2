//! The commands of `jointplay`: read flags and files, call the library, print.
//!
//! [`run`] is the whole program, for the package `jointplay-cli` and for the Python package, which includes it.
//!
//! | file | role |
//! | --- | --- |
//! | `usage.rs` | the command line: its definition, and errors in its use |
//! | `arguments.rs` | flags shared by the commands, and how their values are read |
//! | `source.rs` | input: files, names of the catalogue, standard input |
//! | `mechanism_input.rs` | mechanism files, and values for their joints |
//! | `commands/` | one file per command |
//! | `failure.rs` | errors, and the exit code |
//! | `output.rs` | text and JSON to standard output |
//! | `play_units.rs` | units of lengths and displacements in text |
//! | `console.rs` | colours and notes |
//! | `folder.rs` | result files, written completely or not at all |
//! | `file_lock.rs` | files that one run at a time may write |
//! | `figure.rs` | the figure that `--figure` writes |
//! | `progress.rs` | progress and interruption of long computations |
//! | `space.rs` | free space of a disk |

mod arguments;
mod commands;
mod console;
mod failure;
mod figure;
mod file_lock;
mod finite;
mod folder;
mod mechanism_input;
mod model_input;
mod output;
mod play_units;
mod print_error;
mod print_page;
mod progress;
mod set_args;
mod source;
mod space;
mod usage;

use std::ffi::OsString;
use std::io::Write as _;
use std::time::Instant;

use usage::Cli;

/// Runs the command line `arguments`, of which the first is the name of the program, and returns the exit code.
///
/// Answers are printed to standard output, errors to standard error; an interruption ends the process.
#[must_use]
pub fn run(arguments: Vec<OsString>) -> u8 {
    if let Some(code) = commands::answer_shell(&arguments, usage::command) {
        return code;
    }
    let Cli { console, command } = match usage::parse(arguments) {
        Ok(cli) => cli,
        Err(code) => return code,
    };
    console.apply();
    let start = Instant::now();
    let json = command.wants_json();
    let done = command.run(usage::command);
    console::detail(&format!("{:.2} s", start.elapsed().as_secs_f64()));
    let code = match done {
        Ok(()) => 0,
        Err(failure) => failure.report(json),
    };
    // Inside another program, nothing else flushes it; a closed pipe has no reader.
    drop(std::io::stdout().flush());
    code
}
