//! `jointplay completions`: for the shell.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

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
        clap_complete::generate(self.shell, &mut crate::Cli::command(), "jointplay", &mut script);
        output::raw(&String::from_utf8_lossy(&script))
    }
}
