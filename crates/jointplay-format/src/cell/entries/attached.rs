//! Bodies, parts and frames that move with a station, an arm or an effector.

use std::collections::BTreeMap;

use toml_edit::{DocumentMut, Item, TableLike, Value};

use super::super::described::{self, tables_of};
use super::super::edit::replace;
use super::super::problem::Fault;
use super::lists::{self, SectionComments};
use super::names::{NAMED, Names, name};

/// Lists of tables that can be attached; frames first, for the others can be attached to them.
const LISTS: [&str; 3] = ["frame", "body", "part"];

/// Names by the key of `on` that refers to them: `station`, `arm`, `effector` or `frame`.
pub(super) type Owners = BTreeMap<&'static str, Vec<String>>;

/// New names by the key of `on`, and by the old name.
pub(super) type NewNames = BTreeMap<(&'static str, String), String>;

/// An attached table.
pub(super) struct Attached {
    list: &'static str,
    index: usize,
    /// Its name.
    pub(super) name: String,
}

/// All tables attached to the owners, directly or by frames.
pub(super) fn attached(document: &DocumentMut, mut owners: Owners) -> Vec<Attached> {
    let mut found: Vec<Attached> = Vec::new();
    for list in LISTS {
        for (index, table) in described::all(document, list).into_iter().enumerate() {
            let Some(name) = name(table) else { continue };
            let Some(on) = parent(document, table) else { continue };
            let Some(on) = on.as_table_like() else { continue };
            let is_owned = owners.iter().any(|(key, names)| {
                let named = on.get(key).and_then(Item::as_str);
                named.is_some_and(|named| names.iter().any(|one| one == named))
            });
            if !is_owned {
                continue;
            }
            let name = name.to_owned();
            if list == "frame" {
                owners.entry("frame").or_default().push(name.clone());
            }
            found.push(Attached { list, index, name });
        }
    }
    found
}

/// `on` of a table, also where it takes it from another one by `like`.
fn parent<'d>(document: &'d DocumentMut, table: &'d dyn TableLike) -> Option<&'d Item> {
    let mut table = table;
    let all: Vec<&dyn TableLike> =
        NAMED.iter().flat_map(|key| described::all(document, key)).collect();
    // No chain is longer than the number of tables, unless it is circular.
    for _ in 0..=all.len() {
        if let Some(on) = table.get("on") {
            return Some(on);
        }
        let like = table.get("like").and_then(Item::as_str)?;
        table = *all.iter().find(|one| name(**one) == Some(like))?;
    }
    None
}

/// Duplicates attached tables under the given new names of their owners; returns old and new names.
pub(super) fn duplicate(
    document: &mut DocumentMut,
    attached: &[Attached],
    owner: (&str, &str),
    new_names: &mut NewNames,
    names: &mut Names,
) -> BTreeMap<String, String> {
    let mut renamed = BTreeMap::new();
    for one in attached {
        let (old, new) = owner;
        let is_pattern = described::all(document, one.list)
            .get(one.index)
            .is_some_and(|table| table.contains_key("repeat"));
        let own = one.name.strip_prefix(old).map(|rest| format!("{new}{rest}"));
        let taken = match own {
            _ if is_pattern => names.take_pattern(&one.name),
            Some(own) if !names.is_used(&own) => names.take(&own),
            _ => names.take(&one.name),
        };
        if one.list == "frame" {
            new_names.insert(("frame", one.name.clone()), taken.clone());
        }
        renamed.insert(one.name.clone(), taken);
    }
    // From the last one: a duplicate in an inline list moves those after it.
    for one in attached.iter().rev() {
        let tables = described::all(document, one.list);
        let Some(table) = tables.get(one.index) else { continue };
        let on = parent(document, *table).cloned();
        let name = renamed[&one.name].as_str();
        lists::duplicate(document.as_table_mut(), one.list, one.index, |copy| {
            rename(copy, name);
            if let Some(on) = on.filter(|_| !copy.contains_key("on")) {
                copy.insert("on", on);
            }
            let on = copy.get_mut("on").and_then(Item::as_table_like_mut);
            for (key, item) in on.into_iter().flat_map(TableLike::iter_mut) {
                let key = key.get().to_owned();
                let new = new_names
                    .iter()
                    .find(|((list, old), _)| *list == key && item.as_str() == Some(old.as_str()));
                if let (Some((_, new)), Some(value)) = (new, item.as_value_mut()) {
                    replace(value, Value::from(new));
                }
            }
        });
    }
    renamed
}

/// Sets the name of a table.
pub(super) fn rename(table: &mut dyn TableLike, name: &str) {
    if let Some(old) = table.get_mut("name").and_then(Item::as_value_mut) {
        replace(old, Value::from(name));
    }
}

/// Removes attached tables; returns the comments of sections that remain.
pub(super) fn remove(document: &mut DocumentMut, attached: &[Attached]) -> Vec<SectionComments> {
    let removed = attached
        .iter()
        .rev()
        .filter_map(|one| lists::remove(document.as_table_mut(), one.list, one.index));
    removed.collect()
}

/// Checks that no other table takes values from the removed ones.
///
/// # Errors
/// A table does, by `like`.
pub(super) fn check_not_borrowed(document: &DocumentMut, removed: &[&str]) -> Result<(), Fault> {
    let tables = NAMED.iter().flat_map(|key| described::all(document, key));
    let borrowed = tables.filter_map(|table| {
        let like = table.get("like").and_then(Item::as_str)?;
        let own = name(table);
        let is_kept = own.is_none_or(|own| !removed.contains(&own));
        (removed.contains(&like) && is_kept).then_some((own.unwrap_or("another table"), like))
    });
    match borrowed.into_iter().next() {
        None => Ok(()),
        Some((own, like)) => Err(Fault::Unfit(format!(
            "{own:?} takes values from {like:?} by `like`: change it first"
        ))),
    }
}

/// Names of tables of a list within a table.
pub(super) fn names_in(parent: &dyn TableLike, key: &str) -> Vec<String> {
    let tables = tables_of(parent, key).into_iter();
    tables.filter_map(|table| name(table).map(str::to_owned)).collect()
}
