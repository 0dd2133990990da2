//! `jointplay cell run`: a program as it runs, as data and pictures.

use std::collections::BTreeSet;
use std::path::PathBuf;

use clap::Args;

use super::export::{Rate, csv, rate};
use super::input::InputArgs;
use super::pictures::{PICTURES, pictures};
use super::text;
use crate::failure::Failure;
use crate::folder::{self, ForceArgs, Staged};
use crate::output;

const REPORT: &str = "report.json";
const SAMPLES: &str = "samples.csv";

/// Run a program: its report, its samples, the cell from above and the axes over time
///
/// Samples of a program with violations are written only where --despite-errors asks for them; report and pictures always are, and show what is wrong.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell run
  jointplay cell run --rate 1000 --out fine-run --format json

Exit codes: 0 sound, 1 not safe to run or not reachable, 2 bad input or usage, 130 interrupted.")]
pub(super) struct Run {
    #[command(flatten)]
    pub(super) input: InputArgs,
    /// Samples a second
    #[arg(long, value_name = "HZ", default_value = "100", value_parser = rate)]
    rate: Rate,
    /// Folder for the results
    #[arg(short, long, value_name = "FOLDER", default_value = "cell-run")]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArgs,
    /// Write the samples of a program with violations too, which are counted in a column of their own
    #[arg(long)]
    despite_errors: bool,
}

impl Run {
    pub(super) fn run(&self) -> Result<(), Failure> {
        folder::check_folder(&self.out, self.force)?;
        let own: BTreeSet<String> =
            PICTURES.into_iter().chain([REPORT, SAMPLES]).map(str::to_owned).collect();
        let planned = self.input.plan()?;
        let document = planned.document();
        let mut files = vec![(REPORT.to_owned(), (output::to_json(&document) + "\n").into_bytes())];
        files.extend(pictures(&planned)?);
        let mut staged = Staged::into(&self.out, self.force)?;
        for (name, bytes) in &files {
            staged.add(name, |writer| Ok(writer.write_all(bytes)?))?;
        }
        if planned.is_sound() || self.despite_errors {
            csv(&mut staged, SAMPLES, &planned.motion_export(), self.rate.0)?;
            files.push((SAMPLES.to_owned(), Vec::new()));
        }
        staged.publish()?;
        folder::remove_stale(&self.out, &own, &files)?;
        if self.input.json() {
            output::json(&document)?;
        } else {
            let mut told = text::report(&document, &planned);
            let written = text::counted(files.len(), "file");
            told.push_str(&format!("{written} written into {}\n", self.out.display()));
            output::text(&told)?;
        }
        planned.verdict()
    }
}
