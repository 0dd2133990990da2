//! Joints from their tables.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use jointplay_core::mechanism::joint::Coordinate;
use jointplay_core::mechanism::{Joint, JointKind, LinearAndAngular};
use toml::de::DeValue;

use super::frame;
use super::names::{joint_name, printable_name};
use super::problem::Problem;
use super::tree::{Entry, Table};
use super::values::Values;
use crate::file_problem::FileProblem;

const KINDS: [(&str, JointKind); 9] = [
    ("revolute", JointKind::Revolute),
    ("prismatic", JointKind::Prismatic),
    ("helical", JointKind::Helical { lead: 0.0 }),
    ("cylindrical", JointKind::Cylindrical),
    ("universal", JointKind::Universal),
    ("spherical", JointKind::Spherical),
    ("planar", JointKind::Planar),
    ("fixed", JointKind::Fixed),
    ("floating", JointKind::Floating),
];

/// Links in order of first mention, by name.
#[derive(Clone, Default)]
pub(super) struct Links {
    pub(super) names: Vec<String>,
    indices: BTreeMap<String, usize>,
}

impl Links {
    /// Links that are there already, in this order.
    pub(super) fn of(names: &[String]) -> Self {
        let mut links = Self::default();
        names.iter().for_each(|name| {
            links.index(name);
        });
        links
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.find(name).is_some()
    }

    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.indices.get(name).copied()
    }

    pub(super) fn index(&mut self, name: &str) -> usize {
        if let Some(&index) = self.indices.get(name) {
            return index;
        }
        self.indices.insert(name.to_owned(), self.names.len());
        self.names.push(name.to_owned());
        self.names.len() - 1
    }
}

/// The table of a joint, virtual joint or frame, named in messages by its `name`, with that name.
pub(super) fn named(table: &mut Table, what: &str) -> Option<String> {
    let entry = table.needed("name")?;
    let name = joint_name(table.reader, &entry)?;
    table.whose = format!("the {what} {name:?}");
    table.span = entry.span();
    Some(name)
}

/// A joint from its table; adds its links to `links`.
pub(super) fn joint(values: &Values, table: &mut Table, links: &mut Links) -> Option<Joint> {
    let name = named(table, "joint");
    let kind = kind(values, table, name.as_deref());
    let ends = table.needed("links").and_then(|entry| ends(values, &entry, links));
    let frames = frame::both(values, table, kind);
    let kind = lead(values, table, kind);
    let actuated = table.entry("actuated").map(|entry| entry.flag(values.reader));
    let limits = limits(values, table, kind);
    let guess = guess(values, table, kind);
    let clearance = linear_and_angular(values, table, "clearance");
    let stiffness = linear_and_angular(values, table, "stiffness");
    table.finish();
    Some(Joint {
        name: name?,
        kind: kind?,
        links: ends?,
        frames: frames?,
        actuated: actuated.unwrap_or(Some(false))?,
        guess: guess?,
        limits: limits?,
        clearance: LinearAndAngular {
            linear: clearance.linear.map(|value| values.length(value)),
            angular: clearance.angular.map(|value| values.angle(value)),
        },
        stiffness,
    })
}

/// The two links of a joint by index.
fn ends(values: &Values, entry: &Entry, links: &mut Links) -> Option<[usize; 2]> {
    let list = entry.list(values.reader)?;
    if list.len() != 2 {
        let (key, found, needed) = (entry.key.to_owned(), list.len(), "2".to_owned());
        entry.report(values.reader, FileProblem::Count { key, found, needed });
    }
    let names: Vec<_> = list.iter().map(|entry| printable_name(values.reader, entry)).collect();
    let names = names.into_iter().collect::<Option<Vec<_>>>()?;
    let [first, second] = names.as_slice() else { return None };
    Some([links.index(first), links.index(second)])
}

/// The kind of a joint, with a lead of zero.
fn kind(values: &Values, table: &mut Table, name: Option<&str>) -> Option<JointKind> {
    let kind = table.needed("kind")?.word(values.reader, "kind of joint", &KINDS)?;
    if let Some(name) = name {
        table.whose = format!("the {} joint {name:?}", kind.name());
    }
    Some(kind)
}

/// The kind of a joint with its lead.
fn lead(values: &Values, table: &Table, kind: Option<JointKind>) -> Option<JointKind> {
    let entry = table.entry("lead");
    let lead = entry.map(|entry| values.number(&entry).map(|lead| values.length(lead) / TAU));
    match (kind?, entry) {
        (JointKind::Helical { .. }, Some(_)) => Some(JointKind::Helical { lead: lead?? }),
        (JointKind::Helical { .. }, None) => {
            table.missing("lead");
            None
        }
        (kind, Some(entry)) => {
            let why = format!("only helical joints have it, this one is {}", kind.name());
            entry.report(values.reader, Problem::Misplaced { key: "lead", why });
            None
        }
        (kind, None) => Some(kind),
    }
}

