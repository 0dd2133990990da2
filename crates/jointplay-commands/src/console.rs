//! Notes on standard error, verbosity and colours.

use std::io::Write as _;
use std::sync::atomic::{AtomicU8, Ordering};

use clap::{Args, ColorChoice};

/// Heading of these flags in the help, after those of the command itself.
const HEADING: &str = "Options of every command";

/// Flags of every command that control notes and colours.
#[derive(Args)]
pub(crate) struct ConsoleArgs {
    /// Print only the answer and errors, without progress and notes
    #[arg(short, long, global = true, help_heading = HEADING, conflicts_with = "verbose")]
    quiet: bool,
    /// Report files read and written, and the elapsed time, on standard error
    #[arg(short, long, global = true, help_heading = HEADING)]
    verbose: bool,
    /// Use colours in the output
    #[arg(long, global = true, help_heading = HEADING, value_enum, value_name = "WHEN", default_value = "auto")]
    color: ColorChoice,
}

const QUIET: u8 = 0;
const NORMAL: u8 = 1;
const VERBOSE: u8 = 2;

/// Verbosity; set once, before the command runs.
static LEVEL: AtomicU8 = AtomicU8::new(NORMAL);

impl ConsoleArgs {
    /// Applies the flags to all further output.
    pub(crate) fn apply(&self) {
        let level = match (self.quiet, self.verbose) {
            (true, _) => QUIET,
            (_, true) => VERBOSE,
            _ => NORMAL,
        };
        LEVEL.store(level, Ordering::Relaxed);
        match self.color {
            ColorChoice::Auto => anstream::ColorChoice::Auto,
            ColorChoice::Always => anstream::ColorChoice::Always,
            ColorChoice::Never => anstream::ColorChoice::Never,
        }
        .write_global();
    }
}

/// Whether neither notes nor progress are printed.
pub(crate) fn is_quiet() -> bool {
    LEVEL.load(Ordering::Relaxed) == QUIET
}

/// A note on standard error, unless `--quiet` is given.
pub(crate) fn note(line: &str) {
    if !is_quiet() {
        print(line);
    }
}

/// A detail on standard error, where `--verbose` is given.
pub(crate) fn detail(line: &str) {
    if LEVEL.load(Ordering::Relaxed) == VERBOSE {
        print(line);
    }
}

/// A line on standard error.
pub(crate) fn print(line: &str) {
    // If standard error is closed, there is no reader.
    drop(writeln!(anstream::stderr(), "{line}"));
}
