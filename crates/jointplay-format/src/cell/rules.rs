//! Rules for the visits of wafers in a cell file.

use std::collections::BTreeMap;

use jointplay_cell::station::{Station, VisitRule};

use super::problem::Fault;
use super::tree::Table;
use super::unique::unique;

/// Largest number of visits in a rule.
const MAX_VISITS: usize = 1000;

/// The rules for visits.
pub(super) fn visits(top: &Table, stations: &[Station]) -> Vec<VisitRule> {
    // A station with errors is missing in the list, but its name is known.
    let named: Vec<String> = top
        .tables("station")
        .iter()
        .filter_map(|table| table.entry("name")?.value.get_ref().as_str().map(str::to_owned))
        .collect();
    let mut names = BTreeMap::new();
    let mut rules = Vec::new();
    for mut table in top.tables("rule") {
        let name = table.needed("name").and_then(|name| name.line(table.reader)).map(str::to_owned);
        if let Some(name) = &name {
            table.whose = format!("the rule {name:?}");
            unique(&table, "rule", name, &mut names);
        }
        rules.extend(rule(&table, name, stations, &named));
        table.finish();
    }
    rules
}

fn rule(
    table: &Table,
    name: Option<String>,
    stations: &[Station],
    named: &[String],
) -> Option<VisitRule> {
    let list = |key| indices(table, key, stations, named);
    let (visit, before, origins) = (list("visit"), list("before"), list("from"));
    let count = table.entry("times").and_then(|times| times.count(table.reader, 1, MAX_VISITS));
    if table.needed("visit")?.list_is_empty() {
        let why =
            format!("{} requires a visit to no station: name one or more in `visit`", table.whose);
        table.report_at("visit", Fault::Unfit(why));
        return None;
    }
    let (visit, before) = (visit?, before.unwrap_or_default());
    if let Some(both) = visit.iter().find(|&station| before.contains(station)) {
        let why = format!(
            "{} requires a visit to {} before a visit to {}: remove it from `visit` or from `before`",
            table.whose, stations[*both].name, stations[*both].name
        );
        table.report_at("before", Fault::Unfit(why));
        return None;
    }
    Some(VisitRule {
        name: name?,
        stations: visit,
        before,
        origins: origins.unwrap_or_default(),
        count,
    })
}

/// Indices of the stations in a list of names, each once.
fn indices(
    table: &Table,
    key: &'static str,
    stations: &[Station],
    named: &[String],
) -> Option<Vec<usize>> {
    let entry = table.entry(key)?;
    let mut found = Vec::new();
    for name in entry.list(table.reader)? {
        let text = name.text(table.reader)?;
        match stations.iter().position(|station| station.name == text) {
            Some(index) if found.contains(&index) => {}
            Some(index) => found.push(index),
            None if named.iter().any(|known| known == text) => return None,
            None => {
                name.unknown(table.reader, "station", text, named);
                return None;
            }
        }
    }
    Some(found)
}
