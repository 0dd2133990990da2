//! Names in use.

use std::collections::BTreeSet;

use toml_edit::{DocumentMut, Item, TableLike};

use super::super::described::{self, tables_of};
use super::super::robot::ROD_NAMES;
use crate::toml_reader::LONGEST_NAME;

/// Lists whose names are distinct, or that `like` refers to.
pub(super) const NAMED: [&str; 6] = ["station", "part", "body", "zone", "frame", "template"];

/// Names in use in a cell file.
pub(super) struct Names {
    used: BTreeSet<String>,
    /// Names of patterns, to which `repeat` adds numbers.
    patterns: Vec<String>,
}

impl Names {
    /// All names of a document, including those of the robot in it.
    pub(super) fn of(document: &DocumentMut) -> Self {
        let tables = NAMED.iter().flat_map(|key| described::all(document, key));
        let (patterns, single): (Vec<_>, Vec<_>) =
            tables.partition(|table| table.contains_key("repeat"));
        let named = |tables: Vec<&dyn TableLike>| -> Vec<String> {
            tables.into_iter().filter_map(|table| name(table).map(str::to_owned)).collect()
        };
        let patterns = named(patterns);
        let mut used: BTreeSet<String> = named(single).into_iter().collect();
        used.extend(patterns.iter().cloned());
        used.extend(ROD_NAMES.map(str::to_owned));
        if let Some(robot) = document.get("robot").and_then(Item::as_table_like) {
            let arms = tables_of(robot, "arm");
            let effectors = arms.iter().flat_map(|arm| tables_of(*arm, "effector"));
            let all = tables_of(robot, "axis").into_iter().chain(effectors);
            used.extend(named(all.chain(arms.iter().copied()).collect()));
        }
        Self { used, patterns }
    }

    /// A name that is not in use, with the next number; it is in use afterwards.
    pub(super) fn take(&mut self, name: &str) -> String {
        let base = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
        let first = name[base.len()..].parse().unwrap_or(1_usize);
        let numbered = (first.saturating_add(1)..).map(|number| {
            let number = number.to_string();
            let longest = LONGEST_NAME.saturating_sub(number.len());
            // A name with letters of several bytes is invalid already.
            format!("{}{number}", base.get(..longest).unwrap_or(base))
        });
        let free = std::iter::once(name.to_owned()).chain(numbered).find(|it| !self.is_used(it));
        let free = free.unwrap_or_default();
        self.used.insert(free.clone());
        free
    }

    /// A name of a pattern whose copies have names that are not in use.
    pub(super) fn take_pattern(&mut self, name: &str) -> String {
        let free = self.take(&format!("{name}-2-"));
        self.patterns.push(free.clone());
        free
    }

    /// Whether a name is in use.
    pub(super) fn is_used(&self, name: &str) -> bool {
        let is_copy = |pattern: &String| {
            let number = name.strip_prefix(pattern.as_str());
            number.is_some_and(|it| !it.is_empty() && it.bytes().all(|it| it.is_ascii_digit()))
        };
        self.used.contains(name) || self.patterns.iter().any(is_copy)
    }
}

/// The name of a table.
pub(super) fn name(table: &dyn TableLike) -> Option<&str> {
    table.get("name").and_then(Item::as_str)
}
