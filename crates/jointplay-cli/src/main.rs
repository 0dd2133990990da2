//! The `jointplay` command: reads flags and files, asks the library, prints.
//!
//! | file | role |
//! | --- | --- |
//! | `arguments.rs` | flags shared by the commands, and how their values are read |
//! | `mechanism_input.rs` | mechanism files, and values for their joints |
//! | `commands/` | one file a command |
//! | `failure.rs` | what can go wrong, and the exit code |
//! | `output.rs` | text and JSON to standard output |
//! | `folder.rs` | result files, written whole or not at all |
//! | `progress.rs` | how far long work has come |

mod arguments;
mod commands;
mod failure;
mod folder;
mod mechanism_input;
mod output;
mod progress;
mod space;

use std::process::ExitCode;

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

Exit codes: 0 done, 1 the answer is no (unreachable, over a limit), 2 bad input or usage.")]
struct Cli {
    #[command(subcommand)]
    command: commands::Command,
}

fn main() -> ExitCode {
    let command = Cli::parse().command;
    let json = command.wants_json();
    match command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(json),
    }
}
