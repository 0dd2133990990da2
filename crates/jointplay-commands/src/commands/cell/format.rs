//! `jointplay cell format`: the formatter of programs.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::format::program;
use serde::Serialize;

use super::input::{EXAMPLE, program_source};
use crate::failure::Failure;
use crate::folder::{self, ForceArgs};
use crate::output::{self, FormatArgs};
use crate::source::STANDARD;

/// Format a program: uppercase keywords, indented blocks, comments kept
///
/// A program with syntax errors is not changed; its errors are reported.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell format
  jointplay cell format one.program --write

Exit codes: 0 done, 2 bad input or usage.")]
pub(super) struct Format {
    /// Program [default: the program of the example]
    #[arg(value_name = "PROGRAM")]
    program: Option<PathBuf>,
    /// Write the result into the file instead of printing it
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
            Some(path) => {
                let source = program_source(path)?;
                (source.text, source.label)
            }
            None => (program::EXAMPLE.to_owned(), format!("{EXAMPLE}.program")),
        };
        let formatted =
            program::format(&text).map_err(|problems| Failure::invalid(&problems, &label))?;
        match &self.program {
            Some(path) if self.write && path == Path::new(STANDARD) => {
                let text = "--write needs a file, not standard input; without --write the program is printed";
                Err(Failure::Usage(text.to_owned()))
            }
            Some(path) if self.write && formatted != text => {
                folder::write_file(path, formatted.as_bytes(), ForceArgs::REPLACE)
            }
            _ => Ok(()),
        }?;
        let printed = (!self.write).then_some(formatted.as_str());
        if self.format.json() {
            output::json(&FormatReport { changed: formatted != text, text: printed })
        } else {
            printed.map_or(Ok(()), output::raw)
        }
    }
}
