//! `jointplay cell example`: the example's files, to start from.

use std::path::PathBuf;

use clap::Args;
use jointplay::format::{cell, program};

use super::input::EXAMPLE;
use crate::failure::Failure;
use crate::{folder, output};

/// Write the example cell and its program, to start from
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell example
  jointplay cell example --out other-cell")]
pub(super) struct ExampleCommand {
    /// Folder for the two files, made if missing; files of their names are not replaced
    #[arg(long, value_name = "FOLDER", default_value = "example-cell")]
    out: PathBuf,
}

impl ExampleCommand {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let files = [("toml", cell::EXAMPLE), ("program", program::EXAMPLE)];
        let paths = files.map(|(end, _)| self.out.join(format!("{EXAMPLE}.{end}")));
        for ((_, text), path) in files.iter().zip(&paths) {
            folder::write_new(&self.out, path, text.as_bytes())?;
        }
        let [cell, program] = paths.map(|path| path.display().to_string());
        output::text(&format!("{cell}\n{program}\ncheck it: jointplay cell check {cell}\n"))
    }
}
