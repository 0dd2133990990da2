//! The table that describes a station: its own, or that of a part.

use std::ops::Range;

use toml_edit::{Document, DocumentMut, Item, TableLike, Value};

use super::expansion::{is_replaced, is_station};
use super::problem::{Fault, Problem};
use crate::file_problem::FileProblem;
use crate::place::Error;

/// Keys of lists whose tables describe stations.
pub(super) const TABLES: [&str; 2] = ["station", "part"];

/// Keys whose texts are no expressions.
const TEXTS: [&str; 10] = [
    "name",
    "like",
    "part",
    "on",
    "approach",
    "effectors",
    "wafers",
    "repeat",
    "sensor",
    "reference_sensor",
];

/// The table of a station.
pub(super) struct Described<'d> {
    pub(super) table: &'d mut dyn TableLike,
    /// Whether it is one of a list `station = [{ … }]`.
    pub(super) is_inline: bool,
}

/// Whether a table describes the one station of this name.
pub(super) fn is_called(table: &dyn TableLike, name: &str) -> bool {
    text(table, "name") == Some(name) && !table.contains_key("repeat") && may_be_station(table)
}

fn text<'t>(table: &'t dyn TableLike, key: &str) -> Option<&'t str> {
    table.get(key).and_then(Item::as_str)
}

/// Whether a table can describe a station: a part of the library that is none cannot.
fn may_be_station(table: &dyn TableLike) -> bool {
    text(table, "part").and_then(is_station) != Some(false)
}

/// The table of the station of a name.
///
/// # Errors
/// There is no such station, or it is a copy in a pattern.
pub(super) fn table<'d>(document: &'d mut DocumentMut, name: &str) -> Result<Described<'d>, Fault> {
    let mut tables = Vec::new();
    for (_, item) in document.iter_mut().filter(|(key, _)| TABLES.contains(&key.get())) {
        match item {
            Item::ArrayOfTables(list) => {
                let table = |table| Described { table, is_inline: false };
                tables.extend(list.iter_mut().map(|it| table(it as &mut dyn TableLike)));
            }
            Item::Value(Value::Array(list)) => {
                let inline = list.iter_mut().filter_map(Value::as_inline_table_mut);
                tables.extend(inline.map(|table| Described { table, is_inline: true }));
            }
            _ => {}
        }
    }
    if tables.is_empty() {
        let whose = "a cell whose stations can be changed".to_owned();
        return Err(FileProblem::MissingKey { whose, key: "[[station]]".to_owned() }.into());
    }
    if let Some(found) = tables.iter().position(|one| is_called(one.table, name)) {
        return Ok(tables.swap_remove(found));
    }
    let is_copy = |one: &&Described<'_>| {
        let number = text(one.table, "name").and_then(|base| name.strip_prefix(base));
        one.table.contains_key("repeat") && number.is_some_and(|it| it.parse::<usize>().is_ok())
    };
    if let Some(pattern) = tables.iter().find(is_copy) {
        let base = text(pattern.table, "name").unwrap_or_default();
        return Err(Fault::Unfit(format!(
            "the station {name:?} is a copy of {base:?}, which `repeat` describes together with the other copies: change the table of {base:?} in the text, or describe {name:?} by a table of its own"
        )));
    }
    let stations = tables.iter().filter(|one| may_be_station(one.table));
    let names = stations.filter_map(|one| text(one.table, "name"));
    Err(FileProblem::unknown("station", name, names).into())
}

