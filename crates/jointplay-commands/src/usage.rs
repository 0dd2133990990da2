//! The command line: its definition, its arguments, and errors in its use.

use std::ffi::{OsStr, OsString};
use std::io::Write as _;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{ColorChoice, Command, CommandFactory as _, FromArgMatches as _, Parser};

use crate::commands;
use crate::console::ConsoleArgs;
use crate::failure::BAD_INPUT;

/// Models, analyses and simulates overconstrained robots, some of whose motions need play in the joints.
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
  jointplay simulate                          data and figures of the paper's studies
  jointplay study --out shifts.csv            a table over many poses or robots
  jointplay forward --q-mm 500,501,502        platform pose for given rod lengths
  jointplay inverse --azimuth-deg 17 --tilt-deg 1.5 --height-mm 500
  jointplay compare                           compare the models over a range of tilts
  jointplay catalogue                         list the included robots and mechanisms
  jointplay mobility bennett                  mobility and redundant constraints
  jointplay draw bennett                      draw a mechanism
  jointplay cell check                        check the program of a work cell

A name from `jointplay catalogue` can be used in place of a file; - is standard input.
Files are replaced only with --force.
Within one 0.x series, keys of JSON documents and columns of CSV tables keep their names, units and meaning; new ones may be added.

Exit codes: 0 done, 1 infeasible (unreachable, limit exceeded, check failed), 2 bad input or usage, 130 interrupted.")]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) console: ConsoleArgs,
    #[command(subcommand)]
    pub(crate) command: commands::Command,
}

/// Exit codes in the help of commands that do not list their own.
const EXIT_CODES: &str = "\
Exit codes: 0 done, 1 infeasible (unreachable, limit exceeded, check failed), 2 bad input or usage, 130 interrupted.";

/// The definition of the command line, with exit codes in the help of every command.
pub(crate) fn command() -> Command {
    with_exit_codes(Cli::command())
}

fn with_exit_codes(command: Command) -> Command {
    let own = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let command = if own.contains("Exit codes:") {
        command
    } else {
        let gap = if own.is_empty() { "" } else { "\n\n" };
        command.after_help(format!("{}{gap}{EXIT_CODES}", own.trim_end()))
    };
    command.mut_subcommands(with_exit_codes)
}

/// Parses the arguments, of which the first is the name of the program; prints help or usage errors and returns the exit code.
pub(crate) fn parse(arguments: Vec<OsString>) -> Result<Cli, u8> {
    let arguments = with_negative_values(arguments.into_iter());
    let command = command().color(color(&arguments));
    let parsed = command.try_get_matches_from(&arguments);
    let parsed = parsed.and_then(|matches| Cli::from_arg_matches(&matches));
    parsed.map_err(|error| report(&error, wants_json(&arguments)))
}

/// Joins negative numbers to the option before them: `--azimuth-deg -1e-5` becomes `--azimuth-deg=-1e-5`.
///
/// No option begins with a digit, so a negative number is never an option itself.
pub(crate) fn with_negative_values(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    let mut only_values = false;
    for argument in arguments {
        let text = argument.to_string_lossy();
        let option = joined.last_mut().filter(|last| !only_values && is_open_option(last));
        if let Some(option) = option
            && is_negative(&text)
        {
            option.push("=");
            option.push(&argument);
            continue;
        }
        only_values |= text == "--";
        joined.push(argument);
    }
    joined
}

/// Whether an argument is a long option without its value.
fn is_open_option(argument: &OsStr) -> bool {
    let text = argument.to_string_lossy();
    text.len() > 2 && text.starts_with("--") && !text.contains('=')
}

/// Whether a text starts like a negative number.
fn is_negative(text: &str) -> bool {
    let Some(rest) = text.strip_prefix('-') else { return false };
    let rest = rest.strip_prefix('.').unwrap_or(rest).to_ascii_lowercase();
    rest.starts_with(|letter: char| letter.is_ascii_digit())
        || rest.starts_with("inf")
        || rest.starts_with("nan")
}

/// The value of an option, before the arguments are parsed.
fn value<'a>(arguments: &'a [OsString], option: &str) -> Option<&'a str> {
    let mut texts = arguments.iter().map(|argument| argument.to_str().unwrap_or_default());
    while let Some(text) = texts.next() {
        if text == option {
            return texts.next();
        }
        if let Some(value) = text.strip_prefix(option).and_then(|rest| rest.strip_prefix('=')) {
            return Some(value);
        }
    }
    None
}

