//! `jointplay cell example`: the files of the example.

use std::path::PathBuf;

use clap::Args;
use jointplay::format::{cell, program};
use serde::Serialize;

use super::input::EXAMPLE;
use crate::failure::Failure;
use crate::folder::{self, ForceArgs};
use crate::output::FormatArgs;

/// Write the example cell and its program as templates
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell example
  jointplay cell example --out other-cell")]
pub(super) struct ExampleCommand {
    /// Folder for the two files; created if missing
    #[arg(short, long, value_name = "FOLDER", default_value = "example-cell")]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArgs,
    #[command(flatten)]
    pub(super) format: FormatArgs,
}

/// The two files written.
#[derive(Serialize)]
struct ExampleReport {
    cell: String,
    program: String,
}

impl ExampleCommand {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let files = [("toml", cell::EXAMPLE), ("program", program::EXAMPLE)];
        let paths = files.map(|(end, _)| self.out.join(format!("{EXAMPLE}.{end}")));
        let named = files.map(|(end, text)| (format!("{EXAMPLE}.{end}"), text.as_bytes().to_vec()));
        folder::write(&self.out, &named, self.force)?;
        let [cell, program] = paths.map(|path| path.display().to_string());
        self.format.print(&ExampleReport { cell, program }, |ExampleReport { cell, program }| {
            format!("{cell}\n{program}\ncheck it: jointplay cell check {cell}\n")
        })
    }
}
