//! `jointplay manual`: the manual pages.

use std::path::PathBuf;

use clap::{Args, CommandFactory};
use clap_mangen::Man;

use crate::failure::Failure;
use crate::{folder, output};

/// Print the manual page, or write one for every command
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay manual | man -l -
  jointplay manual --out ~/.local/share/man/man1")]
pub(crate) struct Manual {
    /// Folder to write all pages into
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
}

impl Manual {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let mut command = crate::Cli::command();
        command.build();
        let Some(out) = &self.out else {
            return output::raw(&String::from_utf8_lossy(&page(&command)?));
        };
        let mut pages = vec![("jointplay.1".to_owned(), page(&command)?)];
        for sub in command.get_subcommands() {
            let name = format!("jointplay-{}", sub.get_name());
            pages.push((format!("{name}.1"), page(&sub.clone().name(name))?));
        }
        folder::write(out, &pages)?;
        let count = pages.len();
        output::text(&format!("{count} manual pages written into {}\n", out.display()))
    }
}

fn page(command: &clap::Command) -> Result<Vec<u8>, Failure> {
    let mut page = Vec::new();
    Man::new(command.clone()).render(&mut page)?;
    Ok(page)
}