fn wants_json(arguments: &[OsString]) -> bool {
    value(arguments, "--format") == Some("json")
}

fn color(arguments: &[OsString]) -> ColorChoice {
    match value(arguments, "--color") {
        Some("always") => ColorChoice::Always,
        Some("never") => ColorChoice::Never,
        _ => ColorChoice::Auto,
    }
}

/// Prints help, the version, or a usage error.
fn report(error: &clap::Error, json: bool) -> u8 {
    if !error.use_stderr() {
        // A closed pipe has no reader.
        drop(error.print());
        return 0;
    }
    let hint = missing_feature(error).map(|feature| {
        format!("this jointplay was built without {feature}: build with --features {feature}")
    });
    let is_help = error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
    if json && !is_help {
        let text = error.render().to_string();
        let text = text.split("\n\nUsage:").next().unwrap_or(&text);
        let text = text.split("\n\nFor more information").next().unwrap_or(text);
        let message = text.strip_prefix("error: ").unwrap_or(text).trim_end();
        let message = [Some(message), hint.as_deref()].into_iter().flatten();
        let message = message.collect::<Vec<_>>().join("\n");
        let document = serde_json::json!({ "error": {
            "kind": "usage", "message": message, "limits_broken": [], "places": [],
        }});
        drop(writeln!(std::io::stderr(), "{document}"));
    } else {
        drop(error.print());
        if let Some(hint) = hint {
            drop(writeln!(anstream::stderr(), "{hint}"));
        }
    }
    BAD_INPUT
}

/// The feature that a value needs and this build lacks.
fn missing_feature(error: &clap::Error) -> Option<&'static str> {
    let Some(ContextValue::String(found)) = error.get(ContextKind::InvalidValue) else {
        return None;
    };
    let optional = [("parquet", cfg!(feature = "parquet")), ("mcap", cfg!(feature = "mcap"))];
    let missing = optional.into_iter().find(|(name, built)| name == found && !built);
    missing.map(|(name, _)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Calls `check` for every command and its subcommands, with the words of its line.
    fn each(command: &Command, words: &[String], check: &mut impl FnMut(&Command, &[String])) {
        check(command, words);
        for sub in command.get_subcommands().filter(|sub| sub.get_name() != "help") {
            let words: Vec<String> =
                words.iter().cloned().chain([sub.get_name().to_owned()]).collect();
            each(sub, &words, check);
        }
    }

    #[test]
    fn every_option_takes_negative_numbers_with_an_exponent() {
        let all = command();
        let mut tried = 0;
        each(&all, &["jointplay".to_owned()], &mut |command, words| {
            for option in command.get_arguments().filter(|one| one.get_action().takes_values()) {
                let Some(name) = option.get_long() else { continue };
                for number in ["-1.5e-05", "-1E+3", "-.5", "-2:2:1e-1", "-1e-3,2,3", "-inf"] {
                    let mut line: Vec<OsString> = words.iter().map(OsString::from).collect();
                    line.extend([format!("--{name}").into(), number.into()]);
                    let read =
                        all.clone().try_get_matches_from(with_negative_values(line.into_iter()));
                    // The value may be refused, but never taken for an option.
                    let kind = read.err().map(|error| error.kind());
                    let allowed = [
                        None,
                        Some(ErrorKind::ValueValidation),
                        Some(ErrorKind::InvalidValue),
                        Some(ErrorKind::MissingRequiredArgument),
                    ];
                    assert!(allowed.contains(&kind), "{words:?} --{name} {number}: {kind:?}");
                    tried += 1;
                }
            }
        });
        assert!(tried > 300, "{tried}");
    }

    #[test]
    fn only_numbers_after_options_are_joined() {
        let joined = |line: &str| {
            let joined = with_negative_values(line.split(' ').map(OsString::from));
            joined
                .iter()
                .map(|one| one.to_string_lossy().into_owned())
                .collect::<Vec<_>>()
                .join(" ")
        };
        assert_eq!(joined("inverse --azimuth-deg -1.5e-05"), "inverse --azimuth-deg=-1.5e-05");
        assert_eq!(joined("draw --view=-30,20 -q"), "draw --view=-30,20 -q");
        assert_eq!(joined("draw -- --at -3"), "draw -- --at -3");
        assert_eq!(joined("study --force -v"), "study --force -v");
    }

    #[test]
    fn every_help_lists_exit_codes() {
        each(&command(), &[], &mut |command, words| {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            assert!(help.contains("Exit codes: 0 "), "{words:?}");
        });
    }
}
