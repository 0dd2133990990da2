//! Stations and bodies of a cell file: added, duplicated and removed, with the comments of all others.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, TableLike, Value};

use super::described::{self, TABLES, is_called};
use super::edit::{document, inline, number, point, replace};
use super::problem::{Fault, Problem};
use crate::file_problem::FileProblem;
use crate::place::{Error, nearest};
use crate::units::deg;

/// List of a cell file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EntryList {
    /// Stations, including those that parts describe.
    Station,
    /// Bodies.
    Body,
}

/// A new entry of a cell file, with assumed dimensions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NewEntry {
    /// A station with one slot.
    Station {
        /// Centre of the wafer at rest in the base frame; at least 0.3 m from the robot's axis (m).
        position: Vector3<f64>,
        /// Rotation about the vertical (rad).
        heading: f64,
    },
    /// A box of 100 mm that does not move.
    Body {
        /// Its centre in the base frame (m).
        position: Vector3<f64>,
    },
}

/// A changed text, and the name of the new entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EntryAdded {
    /// The text.
    pub text: String,
    /// The name.
    pub name: String,
}

/// Least distance of a new station from the robot's axis, on which it would have no direction of approach (m).
const MIN_DISTANCE: f64 = 0.3;

/// Position of a new station: nearer to the robot's axis, it is moved out along its y axis.
fn off_the_axis(position: &Vector3<f64>, heading: f64) -> Vector3<f64> {
    if position.xy().norm() >= MIN_DISTANCE {
        return *position;
    }
    let (sin, cos) = heading.sin_cos();
    Vector3::new(-sin * MIN_DISTANCE, cos * MIN_DISTANCE, position.z)
}

/// Lists whose names are distinct, or that `like` refers to.
const NAMED: [&str; 6] = ["station", "part", "body", "zone", "frame", "template"];

/// Adds an entry after the last one of its list.
///
/// # Errors
/// The text is not TOML, or the list is a value of another type.
pub fn add_entry(text: &str, entry: &NewEntry) -> Result<EntryAdded, Problem> {
    let mut document = document(text)?;
    let (key, base, values) = match entry {
        NewEntry::Station { position, heading } => {
            let stroke = [("below_mm", 4.0), ("above_mm", 3.0), ("speed_mm_s", 20.0)];
            let values = vec![
                ("position_mm", point(&off_the_axis(position, *heading))),
                ("heading_deg", number(deg(*heading))),
                ("stroke", inline(stroke.map(|(key, value)| (key, number(value))))),
                ("retract_mm", number(10.0)),
            ];
            ("station", "S1", values)
        }
        NewEntry::Body { position } => {
            let size: Array = [100.0, 100.0, 100.0].into_iter().collect();
            let values = vec![
                ("position_mm", point(position)),
                ("box", inline([("size_mm", Value::Array(size))])),
            ];
            ("body", "body-1", values)
        }
    };
    let name = unused(&names(&document), base);
    let at_start = |fault| Error::at(text, 0..0, fault);
    match document.entry(key).or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new())) {
        Item::ArrayOfTables(list) => {
            let mut table = Table::new();
            table.decor_mut().set_prefix("\n");
            table.insert("name", Item::Value(Value::from(&name)));
            for (key, value) in values {
                table.insert(key, Item::Value(value));
            }
            list.push(table);
        }
        Item::Value(Value::Array(list)) => {
            let mut table = InlineTable::new();
            table.insert("name", Value::from(&name));
            table.extend(values);
            list.push(table);
        }
        _ => {
            let why = format!("`{key}` is not a list of tables: add the entry in the text");
            return Err(at_start(Fault::Unfit(why)));
        }
    }
    Ok(EntryAdded { text: document.to_string(), name })
}

/// Duplicates an entry after itself under another name; with a station, the bodies attached to it.
///
/// # Errors
/// The text is not TOML, or has no table of this name.
pub fn duplicate_entry(text: &str, list: EntryList, name: &str) -> Result<EntryAdded, Problem> {
    let mut document = document(text)?;
    let at_start = |fault| Error::at(text, 0..0, fault);
    let (key, index) = find(&mut document, list, name).map_err(at_start)?;
    let mut used = names(&document);
    let new = unused(&used, name);
    used.insert(new.clone());
    duplicate(&mut document, key, index, &new, None);
    if list == EntryList::Station {
        for (index, body) in attached(&document, name).into_iter().enumerate() {
            let own = match body.name.strip_prefix(name) {
                Some(rest) if !used.contains(&format!("{new}{rest}")) => format!("{new}{rest}"),
                _ => unused(&used, &body.name),
            };
            used.insert(own.clone());
            // Each duplicate in an inline list is directly after its original.
            let shift = if body.is_inline { index } else { 0 };
            duplicate(&mut document, "body", body.index + shift, &own, Some(&new));
        }
    }
    Ok(EntryAdded { text: document.to_string(), name: new })
}

