//! Values of parameters that refer to each other, in any order.

use std::collections::{BTreeMap, BTreeSet};

use toml::de::DeValue;

use super::table::{Entry, Table};
use crate::expression::{AngleUnit, Formula, Scope, is_free_name};
use crate::file_problem::FileProblem;

/// Largest number of cycles that are reported.
const MOST_CYCLES: usize = 20;

/// A parameter whose value depends on others.
struct Waiting<'r, 'a> {
    entry: Entry<'r, 'a>,
    source: &'r str,
    formula: Formula,
}

/// Parameters as read.
pub(crate) struct Parameters {
    /// Values by name, in the units of the file.
    pub(crate) scope: Scope,
    /// Names in the order of the file.
    pub(crate) order: Vec<String>,
}

/// The values of all parameters, in the units of the file; `replaced` takes precedence over the file.
pub(crate) fn resolve<P: From<FileProblem> + PartialEq>(
    top: &Table<P>,
    replaced: &[(String, f64)],
    angle: AngleUnit,
) -> Parameters {
    let reader = top.reader;
    let table = top.table("parameters", "`[parameters]`");
    let mut entries: Vec<_> = table.iter().flat_map(Table::entries).collect();
    entries.sort_by_key(|(_, span)| span.start);
    let order: Vec<String> = entries.iter().map(|(entry, _)| entry.key.to_owned()).collect();
    let parameters: BTreeSet<String> = order.iter().cloned().collect();
    entries.sort_by_key(|(entry, _)| entry.key);
    let mut scope = Scope { values: BTreeMap::new(), parameters };
    for (name, value) in replaced {
        let found = entries.iter().find(|(entry, _)| entry.key == name);
        let span = found.map_or(0..0, |(entry, _)| entry.span());
        let key = name.clone();
        if found.is_none() {
            let known = scope.parameters.iter().map(String::as_str);
            reader.report(span, FileProblem::unknown("parameter", name, known));
        } else if !value.is_finite() {
            let needed = "a finite number".to_owned();
            reader.report(span, FileProblem::OutOfRange { key, value: *value, needed });
        } else {
            scope.values.insert(key, *value);
        }
    }
    let mut waiting = Vec::new();
    for (entry, span) in entries {
        let name = entry.key;
        if !is_free_name(name) {
            reader.report(span, FileProblem::ParameterName { found: name.to_owned() });
            continue;
        }
        if scope.values.contains_key(name) {
            continue;
        }
        match entry.value.get_ref() {
            DeValue::String(source) => {
                if let Some(formula) = entry.formula(reader, source, angle) {
                    waiting.push(Waiting { entry, source, formula });
                }
            }
            DeValue::Integer(_) | DeValue::Float(_) => match entry.any_number() {
                Some(value) if value.is_finite() => {
                    scope.values.insert(name.to_owned(), value);
                }
                Some(value) => {
                    let (key, needed) = (name.to_owned(), "a finite number".to_owned());
                    entry.report(reader, FileProblem::OutOfRange { key, value, needed });
                }
                None => entry.type_error(reader, "a number"),
            },
            _ => entry.type_error(reader, "a number or an expression"),
        }
    }
    let Sorted { order: sequence, cycles } = sorted(&waiting);
    for cycle in cycles {
        let names = cycle.iter().map(|&index| waiting[index].entry.key.to_owned()).collect();
        waiting[cycle[0]].entry.report(reader, FileProblem::Cycle { names });
    }
    for index in sequence {
        let Waiting { entry, source, formula } = &waiting[index];
        if let Some(value) = entry.evaluate(reader, source, formula, &scope) {
            scope.values.insert(entry.key.to_owned(), value);
        }
    }
    Parameters { scope, order }
}

/// Indices of parameters in the order of evaluation.
struct Sorted {
    order: Vec<usize>,
    /// Parameters that need each other; the first of each is also its last.
    cycles: Vec<Vec<usize>>,
}

/// Sorts parameters so that each comes after those that it names.
///
/// Depth first with a stack of its own, for a chain of parameters can be as long as the file.
fn sorted(waiting: &[Waiting]) -> Sorted {
    let index: BTreeMap<&str, usize> =
        waiting.iter().enumerate().map(|(index, item)| (item.entry.key, index)).collect();
    let needs: Vec<Vec<usize>> = waiting
        .iter()
        .map(|item| item.formula.names().filter_map(|name| index.get(name).copied()).collect())
        .collect();
    let mut cycles = Vec::new();
    let (mut order, mut done) = (Vec::new(), vec![false; waiting.len()]);
    // The position of each item in the path, while the path contains it.
    let mut entered: Vec<Option<usize>> = vec![None; waiting.len()];
    for start in 0..waiting.len() {
        if done[start] {
            continue;
        }
        entered[start] = Some(0);
        let mut path = vec![(start, 0)];
        while let Some((item, next)) = path.last_mut() {
            let item = *item;
            let Some(&need) = needs[item].get(*next) else {
                done[item] = true;
                entered[item] = None;
                order.push(item);
                path.pop();
                continue;
            };
            *next += 1;
            if let Some(first) = entered[need] {
                if cycles.len() < MOST_CYCLES {
                    let cycle = path[first..].iter().map(|(item, _)| *item);
                    cycles.push(cycle.chain([need]).collect());
                }
            } else if !done[need] {
                entered[need] = Some(path.len());
                path.push((need, 0));
            }
        }
    }
    Sorted { order, cycles }
}
