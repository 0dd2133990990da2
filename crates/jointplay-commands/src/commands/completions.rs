//! `jointplay completions`: completion of commands, options, files and catalogue names in a shell.
//!
//! The printed script asks this program for candidates at each Tab, so every shell knows the same names.

use std::ffi::{OsStr, OsString};

use clap::{Arg, Args, Command};
use clap_complete::engine::{
    ArgValueCompleter, CompletionCandidate, PathCompleter, ValueCompleter as _,
};
use clap_complete::env::Shells;
use clap_complete::{CompleteEnv, Shell};
use jointplay::format::{catalogue, study};

use crate::failure::{BAD_INPUT, Failure};
use crate::output;

/// Print the completion script of a shell
///
/// The script completes commands, options, file names and names of the catalogue.
/// It calls `jointplay` while completing; load it again after an update.
#[derive(Args)]
#[command(after_help = "\
Examples:
  source <(jointplay completions bash)                 in ~/.bashrc
  source <(jointplay completions zsh)                  in ~/.zshrc
  jointplay completions fish > ~/.config/fish/completions/jointplay.fish")]
pub(crate) struct Completions {
    /// The shell
    shell: Shell,
}

/// The variable by which a completion script asks for candidates.
const VARIABLE: &str = "JOINTPLAY_COMPLETE";

impl Completions {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let mut script = Vec::new();
        let name = self.shell.to_string();
        let shells = Shells::builtins();
        let shell = shells.completer(&name).expect("every shell of the list has a completer");
        shell.write_registration(VARIABLE, "jointplay", "jointplay", "jointplay", &mut script)?;
        output::raw(&String::from_utf8_lossy(&script))
    }
}

/// Prints the candidates and returns the exit code, if a completion script asks for them.
pub(crate) fn answer_shell(arguments: &[OsString], definition: fn() -> Command) -> Option<u8> {
    let folder = std::env::current_dir().ok();
    let completer = CompleteEnv::with_factory(|| with_names(definition())).var(VARIABLE);
    match completer.try_complete(arguments, folder.as_deref()) {
        Ok(answered) => answered.then_some(0),
        Err(error) => {
            drop(error.print());
            Some(BAD_INPUT)
        }
    }
}

/// The names that complete an argument, in addition to files.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Names {
    Robots,
    Catalogue,
    Studies,
}

impl Names {
    fn of(command: &str, argument: &Arg) -> Option<Self> {
        let is_file = || matches!(argument.get_id().as_str(), "file" | "name");
        if argument.get_long() == Some("robot") {
            Some(Self::Robots)
        } else if !argument.is_positional() || !is_file() {
            None
        } else if command == "study" {
            Some(Self::Studies)
        } else {
            Some(Self::Catalogue)
        }
    }

    fn all(self) -> Vec<&'static str> {
        let entries = catalogue::entries().iter();
        match self {
            Self::Robots => {
                let robots = entries.filter(|entry| entry.kind().as_deref() == Some("gpr"));
                robots.map(|entry| entry.name).collect()
            }
            Self::Catalogue => entries.map(|entry| entry.name).collect(),
            Self::Studies => study::examples().iter().map(|example| example.name).collect(),
        }
    }

    fn candidates(self, current: &OsStr) -> Vec<CompletionCandidate> {
        let start = current.to_string_lossy();
        let names = self.all().into_iter().filter(|name| name.starts_with(&*start));
        let mut found: Vec<_> = names.map(CompletionCandidate::new).collect();
        found.extend(PathCompleter::any().complete(current));
        found
    }
}

/// The command line with completers for arguments that take names of the catalogue or of studies.
fn with_names(command: Command) -> Command {
    // Its files are cells and programs, of which the catalogue has none.
    if command.get_name() == "cell" {
        return command;
    }
    let name = command.get_name().to_owned();
    command
        .mut_args(|argument| match Names::of(&name, &argument) {
            Some(names) => {
                let completer = move |current: &OsStr| names.candidates(current);
                argument.add(ArgValueCompleter::new(completer))
            }
            None => argument,
        })
        .mut_subcommands(with_names)
}
