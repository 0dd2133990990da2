//! One file a command: what its flags are, what it asks the library, how it tells the answer.

mod assemble;
mod catalogue;
mod cell;
mod compare;
mod completions;
mod draw;
mod forward;
mod import;
mod inverse;
mod manual;
mod mobility;
mod motion;
mod pose_text;
mod relief;
mod sensitivity;
mod simulate;
mod simulate_text;
#[cfg(feature = "studio")]
mod studio;
mod study;
mod study_file;
mod study_text;
mod suggest;

use clap::Subcommand;

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
    Move(motion::Move),
    Draw(draw::Draw),
    Cell(cell::CellCommand),
    Suggest(suggest::Suggest),
    #[cfg(feature = "studio")]
    Studio(studio::Studio),
    Import(import::Import),
    #[command(alias = "catalog")]
    Catalogue(catalogue::Catalogue),
    Completions(completions::Completions),
    Manual(manual::Manual),
}

impl Command {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match self {
            Self::Simulate(command) => command.run(),
            Self::Study(command) => command.run(),
            Self::Forward(command) => command.run(),
            Self::Inverse(command) => command.run(),
            Self::Mobility(command) => command.run(),
            Self::Sensitivity(command) => command.run(),
            Self::Compare(command) => command.run(),
            Self::Assemble(command) => command.run(),
            Self::Move(command) => command.run(),
            Self::Draw(command) => command.run(),
            Self::Cell(command) => command.run(),
            Self::Suggest(command) => command.run(),
            #[cfg(feature = "studio")]
            Self::Studio(command) => command.run(),
            Self::Import(command) => command.run(),
            Self::Catalogue(command) => command.run(),
            Self::Completions(command) => command.run(),
            Self::Manual(command) => command.run(),
        }
    }

    /// Whether errors are to be told as JSON too.
    pub(crate) fn wants_json(&self) -> bool {
        match self {
            Self::Study(command) => command.json(),
            Self::Forward(command) => command.answer.json(),
            Self::Inverse(command) => command.answer.json(),
            Self::Mobility(command) => command.answer.json(),
            Self::Sensitivity(command) => command.answer.json(),
            Self::Compare(command) => command.answer.json(),
            Self::Assemble(command) => command.mechanism.json(),
            Self::Move(command) => command.mechanism.json(),
            Self::Cell(command) => command.json(),
            Self::Suggest(command) => command.mechanism.json(),
            Self::Simulate(_)
            | Self::Draw(_)
            | Self::Import(_)
            | Self::Catalogue(_)
            | Self::Completions(_)
            | Self::Manual(_) => false,
            #[cfg(feature = "studio")]
            Self::Studio(_) => false,
        }
    }
}