fn guess(values: &Values, table: &Table, kind: Option<JointKind>) -> Option<Vec<f64>> {
    let Some(guess) = table.entry("guess") else { return Some(Vec::new()) };
    let entries = entries(&guess);
    let numbers: Vec<_> = entries.iter().map(|entry| values.number(entry)).collect();
    let kind = kind?;
    let coordinates = kind.coordinates();
    if numbers.len() != coordinates.len() {
        guess.report(values.reader, count("guess", numbers.len(), kind));
        return None;
    }
    let read = |((&coordinate, entry), number): ((&Coordinate, &Entry), Option<f64>)| {
        values.coordinate(entry, coordinate, number?)
    };
    let read: Vec<_> = coordinates.iter().zip(&entries).zip(numbers).map(read).collect();
    read.into_iter().collect()
}

/// A lower and an upper limit in the units of the file, with their entries; no numbers for an invalid pair.
struct Pair<'r, 'a> {
    entries: Vec<Entry<'r, 'a>>,
    numbers: Option<[f64; 2]>,
}

fn limits(values: &Values, table: &Table, kind: Option<JointKind>) -> Option<Vec<[f64; 2]>> {
    let Some(limits) = table.entry("limits") else { return Some(Vec::new()) };
    let list = limits.list(values.reader)?;
    let is_pair = |entry: &Entry| matches!(entry.value.get_ref(), DeValue::Array(_));
    let lists = if list.iter().any(is_pair) { list } else { vec![limits] };
    let pairs: Vec<Pair> = lists.into_iter().map(|entry| pair(values, entry)).collect();
    let kind = kind?;
    let coordinates = kind.coordinates();
    if pairs.len() != coordinates.len() {
        limits.report(values.reader, count("limits", pairs.len(), kind));
        return None;
    }
    let read = |(&coordinate, pair): (&Coordinate, &Pair)| {
        let [min, max] = pair.numbers?;
        let si = |index: usize, value: f64| match value.is_infinite() {
            true => Some(value),
            false => values.coordinate(&pair.entries[index], coordinate, value),
        };
        let (min, max) = (si(0, min), si(1, max));
        Some([min?, max?])
    };
    let read: Vec<_> = coordinates.iter().zip(&pairs).map(read).collect();
    read.into_iter().collect()
}

fn pair<'r, 'a>(values: &Values, entry: Entry<'r, 'a>) -> Pair<'r, 'a> {
    let entries = entries(&entry);
    let number = |entry: &Entry| endless(entry).or_else(|| values.number(entry));
    let numbers: Vec<_> = entries.iter().map(number).collect();
    let numbers = match numbers.as_slice() {
        &[Some(min), Some(max)] if min < max => Some([min, max]),
        &[Some(min), Some(max)] => {
            entry.report(values.reader, Problem::LimitsReversed { min, max });
            None
        }
        [_, _] => None,
        _ => {
            let needed = "pairs of least and greatest".to_owned();
            let (key, found) = ("limits".to_owned(), numbers.len());
            entry.report(values.reader, FileProblem::Count { key, found, needed });
            None
        }
    };
    Pair { entries, numbers }
}

/// An end of a range that is written as `inf` or `-inf`: no limit.
fn endless(entry: &Entry) -> Option<f64> {
    let DeValue::Float(number) = entry.value.get_ref() else { return None };
    number.as_str().parse().ok().filter(|value: &f64| value.is_infinite())
}

/// The entries of a list, or the one value that is no list.
fn entries<'r, 'a>(entry: &Entry<'r, 'a>) -> Vec<Entry<'r, 'a>> {
    match entry.value.get_ref() {
        DeValue::Array(list) => list.iter().map(|value| Entry { key: entry.key, value }).collect(),
        _ => vec![*entry],
    }
}

/// Error of a list without an entry for each freedom.
fn count(key: &str, found: usize, kind: JointKind) -> FileProblem {
    let of_each = if key == "limits" { "pairs, one" } else { "numbers, one" };
    let needed =
        format!("{} {of_each} for each freedom of a {} joint", kind.freedoms(), kind.name());
    FileProblem::Count { key: key.to_owned(), found, needed }
}

/// Two numbers in the units of the file; without the table neither.
fn linear_and_angular(values: &Values, table: &Table, key: &'static str) -> LinearAndAngular {
    let Some(table) = table.table(key, format!("`{key}`")) else {
        return LinearAndAngular::default();
    };
    let linear = values.positive(&table, "linear");
    let angular = values.positive(&table, "angular");
    table.finish();
    LinearAndAngular { linear, angular }
}
