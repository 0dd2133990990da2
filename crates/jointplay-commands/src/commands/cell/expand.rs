//! `jointplay cell expand`: a cell file without parameters, templates, patterns and parts.

use clap::Args;
use jointplay::format::cell;
use serde::Serialize;

use super::input::{CellArgs, read_relative};
use crate::failure::Failure;
use crate::output;

/// Print a cell file with its parameters, templates, patterns and parts replaced by their values and tables
///
/// The printed cell is the same as that of the file. Comments are not included.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell expand
  jointplay cell expand example > expanded.toml

Exit codes: 0 done, 2 bad input or usage.")]
pub(super) struct Expand {
    #[command(flatten)]
    pub(super) cell: CellArgs,
}

/// The expanded cell.
#[derive(Serialize)]
struct ExpandReport {
    /// Number of stations.
    stations: usize,
    /// Number of bodies.
    bodies: usize,
    /// Number of zones.
    zones: usize,
    /// The expanded cell file.
    text: String,
}

impl Expand {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let source = self.cell.load()?;
        let folder = source.folder.as_deref();
        let text = cell::expand(&source.text, &[], &mut |name| read_relative(folder, name));
        let text = text.map_err(|problems| Failure::invalid_cell(&problems, &source.label))?;
        if !self.cell.format.json() {
            return output::raw(&text);
        }
        let (stations, bodies) = (source.cell.stations.len(), source.cell.bodies.len());
        let zones = source.cell.zones.len();
        output::json(&ExpandReport { stations, bodies, zones, text })
    }
}
