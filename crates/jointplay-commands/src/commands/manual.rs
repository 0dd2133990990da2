//! `jointplay manual`: manual pages.

use std::path::PathBuf;

use clap::Args;
use clap_mangen::Man;

use crate::failure::Failure;
use crate::folder::ForceArgs;
use crate::{folder, output};

/// Print the manual page, or write the pages of all commands
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay manual | man -l -
  jointplay manual --out ~/.local/share/man/man1")]
pub(crate) struct Manual {
    /// Folder for the pages of all commands
    #[arg(short, long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgs,
}

impl Manual {
    pub(crate) fn run(&self, mut command: clap::Command) -> Result<(), Failure> {
        command.build();
        let Some(out) = &self.out else {
            return output::raw(&String::from_utf8_lossy(&page(&command)?));
        };
        let mut pages = Vec::new();
        add(&mut pages, &command, "jointplay")?;
        folder::write(out, &pages, self.force)?;
        let count = pages.len();
        output::text(&format!("{count} manual pages written into {}\n", out.display()))
    }
}

/// Adds the page of a command and the pages of its subcommands.
fn add(
    pages: &mut Vec<(String, Vec<u8>)>,
    command: &clap::Command,
    name: &str,
) -> Result<(), Failure> {
    pages.push((format!("{name}.1"), page(&command.clone().name(name.to_owned()))?));
    for sub in command.get_subcommands() {
        add(pages, sub, &format!("{name}-{}", sub.get_name()))?;
    }
    Ok(())
}

fn page(command: &clap::Command) -> Result<Vec<u8>, Failure> {
    let mut page = Vec::new();
    Man::new(command.clone()).render(&mut page)?;
    Ok(page)
}
