//! `jointplay catalogue`: the files that come with the program.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use jointplay::format::catalogue::{self, Entry};
use jointplay::format::place;

use crate::failure::Failure;
use crate::folder::ForceArgs;
use crate::{folder, output};

/// List, show or copy the robots and mechanisms that come with the program
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay catalogue
  jointplay catalogue show bennett
  jointplay catalogue copy bennett my-mechanisms")]
pub(crate) struct Catalogue {
    #[command(subcommand)]
    action: Option<Action>,
}

#[derive(Subcommand)]
enum Action {
    /// All of them, with what is known of their mobility
    List,
    /// Print a file
    Show {
        /// Its name in the list
        name: String,
    },
    /// Copy a file, to change it
    Copy {
        /// Its name in the list
        name: String,
        /// Where to
        #[arg(value_name = "FOLDER", default_value = ".")]
        folder: PathBuf,
        #[command(flatten)]
        force: ForceArgs,
    },
}

impl Catalogue {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.action {
            None | Some(Action::List) => output::text(&list()),
            Some(Action::Show { name }) => output::raw(find(name)?.text),
            Some(Action::Copy { name, folder, force }) => copy(find(name)?, folder, *force),
        }
    }
}

fn find(name: &str) -> Result<&'static Entry, Failure> {
    catalogue::find(name).ok_or_else(|| {
        let known: Vec<String> =
            catalogue::entries().iter().map(|entry| entry.name.to_owned()).collect();
        Failure::Misused(place::not_known("name", name, &known))
    })
}

fn copy(entry: &Entry, folder: &Path, force: ForceArgs) -> Result<(), Failure> {
    let name = format!("{}.toml", entry.name);
    let path = folder.join(&name);
    folder::write(folder, &[(name, entry.text.as_bytes().to_vec())], force)?;
    output::text(&format!("copied to {}\n", path.display()))
}

fn list() -> String {
    let title = "what";
    let mut text = format!(
        "{:<26}{title:<40}{:>8}{:>6}{:>13}{:>6}{:>11}\n",
        "name", "freedoms", "rank", "first order", "real", "redundant"
    );
    for entry in catalogue::entries() {
        let expected = entry.expected();
        let cell = |value: Option<usize>| value.map_or("-".to_owned(), |value| value.to_string());
        let title = entry.title();
        let pad = " ".repeat(40_usize.saturating_sub(title.chars().count()).max(1));
        let _ = writeln!(
            text,
            "  {:<24}{title}{pad}{:>8}{:>6}{:>13}{:>6}{:>11}",
            entry.name,
            cell(expected.freedoms),
            cell(expected.rank),
            cell(expected.instantaneous),
            cell(expected.finite),
            cell(expected.redundancy),
        );
    }
    text
}