/// Removes an entry, with the comment directly above it, and its allowed contacts; with a station, the bodies attached to it.
///
/// # Errors
/// The text is not TOML, has no table of this name, or another table takes values from it.
pub fn remove_entry(text: &str, list: EntryList, name: &str) -> Result<String, Problem> {
    let mut document = document(text)?;
    let at_start = |fault| Error::at(text, 0..0, fault);
    let (key, index) = find(&mut document, list, name).map_err(at_start)?;
    let bodies = if list == EntryList::Station { attached(&document, name) } else { Vec::new() };
    let mut removed: Vec<&str> = bodies.iter().map(|body| body.name.as_str()).collect();
    removed.push(name);
    let borrower = NAMED.iter().flat_map(|key| described::all(&document, key)).find(|table| {
        let text = |key| table.get(key).and_then(Item::as_str);
        text("like").is_some_and(|like| removed.contains(&like))
            && text("name").is_none_or(|own| !removed.contains(&own))
    });
    if let Some(borrower) = borrower {
        let own = borrower.get("name").and_then(Item::as_str).unwrap_or("another table");
        let why = format!("{own:?} takes values from {name:?} by `like`: change it first");
        return Err(at_start(Fault::Unfit(why)));
    }
    for body in bodies.iter().rev() {
        remove(&mut document, "body", body.index);
    }
    remove(&mut document, key, index);
    if let Some(pairs) = document.get_mut("may_touch").and_then(Item::as_array_mut) {
        pairs.retain(|pair| {
            let named = |one: &Value| one.as_str().is_some_and(|one| removed.contains(&one));
            !pair.as_array().is_some_and(|pair| pair.iter().any(named))
        });
    }
    Ok(document.to_string())
}

/// List and index of the table of an entry.
fn find(
    document: &mut DocumentMut,
    list: EntryList,
    name: &str,
) -> Result<(&'static str, usize), Fault> {
    let keys: &[&'static str] = match list {
        EntryList::Station => &TABLES,
        EntryList::Body => &["body"],
    };
    let is_meant = |table: &dyn TableLike| match list {
        EntryList::Station => is_called(table, name),
        EntryList::Body => is_body(table, name),
    };
    for key in keys {
        let position = described::all(document, key).iter().position(|table| is_meant(*table));
        if let Some(index) = position {
            return Ok((key, index));
        }
    }
    if list == EntryList::Station {
        described::table(document, name)?;
    }
    let bodies = described::all(document, "body");
    let named = bodies.iter().filter_map(|table| table.get("name").and_then(Item::as_str));
    let known: Vec<String> = named.map(str::to_owned).collect();
    let problem = FileProblem::Unknown {
        what: "body with a table of its own".to_owned(),
        found: name.to_owned(),
        nearest: nearest(name, known.iter().map(String::as_str)),
        known,
    };
    Err(problem.into())
}

fn is_body(table: &dyn TableLike, name: &str) -> bool {
    table.get("name").and_then(Item::as_str) == Some(name) && !table.contains_key("repeat")
}

/// Body that is attached to a station.
struct Attached {
    index: usize,
    name: String,
    is_inline: bool,
}

fn attached(document: &DocumentMut, station: &str) -> Vec<Attached> {
    let is_inline = document.get("body").is_some_and(Item::is_value);
    let bodies = described::all(document, "body").into_iter().enumerate();
    let of_station = bodies.filter_map(|(index, table)| {
        let on = table.get("on")?.as_table_like()?.get("station")?.as_str()?;
        let name = table.get("name")?.as_str()?.to_owned();
        (on == station).then_some(Attached { index, name, is_inline })
    });
    of_station.collect()
}

fn names(document: &DocumentMut) -> BTreeSet<String> {
    let tables = NAMED.iter().flat_map(|key| described::all(document, key));
    let named = tables.filter_map(|table| Some(table.get("name")?.as_str()?.to_owned()));
    named.collect()
}

