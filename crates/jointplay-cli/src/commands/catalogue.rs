//! `jointplay catalogue`: the robots and mechanisms included with the program.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use jointplay::format::catalogue::{self, Entry};
use jointplay::format::place;
use serde::Serialize;

use crate::failure::Failure;
use crate::folder;
use crate::folder::ForceArgs;
use crate::output::{self, FormatArgs};

/// List, print or copy the included robots and mechanisms
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay catalogue
  jointplay catalogue show bennett
  jointplay catalogue copy bennett my-mechanisms")]
pub(crate) struct Catalogue {
    #[command(flatten)]
    pub(crate) format: FormatArgs,
    #[command(subcommand)]
    action: Option<Action>,
}

#[derive(Subcommand)]
enum Action {
    /// List all files with their expected mobility
    List,
    /// Print a file
    Show {
        /// Name in the list
        name: String,
    },
    /// Copy a file into a folder for editing
    Copy {
        /// Name in the list
        name: String,
        /// Destination folder; created if missing
        #[arg(value_name = "FOLDER", default_value = ".")]
        folder: PathBuf,
        #[command(flatten)]
        force: ForceArgs,
    },
}

impl Catalogue {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.action {
            None | Some(Action::List) => self.format.print(&CatalogueReport::new(), list),
            Some(Action::Show { name }) => {
                let entry = find(name)?;
                if self.format.json() {
                    output::json(&Shown { entry: EntryReport::new(entry), text: entry.text })
                } else {
                    output::raw(entry.text)
                }
            }
            Some(Action::Copy { name, folder, force }) => {
                let copied = copy(find(name)?, folder, *force)?;
                self.format.print(&copied, |copied| format!("copied to {}\n", copied.file))
            }
        }
    }
}

/// All entries of the catalogue.
#[derive(Serialize)]
struct CatalogueReport {
    entries: Vec<EntryReport>,
}

/// One entry of the catalogue, with the mobility that its file expects.
#[derive(Serialize)]
struct EntryReport {
    name: &'static str,
    title: String,
    kind: Option<String>,
    joint_freedoms: Option<usize>,
    rank: Option<usize>,
    instantaneous_mobility: Option<usize>,
    finite_mobility: Option<usize>,
    redundancy: Option<usize>,
}

/// The contents of one file of the catalogue.
#[derive(Serialize)]
struct Shown {
    #[serde(flatten)]
    entry: EntryReport,
    text: &'static str,
}

/// A copied file.
#[derive(Serialize)]
struct Copied {
    file: String,
}

impl CatalogueReport {
    fn new() -> Self {
        Self { entries: catalogue::entries().iter().map(EntryReport::new).collect() }
    }
}

impl EntryReport {
    fn new(entry: &Entry) -> Self {
        let expected = entry.expected();
        Self {
            name: entry.name,
            title: entry.title(),
            kind: entry.kind(),
            joint_freedoms: expected.freedoms,
            rank: expected.rank,
            instantaneous_mobility: expected.instantaneous,
            finite_mobility: expected.finite,
            redundancy: expected.redundancy,
        }
    }
}

fn find(name: &str) -> Result<&'static Entry, Failure> {
    catalogue::find(name).ok_or_else(|| {
        let known: Vec<String> =
            catalogue::entries().iter().map(|entry| entry.name.to_owned()).collect();
        Failure::Usage(place::not_known("name", name, &known))
    })
}

fn copy(entry: &Entry, folder: &Path, force: ForceArgs) -> Result<Copied, Failure> {
    let name = format!("{}.toml", entry.name);
    let path = folder.join(&name);
    folder::write(folder, &[(name, entry.text.as_bytes().to_vec())], force)?;
    Ok(Copied { file: path.display().to_string() })
}

fn list(catalogue: &CatalogueReport) -> String {
    let mut text = format!(
        "{:<26}{:<40}{:>8}{:>6}{:>15}{:>8}{:>11}\n",
        "name", "title", "freedoms", "rank", "instantaneous", "finite", "redundant"
    );
    for entry in &catalogue.entries {
        let cell = |value: Option<usize>| value.map_or("-".to_owned(), |value| value.to_string());
        let title = &entry.title;
        let pad = " ".repeat(40_usize.saturating_sub(title.chars().count()).max(1));
        let _ = writeln!(
            text,
            "  {:<24}{title}{pad}{:>8}{:>6}{:>15}{:>8}{:>11}",
            entry.name,
            cell(entry.joint_freedoms),
            cell(entry.rank),
            cell(entry.instantaneous_mobility),
            cell(entry.finite_mobility),
            cell(entry.redundancy),
        );
    }
    text
}
