//! `jointplay completions`: for the shell.

use clap::builder::PossibleValuesParser;
use clap::{Arg, Args, Command};
use clap_complete::Shell;
use jointplay::format::{catalogue, study};

use crate::failure::Failure;
use crate::output;

/// Print completions for a shell
#[derive(Args)]
#[command(after_help = "\
Example:
  jointplay completions bash > ~/.local/share/bash-completion/completions/jointplay")]
pub(crate) struct Completions {
    /// Which shell
    shell: Shell,
}

impl Completions {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let mut script = Vec::new();
        let mut command = crate::usage::command();
        if self.shell == Shell::Bash {
            // Other shells would offer names in place of files; Bash falls back to files.
            command = with_names(command);
        }
        clap_complete::generate(self.shell, &mut command, "jointplay", &mut script);
        output::raw(&String::from_utf8_lossy(&script))
    }
}

/// The command line with names of the catalogue, or of studies, where a file is asked for.
fn with_names(command: Command) -> Command {
    if command.get_name() == "cell" {
        return command;
    }
    let is_study = command.get_name() == "study";
    let names = move || -> Vec<&'static str> {
        if is_study {
            study::examples().iter().map(|example| example.name).collect()
        } else {
            catalogue::entries().iter().map(|entry| entry.name).collect()
        }
    };
    let named = |argument: &Arg| {
        let is_robot = argument.get_long() == Some("robot");
        is_robot
            || (argument.is_positional() && matches!(argument.get_id().as_str(), "file" | "name"))
    };
    command
        .mut_args(|one| {
            if named(&one) { one.value_parser(PossibleValuesParser::new(names())) } else { one }
        })
        .mut_subcommands(with_names)
}
