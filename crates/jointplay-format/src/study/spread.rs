//! Values in a study file: a number, a range, a list, or a distribution.

use std::ops::Range;

use jointplay_study::plan::Variation;
use toml::de::DeValue;

use super::Problem;
use super::tree::{AllowedRange, Entry, Reader, Table};
use crate::file_problem::FileProblem;
use crate::steps;

/// Largest value of a parameter, in the unit of the file; far from where squares overflow.
const LARGEST_PARAMETER: f64 = 1e12;

/// The values that a key may have, and their conversion to SI.
#[derive(Clone, Copy)]
pub(super) struct Allowed<'f> {
    /// Least and greatest, in the unit of the file.
    pub(super) bounds: (f64, f64),
    pub(super) to_si: &'f dyn Fn(f64) -> f64,
}

/// Number of samples of a grid, as long as it can be counted.
pub(super) struct GridSize(Option<u64>);

impl GridSize {
    /// Without directions, a grid has one sample.
    pub(super) fn new() -> Self {
        Self(Some(1))
    }

    /// Adds a direction; whether the samples are still counted.
    ///
    /// Where they are not, the study is refused, and further lists of values would only take memory.
    pub(super) fn add(&mut self, values: &Variation) -> bool {
        let size = self.0.and_then(|size| size.checked_mul(values.values()));
        self.0 = size.filter(|&size| i64::try_from(size).is_ok());
        self.0.is_some()
    }
}

/// Names of distributions.
const UNIFORM: &str = "uniform";
const NORMAL: &str = "normal";

/// Reads the values of a key.
pub(super) fn read(reader: &Reader, allowed_values: &Allowed, entry: &Entry) -> Option<Variation> {
    let Allowed { bounds: (min, max), to_si } = *allowed_values;
    let allowed = AllowedRange::Within(min, max);
    let numbers = match entry.value.get_ref() {
        DeValue::Integer(_) | DeValue::Float(_) => vec![entry.number(reader, allowed)?],
        DeValue::String(range) => {
            let invalid =
                |source| entry.report(reader, Problem::Range { key: entry.key.to_owned(), source });
            let numbers = steps::parse(range).map_err(invalid).ok()?;
            let outside = |number: &&f64| !(min..=max).contains(*number);
            if let Some(&number) = numbers.iter().find(outside) {
                entry.within(reader, number, allowed)?;
            }
            numbers
        }
        DeValue::Array(_) => {
            let list = entry.list(reader)?;
            if list.is_empty() {
                entry.report(reader, Problem::Empty { key: entry.key.to_owned() });
                return None;
            }
            if list.iter().any(|entry| !is_number(entry)) {
                entry.report(reader, Problem::Spread { key: entry.key.to_owned() });
                return None;
            }
            let numbers: Vec<_> = list.iter().map(|entry| entry.number(reader, allowed)).collect();
            numbers.into_iter().collect::<Option<_>>()?
        }
        DeValue::Table(table) if table.len() == 1 => {
            let table = entry.table(reader, "a distribution")?;
            return drawn(&table, to_si, allowed, entry);
        }
        _ => {
            entry.report(reader, Problem::Spread { key: entry.key.to_owned() });
            return None;
        }
    };
    Some(Variation::Values(numbers.into_iter().map(to_si).collect()))
}

/// A distribution: a table with one key.
fn drawn(
    table: &Table,
    to_si: &dyn Fn(f64) -> f64,
    allowed: AllowedRange,
    entry: &Entry,
) -> Option<Variation> {
    let reader = table.reader;
    let (uniform, normal) = (table.entry(UNIFORM), table.entry(NORMAL));
    table.finish();
    let pair = uniform.or(normal)?;
    let numbers = match pair.value.get_ref() {
        DeValue::Array(list) if list.len() == 2 => pair.list(reader)?,
        _ => Vec::new(),
    };
    let [first, second] = numbers.as_slice() else {
        entry.report(reader, Problem::Spread { key: entry.key.to_owned() });
        return None;
    };
    if !is_number(first) || !is_number(second) {
        entry.report(reader, Problem::Spread { key: entry.key.to_owned() });
        return None;
    }
    // Messages name the key of the study, not the distribution.
    let number =
        |found: &Entry| Entry { key: entry.key, value: found.value }.number(reader, allowed);
    let (one, other) = (number(first), number(second));
    let (one, other) = (one?, other?);
    if uniform.is_some() {
        if one >= other {
            entry.report(
                reader,
                Problem::Reversed { key: entry.key.to_owned(), from: one, to: other },
            );
            return None;
        }
        return Some(Variation::Uniform { from: to_si(one), to: to_si(other) });
    }
    if other <= 0.0 {
        entry.report(reader, Problem::Deviation { key: entry.key.to_owned(), value: other });
        return None;
    }
    Some(Variation::Normal { mean: to_si(one), deviation: to_si(other) })
}

fn is_number(entry: &Entry) -> bool {
    matches!(entry.value.get_ref(), DeValue::Integer(_) | DeValue::Float(_))
}

/// Values of parameters, in the units of their file: the index among the known names, and the values, in the order of the text.
pub(super) fn parameters(table: &Table, known: &[&str]) -> Option<Vec<(usize, Variation)>> {
    let reader = table.reader;
    let bounds = (-LARGEST_PARAMETER, LARGEST_PARAMETER);
    let allowed = Allowed { bounds, to_si: &|value| value };
    let mut found = Vec::new();
    let mut are_valid = true;
    let mut size = GridSize::new();
    for (entry, span) in in_order(table) {
        let parameter = match known.iter().position(|name| *name == entry.key) {
            Some(index) => read(reader, &allowed, &entry).map(|values| (index, values)),
            None => {
                let known = known.iter().copied();
                reader.report(span, FileProblem::unknown("parameter", entry.key, known));
                None
            }
        };
        are_valid &= parameter.is_some();
        let is_counted = parameter.as_ref().is_none_or(|(_, values)| size.add(values));
        found.extend(parameter);
        if !is_counted {
            break;
        }
    }
    are_valid.then_some(found)
}

/// The entries of a table in the order of the text: it is the order of the grid.
pub(super) fn in_order<'r, 'a>(table: &Table<'r, 'a>) -> Vec<(Entry<'r, 'a>, Range<usize>)> {
    let mut entries: Vec<_> = table.entries().collect();
    entries.sort_by_key(|(_, span)| span.start);
    entries
}

/// Whether there is a number of draws if, and only if, anything is random; reports the error otherwise.
///
/// # Arguments
/// * `random` – key of the table with random values
/// * `span` – place of a number of draws that is not needed
pub(super) fn has_draws(
    top: &Table,
    draws: Option<u64>,
    random: Option<&'static str>,
    span: Range<usize>,
) -> bool {
    match (draws, random) {
        (None, Some(key)) => top.report_at(key, Problem::NoSamples),
        (Some(_), None) => top.reader.report(span, Problem::NothingRandom),
        _ => return true,
    }
    false
}