/// Values of keys that a station takes from others by `like`; with a carrier axis, also those that belong to it.
pub(super) fn inherited(
    document: &DocumentMut,
    name: &str,
    keys: &[&'static str],
) -> Vec<(String, Item)> {
    let lists = TABLES.into_iter().chain(["template"]);
    let tables: Vec<&dyn TableLike> = lists.flat_map(|key| all(document, key)).collect();
    let mut found: Vec<(String, Item)> = Vec::new();
    let Some(own) = tables.iter().find(|table| is_called(**table, name)) else { return found };
    let mut last = *own;
    // No chain is longer than the number of tables, unless it is circular.
    for _ in 0..tables.len() {
        let Some(like) = text(last, "like") else { break };
        let Some(original) = tables.iter().find(|it| text(**it, "name") == Some(like)) else {
            break;
        };
        for (key, item) in original.iter() {
            let has =
                |key: &str| own.contains_key(key) || found.iter().any(|(known, _)| known == key);
            let is_wanted = keys.contains(&key)
                || (matches!(key, "slots" | "pitch_mm") && keys.contains(&"carrier_axis"));
            let plane = [has_plane(*own), has_plane(*original)];
            if is_wanted && !is_replaced(key, &has, plane) {
                found.push((key.to_owned(), item.clone()));
            }
        }
        last = *original;
    }
    // The number of slots and the pitch are needed for a carrier axis only.
    if !found.iter().any(|(key, _)| key == "carrier_axis") {
        found.retain(|(key, _)| keys.contains(&key.as_str()));
    }
    found
}

fn has_plane(table: &dyn TableLike) -> bool {
    let taught = table.get("taught").and_then(Item::as_table_like);
    taught.is_some_and(|taught| taught.contains_key("points_mm"))
}

/// The tables of a list of the document.
pub(super) fn all<'d>(document: &'d DocumentMut, key: &str) -> Vec<&'d dyn TableLike> {
    tables_of(document.as_table(), key)
}

/// The tables of a list within a table.
pub(super) fn tables_of<'d>(parent: &'d dyn TableLike, key: &str) -> Vec<&'d dyn TableLike> {
    match parent.get(key) {
        Some(Item::ArrayOfTables(list)) => list.iter().map(|it| it as &dyn TableLike).collect(),
        Some(Item::Value(Value::Array(list))) => {
            list.iter().filter_map(Value::as_inline_table).map(|it| it as &dyn TableLike).collect()
        }
        _ => Vec::new(),
    }
}

/// Keys of a table whose values contain expressions, with these values.
pub(super) fn expressions(table: &dyn TableLike) -> Vec<(String, String)> {
    let with_expression = table.iter().filter(|(key, item)| has_expression(key, item));
    with_expression.map(|(key, item)| (key.to_owned(), item.to_string())).collect()
}

fn has_expression(key: &str, item: &Item) -> bool {
    let nested = |table: &dyn TableLike| table.iter().any(|(key, item)| has_expression(key, item));
    !TEXTS.contains(&key)
        && match item {
            Item::Value(value) => is_expression(value),
            other => other.as_table_like().is_some_and(nested),
        }
}

fn is_expression(value: &Value) -> bool {
    match value {
        Value::String(_) => true,
        Value::Array(list) => list.iter().any(is_expression),
        Value::InlineTable(table) => {
            table.iter().any(|(key, value)| !TEXTS.contains(&key) && is_expression(value))
        }
        _ => false,
    }
}

/// Checks that no expression was replaced or removed.
///
/// # Arguments
/// * `text` – of the file, for the place of an error
///
/// # Errors
/// The first expression that was, at its place in the text.
pub(super) fn check_unchanged(
    table: &dyn TableLike,
    name: &str,
    expressions: &[(String, String)],
    text: &str,
) -> Result<(), Problem> {
    let is_kept = |(key, value): &&(String, String)| {
        table.get(key).is_some_and(|item| item.to_string() == *value)
    };
    match expressions.iter().find(|one| !is_kept(one)) {
        None => Ok(()),
        Some((key, _)) => {
            let message = format!(
                "`{key}` of the station {name:?} is an expression: change it, or the parameters in it, in the text"
            );
            Err(Error::at(text, place(text, name, key).unwrap_or(0..0), Fault::Unfit(message)))
        }
    }
}

/// Where the value of a key of a station is in the text; `None` where the station takes it from elsewhere.
fn place(text: &str, name: &str, key: &str) -> Option<Range<usize>> {
    let document = Document::parse(text).ok()?;
    let mut tables = TABLES.iter().flat_map(|list| tables_of(document.as_table(), list));
    tables.find(|table| is_called(*table, name))?.get(key)?.span()
}