/// The name with the next number that is not in use.
fn unused(used: &BTreeSet<String>, name: &str) -> String {
    if !used.contains(name) {
        return name.to_owned();
    }
    let base = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let first = name[base.len()..].parse().unwrap_or(1_usize);
    let numbered = (first.saturating_add(1)..).map(|number| format!("{base}{number}"));
    numbered.into_iter().find(|name| !used.contains(name)).unwrap_or_default()
}

/// Sets name and station of a duplicate.
fn rename(table: &mut dyn TableLike, name: &str, station: Option<&str>) {
    if let Some(old) = table.get_mut("name").and_then(Item::as_value_mut) {
        replace(old, Value::from(name));
    }
    let on = table.get_mut("on").and_then(Item::as_table_like_mut);
    let of = on.and_then(|on| on.get_mut("station")).and_then(Item::as_value_mut);
    if let (Some(of), Some(station)) = (of, station) {
        replace(of, Value::from(station));
    }
}

fn duplicate(
    document: &mut DocumentMut,
    key: &str,
    index: usize,
    name: &str,
    station: Option<&str>,
) {
    match document.get_mut(key) {
        Some(Item::ArrayOfTables(list)) => {
            let Some(mut copy) = list.get(index).cloned() else { return };
            rename(&mut copy, name, station);
            copy.decor_mut().set_prefix("\n");
            // Tables are written in the order of their positions: after the original and all tables in it.
            let last = last_position(&copy);
            set_positions(&mut copy, last);
            list.push(copy);
        }
        Some(Item::Value(Value::Array(list))) => {
            let Some(mut copy) = list.get(index).cloned() else { return };
            if let Some(table) = copy.as_inline_table_mut() {
                rename(table, name, station);
            }
            list.insert_formatted(index + 1, copy);
        }
        _ => {}
    }
}

/// Position of the last table within a table.
fn last_position(table: &Table) -> Option<isize> {
    let within = table.iter().filter_map(|(_, item)| match item {
        Item::Table(inner) => last_position(inner),
        Item::ArrayOfTables(list) => list.iter().filter_map(last_position).max(),
        _ => None,
    });
    within.chain(table.position()).max()
}

fn set_positions(table: &mut Table, position: Option<isize>) {
    table.set_position(position);
    for (_, item) in table.iter_mut() {
        match item {
            Item::Table(inner) => set_positions(inner, position),
            Item::ArrayOfTables(list) => {
                list.iter_mut().for_each(|inner| set_positions(inner, position));
            }
            _ => {}
        }
    }
}

fn remove(document: &mut DocumentMut, key: &str, index: usize) {
    let kept = match document.get_mut(key) {
        Some(Item::ArrayOfTables(list)) => {
            let Some(table) = list.get(index) else { return };
            let prefix = table.decor().prefix().and_then(toml_edit::RawString::as_str);
            let kept = separate_comments(prefix.unwrap_or_default()).to_owned();
            let position = last_position(table);
            list.remove(index);
            if list.is_empty() {
                document.remove(key);
            }
            position.map(|position| (kept, position))
        }
        Some(Item::Value(Value::Array(list))) => {
            list.remove(index);
            None
        }
        _ => None,
    };
    let Some((kept, position)) = kept.filter(|(kept, _)| !kept.trim().is_empty()) else { return };
    // Comments of a section stay where they are: before the next table.
    let tables = document.iter_mut().flat_map(|(_, item)| match item {
        Item::Table(table) => vec![table],
        Item::ArrayOfTables(list) => list.iter_mut().collect(),
        _ => Vec::new(),
    });
    let later = tables.filter(|table| table.position().is_some_and(|at| at > position));
    match later.min_by_key(|table| table.position()) {
        Some(next) => {
            let before = next.decor().prefix().and_then(toml_edit::RawString::as_str);
            let before = before.unwrap_or_default().trim_start_matches('\n').to_owned();
            next.decor_mut().set_prefix(format!("{kept}{before}"));
        }
        None => {
            let trailing = document.trailing().as_str().unwrap_or_default();
            let trailing = format!("{kept}{trailing}");
            document.set_trailing(trailing);
        }
    }
}

/// The comments above a table that are separated from it by an empty line, with this line.
fn separate_comments(prefix: &str) -> &str {
    let mut end = 0;
    let mut at = 0;
    for line in prefix.split_inclusive('\n') {
        at += line.len();
        if line.trim().is_empty() {
            end = at;
        }
    }
    &prefix[..end]
}
