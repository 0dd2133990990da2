//! The `jointplay` command: reads flags and files, asks the library, prints.
//!
//! | file | role |
//! | --- | --- |
//! | `usage.rs` | the command line: its definition, and errors in its use |
//! | `arguments.rs` | flags shared by the commands, and how their values are read |
//! | `source.rs` | files of input, names of the catalogue, standard input |
//! | `mechanism_input.rs` | mechanism files, and values for their joints |
//! | `commands/` | one file a command |
//! | `failure.rs` | what can go wrong, and the exit code |
//! | `output.rs` | text and JSON to standard output |
//! | `console.rs` | colours and notes |
//! | `folder.rs` | result files, written whole or not at all |
//! | `figure.rs` | the figure that `--figure` asks for |
//! | `progress.rs` | how far long work has come, and its interruption |

mod arguments;
mod commands;
mod console;
mod failure;
mod figure;
mod folder;
mod mechanism_input;
mod output;
mod progress;
mod source;
mod space;
mod usage;

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;

/// Models, analyses and simulates robots that move only because their joints have play.
#[derive(Parser)]
#[command(
    name = "jointplay",
    version,
    max_term_width = 100,
    subcommand_required = true,
    arg_required_else_help = true
)]
#[command(after_help = "\
Examples:
  jointplay simulate                          the paper's studies, as data and figures
  jointplay study --out shifts.csv            any number of poses or robots, from a text file
  jointplay forward --q-mm 500,501,502        where the platform is for these rods
  jointplay inverse --yaw-deg 17 --pitch-deg 1.5 --height-mm 500
  jointplay compare                           what the models say of one tilt
  jointplay catalogue                         mechanisms that come with the program
  jointplay mobility bennett                  what of a mechanism can move
  jointplay draw bennett                      what it looks like
  jointplay cell check                        whether a program of a robot with arms may be run

A file may be a name from `jointplay catalogue`, or - for standard input.
No command replaces a file without --force.
JSON documents and CSV columns of one 0.x series keep the names, units and meaning of their keys; new keys may be added.

Exit codes: 0 done, 1 the answer is no (unreachable, over a limit), 2 bad input or usage, 130 interrupted.")]
struct Cli {
    #[command(flatten)]
    console: console::ConsoleArgs,
    #[command(subcommand)]
    command: commands::Command,
}

fn main() -> ExitCode {
    commands::answer_shell();
    let Cli { console, command } = match usage::parse() {
        Ok(cli) => cli,
        Err(code) => return code,
    };
    console.apply();
    let start = Instant::now();
    let json = command.wants_json();
    let done = command.run();
    console::detail(&format!("{:.2} s", start.elapsed().as_secs_f64()));
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(json),
    }
}
