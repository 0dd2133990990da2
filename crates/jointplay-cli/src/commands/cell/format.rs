//! `jointplay cell format`: a program laid out evenly.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::format::program;
use serde::Serialize;

use super::input::{EXAMPLE, wrong};
use crate::failure::Failure;
use crate::folder::{self, ForceArgs};
use crate::output::{self, FormatArgs};
use crate::source::{STANDARD, label, read_text};

/// Lay a program out evenly: words in capitals, blocks set in, comments kept
///
/// A program that cannot be read stays as it is, and what is wrong with it is told.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell format
  jointplay cell format one.program --write

Exit codes: 0 done, 2 bad input or usage.")]
pub(super) struct Format {
    /// Program; without it, that of the example
    #[arg(value_name = "PROGRAM")]
    program: Option<PathBuf>,
    /// Write it into the file instead of printing it
    #[arg(long, requires = "program")]
    write: bool,
    #[command(flatten)]
    pub(super) format: FormatArgs,
}

/// The formatted program.
#[derive(Serialize)]
struct FormatReport<'a> {
    /// Whether formatting changes the program.
    changed: bool,
    /// The formatted text, where it is not written into the file.
    text: Option<&'a str>,
}

impl Format {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let (text, label) = match &self.program {
            Some(path) => (read_text(path, program::MAX_BYTES as u64)?, label(path)),
            None => (program::EXAMPLE.to_owned(), format!("{EXAMPLE}.program")),
        };
        let even = program::format(&text)
            .map_err(|problems| Failure::Invalid(wrong(&problems, &label)))?;
        match &self.program {
            Some(path) if self.write && path == Path::new(STANDARD) => {
                let text =
                    "--write: standard input is no file; without --write the program is printed";
                Err(Failure::Usage(text.to_owned()))
            }
            Some(path) if self.write && even != text => {
                folder::write_file(path, even.as_bytes(), ForceArgs::REPLACE)
            }
            _ => Ok(()),
        }?;
        let printed = (!self.write).then_some(even.as_str());
        if self.format.json() {
            output::json(&FormatReport { changed: even != text, text: printed })
        } else {
            printed.map_or(Ok(()), output::raw)
        }
    }
}
