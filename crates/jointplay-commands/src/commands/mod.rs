//! One file per command: its flags, its calls of the library, and its answer as text.

mod assemble;
mod catalogue;
mod cell;
mod compare;
mod completions;
mod draw;
mod export;
mod forward;
mod import;
mod inverse;
mod jacobian;
mod manual;
mod mobility;
mod motion;
mod motion_course;
mod motion_drives;
mod motion_pose;
mod motion_run;
mod motion_scene;
mod motion_table;
mod pose_text;
mod relief;
mod sensitivity;
mod simulate;
mod simulate_text;
#[cfg(feature = "studio")]
mod studio;
mod study;
mod suggest;

use clap::Subcommand;
pub(crate) use completions::answer_shell;

use crate::failure::Failure;

#[derive(Subcommand)]
pub(crate) enum Command {
    Simulate(simulate::Simulate),
    Study(study::StudyCommand),
    Forward(forward::ForwardCommand),
    Inverse(inverse::Inverse),
    Mobility(mobility::Mobility),
    Sensitivity(sensitivity::SensitivityCommand),
    Compare(compare::Compare),
    Assemble(assemble::Assemble),
    Jacobian(jacobian::Jacobian),
    Move(motion::Move),
    Draw(draw::Draw),
    Cell(cell::CellCommand),
    Suggest(suggest::Suggest),
    #[cfg(feature = "studio")]
    Studio(studio::Studio),
    Import(import::Import),
    Export(export::Export),
    #[command(alias = "catalog")]
    Catalogue(catalogue::Catalogue),
    Completions(completions::Completions),
    Manual(manual::Manual),
}

impl Command {
    /// Runs the command.
    ///
    /// # Arguments
    /// * `definition` – the whole command line, for the manual
    pub(crate) fn run(&self, definition: fn() -> clap::Command) -> Result<(), Failure> {
        match self {
            Self::Simulate(command) => command.run(),
            Self::Study(command) => command.run(),
            Self::Forward(command) => command.run(),
            Self::Inverse(command) => command.run(),
            Self::Mobility(command) => command.run(),
            Self::Sensitivity(command) => command.run(),
            Self::Compare(command) => command.run(),
            Self::Assemble(command) => command.run(),
            Self::Jacobian(command) => command.run(),
            Self::Move(command) => command.run(),
            Self::Draw(command) => command.run(),
            Self::Cell(command) => command.run(),
            Self::Suggest(command) => command.run(),
            #[cfg(feature = "studio")]
            Self::Studio(command) => command.run(),
            Self::Import(command) => command.run(),
            Self::Export(command) => command.run(),
            Self::Catalogue(command) => command.run(),
            Self::Completions(command) => command.run(),
            Self::Manual(command) => command.run(definition()),
        }
    }

    /// Whether errors are reported as JSON.
    pub(crate) fn wants_json(&self) -> bool {
        let format = match self {
            Self::Simulate(command) => command.format,
            Self::Study(command) => command.format,
            Self::Forward(command) => command.answer.format,
            Self::Inverse(command) => command.answer.format,
            Self::Mobility(command) => command.answer.format,
            Self::Sensitivity(command) => command.answer.format,
            Self::Compare(command) => command.answer.format,
            Self::Assemble(command) => command.mechanism.format,
            Self::Jacobian(command) => command.mechanism.format,
            Self::Move(command) => command.mechanism.format,
            Self::Draw(command) => command.format,
            Self::Cell(command) => command.format(),
            Self::Suggest(command) => command.mechanism.format,
            #[cfg(feature = "studio")]
            Self::Studio(command) => command.format,
            Self::Import(command) => command.format,
            Self::Export(command) => command.mechanism.format,
            Self::Catalogue(command) => command.format,
            // A script for a shell and pages for man have one format only.
            Self::Completions(_) | Self::Manual(_) => return false,
        };
        format.json()
    }
}
