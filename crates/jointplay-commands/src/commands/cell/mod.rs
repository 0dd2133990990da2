//! `jointplay cell`: work cells and their programs.

mod check;
mod connection;
mod displacement;
mod example;
mod expand;
mod export;
mod format;
mod input;
mod monitor;
mod optimise;
mod optimise_log;
mod pictures;
mod report;
mod run;
mod serve;
mod teach;
mod text;

use clap::{Args, Subcommand};

use crate::failure::Failure;
use crate::output::FormatArgs;

/// Check, run, export and optimise programs of work cells; teach stations
///
/// Without files, the commands use the included example: a dual-arm robot with two load ports, an aligner and a process station.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell check
  jointplay cell run --out example-run
  jointplay cell report --out report.html
  jointplay cell export --to gltf,csv
  jointplay cell serve
  jointplay cell optimise --out faster
  jointplay cell teach
  jointplay cell displacement
  jointplay cell format
  jointplay cell expand
  jointplay cell example --out my-cell")]
pub(crate) struct CellCommand {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    Check(check::Check),
    Run(run::Run),
    Report(report::ReportCommand),
    Export(export::Export),
    Serve(serve::Serve),
    Optimise(optimise::Optimise),
    Teach(teach::Teach),
    Displacement(displacement::Displacement),
    Format(format::Format),
    Expand(expand::Expand),
    Example(example::ExampleCommand),
}

impl CellCommand {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.action {
            Action::Check(command) => command.run(),
            Action::Run(command) => command.run(),
            Action::Report(command) => command.run(),
            Action::Export(command) => command.run(),
            Action::Serve(command) => command.run(),
            Action::Optimise(command) => command.run(),
            Action::Teach(command) => command.run(),
            Action::Displacement(command) => command.run(),
            Action::Format(command) => command.run(),
            Action::Expand(command) => command.run(),
            Action::Example(command) => command.run(),
        }
    }

    pub(crate) fn format(&self) -> FormatArgs {
        match &self.action {
            Action::Check(command) => command.input.format(),
            Action::Run(command) => command.input.format(),
            Action::Report(command) => command.input.format(),
            Action::Export(command) => command.input.format(),
            Action::Serve(command) => command.cell.format,
            Action::Optimise(command) => command.input.format(),
            Action::Teach(command) => command.cell.format,
            Action::Displacement(command) => command.input.format(),
            Action::Format(command) => command.format,
            Action::Expand(command) => command.cell.format,
            Action::Example(command) => command.format,
        }
    }
}
