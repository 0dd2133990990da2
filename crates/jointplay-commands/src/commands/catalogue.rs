//! `jointplay catalogue`: the robots, mechanisms and parts of cells included with the program.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use jointplay::format::catalogue::{self, Entry};
use jointplay::format::cell::{self, Part, PartParameter};
use jointplay::format::place;
use jointplay::report::{TableColumn, TextTable};
use serde::Serialize;

use crate::failure::Failure;
use crate::folder;
use crate::folder::ForceArgs;
use crate::output::{self, FormatArgs};

/// List, print or copy the included robots, mechanisms and parts of cells
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay catalogue
  jointplay catalogue parts
  jointplay catalogue parts slit-valve
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
    /// List all robots and mechanisms with their expected mobility, and all parts of cells
    List,
    /// List parts of cells with their parameters
    Parts {
        /// Name of one part
        name: Option<String>,
    },
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
            Some(Action::Parts { name }) => {
                let parts = PartsReport { parts: parts(name.as_deref())? };
                self.format.print(&parts, parts_text)
            }
            Some(Action::Show { name }) => match (find(name)?, self.format.json()) {
                (Item::Entry(entry), true) => {
                    output::json(&Shown { entry: EntryReport::new(entry), text: entry.text })
                }
                (Item::Part(part), true) => {
                    let text = part.text;
                    output::json(&ShownPart { part: PartReport::new(part), text })
                }
                (item, false) => output::raw(item.text()),
            },
            Some(Action::Copy { name, folder, force }) => {
                let copied = copy(name, find(name)?.text(), folder, *force)?;
                self.format.print(&copied, |copied| format!("copied to {}\n", copied.file))
            }
        }
    }
}

/// All entries of the catalogue.
#[derive(Serialize)]
struct CatalogueReport {
    entries: Vec<EntryReport>,
    parts: Vec<PartReport>,
}

/// Parts of cells.
#[derive(Serialize)]
struct PartsReport {
    parts: Vec<PartReport>,
}

/// A part of cells.
#[derive(Serialize)]
struct PartReport {
    name: &'static str,
    /// `station` or `bodies`.
    kind: &'static str,
    description: String,
    parameters: Vec<PartParameterReport>,
}

#[derive(Serialize)]
struct PartParameterReport {
    name: String,
    default: String,
    meaning: String,
}

/// The contents of the file of a part.
#[derive(Serialize)]
struct ShownPart {
    #[serde(flatten)]
    part: PartReport,
    text: &'static str,
}

/// A file of the catalogue.
enum Item {
    Entry(&'static Entry),
    Part(Part),
}

impl Item {
    fn text(&self) -> &'static str {
        match self {
            Self::Entry(entry) => entry.text,
            Self::Part(part) => part.text,
        }
    }
}

impl PartReport {
    fn new(part: Part) -> Self {
        let parameter = |PartParameter { name, default, meaning }| PartParameterReport {
            name,
            default,
            meaning,
        };
        Self {
            name: part.name,
            kind: if part.is_station { "station" } else { "bodies" },
            description: part.description,
            parameters: part.parameters.into_iter().map(parameter).collect(),
        }
    }
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
        let entries = catalogue::entries().iter().map(EntryReport::new).collect();
        Self { entries, parts: cell::parts().into_iter().map(PartReport::new).collect() }
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

fn find(name: &str) -> Result<Item, Failure> {
    if let Some(entry) = catalogue::find(name) {
        return Ok(Item::Entry(entry));
    }
    let parts = cell::parts();
    let names = parts.iter().map(|part| part.name.to_owned());
    let known: Vec<String> =
        catalogue::entries().iter().map(|entry| entry.name.to_owned()).chain(names).collect();
    let found = parts.into_iter().find(|part| part.name == name).map(Item::Part);
    found.ok_or_else(|| Failure::Usage(place::not_known("name", name, &known)))
}

/// One part, or all of them.
fn parts(name: Option<&str>) -> Result<Vec<PartReport>, Failure> {
    let mut parts = cell::parts();
    if let Some(name) = name {
        let known: Vec<String> = parts.iter().map(|part| part.name.to_owned()).collect();
        parts.retain(|part| part.name == name);
        if parts.is_empty() {
            return Err(Failure::Usage(place::not_known("part", name, &known)));
        }
    }
    Ok(parts.into_iter().map(PartReport::new).collect())
}

fn copy(name: &str, text: &str, folder: &Path, force: ForceArgs) -> Result<Copied, Failure> {
    let name = format!("{name}.toml");
    let path = folder.join(&name);
    folder::write(folder, &[(name, text.as_bytes().to_vec())], force)?;
    Ok(Copied { file: path.display().to_string() })
}

/// The parts with their parameters.
fn parts_text(parts: &PartsReport) -> String {
    let table = |part: &PartReport| {
        let row = |one: &PartParameterReport| {
            vec![one.name.clone(), one.default.clone(), one.meaning.clone()]
        };
        let table = TextTable {
            title: part.name,
            columns: ["parameter", "default", "meaning"].map(TableColumn::text).into(),
            rows: part.parameters.iter().map(row).collect(),
        };
        let (heading, rows) = table.to_text().split_once('\n').map_or_else(
            || (String::new(), String::new()),
            |(heading, rows)| (heading.to_owned(), rows.to_owned()),
        );
        format!("{heading}: {} ({})\n{rows}", part.description.trim_end_matches('.'), part.kind)
    };
    parts.parts.iter().map(table).collect::<Vec<_>>().join("\n")
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
    let rows = catalogue
        .parts
        .iter()
        .map(|part| vec![part.name.to_owned(), part.kind.to_owned(), part.description.clone()]);
    let parts = TextTable {
        title: "parts of cells",
        columns: ["name", "kind", "description"].map(TableColumn::text).into(),
        rows: rows.collect(),
    };
    text + "\n" + &parts.to_text() + "  parameters: jointplay catalogue parts\n"
}
