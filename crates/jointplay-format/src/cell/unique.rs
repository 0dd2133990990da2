//! Names that must differ.

use std::collections::BTreeMap;

use super::problem::Fault;
use super::tree::Table;

/// Reports a name that is already in use.
pub(super) fn unique(table: &Table, what: &str, name: &str, names: &mut BTreeMap<String, usize>) {
    let entry = table.entry("name");
    let span = entry.map_or(table.span.clone(), |entry| entry.span());
    let line = table.reader.line(span.clone());
    if let Some(&first) = names.get(name) {
        let (what, found) = (what.to_owned(), name.to_owned());
        table.reader.report(span, Fault::Twice { what, found, first });
    } else {
        names.insert(name.to_owned(), line);
    }
}
