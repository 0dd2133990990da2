//! The program `jointplay`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(jointplay_commands::run(std::env::args_os().collect()))
}
