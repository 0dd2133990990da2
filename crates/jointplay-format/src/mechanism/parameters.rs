//! Values of parameters that refer to each other, in any order.

use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;

use super::expression::{AngleUnit, Expression, Scope, is_free_name};
use super::file::Number;
use super::problem::{Error, Problem};
use super::values::{expression_error, unknown};

/// A parameter that still waits for those it names.
struct Waiting {
    name: String,
    span: Range<usize>,
    expression: Expression,
}

/// The values of all parameters, in the units of the file; `replaced` wins over what the file says.
pub(super) fn resolve(
    text: &str,
    table: &BTreeMap<Spanned<String>, Spanned<Number>>,
    replaced: &[(String, f64)],
    angle: AngleUnit,
) -> Result<Scope, Error> {
    let names = || table.keys().map(|name| name.get_ref().as_str());
    let mut scope = Scope { angle, values: BTreeMap::new() };
    for (name, value) in replaced {
        let found = table.get_key_value(name.as_str());
        let span = found.map_or(0..0, |(_, number)| number.span());
        if found.is_none() {
            return Err(Error::at(text, span, unknown("parameter", name, names())));
        }
        if !value.is_finite() {
            let problem = Problem::NotFinite { key: name.clone(), value: *value };
            return Err(Error::at(text, span, problem));
        }
        scope.values.insert(name.clone(), *value);
    }
    let mut waiting = Vec::new();
    for (key, number) in table {
        let (name, span) = (key.get_ref(), number.span());
        if !is_free_name(name) {
            let problem = Problem::ParameterName { found: name.clone() };
            return Err(Error::at(text, key.span(), problem));
        }
        match number.get_ref() {
            _ if scope.values.contains_key(name) => {}
            Number::Value(value) if value.is_finite() => {
                scope.values.insert(name.clone(), *value);
            }
            Number::Value(value) => {
                let problem = Problem::NotFinite { key: name.clone(), value: *value };
                return Err(Error::at(text, span, problem));
            }
            Number::Expression(source) => {
                let expression = Expression::parse(source)
                    .map_err(|error| expression_error(text, &span, source, error))?;
                waiting.push(Waiting { name: name.clone(), span, expression });
            }
        }
    }
    for index in in_order(&waiting).map_err(|circle| {
        let names = circle.iter().map(|&index| waiting[index].name.clone()).collect();
        Error::at(text, waiting[circle[0]].span.clone(), Problem::Cycle { names })
    })? {
        let Waiting { name, span, expression } = &waiting[index];
        let value = expression.evaluate(&scope).map_err(|error| {
            let source = match table.get(name.as_str()).map(Spanned::get_ref) {
                Some(Number::Expression(source)) => source,
                _ => "",
            };
            expression_error(text, span, source, error.among(names()))
        })?;
        scope.values.insert(name.clone(), value);
    }
    Ok(scope)
}

/// An order in which each comes after all that it names, or else a circle, closed.
///
/// Depth first with a stack of its own, for a chain of parameters can be as long as the file.
fn in_order(waiting: &[Waiting]) -> Result<Vec<usize>, Vec<usize>> {
    let index: BTreeMap<&str, usize> =
        waiting.iter().enumerate().map(|(index, item)| (item.name.as_str(), index)).collect();
    let needs: Vec<Vec<usize>> = waiting
        .iter()
        .map(|item| item.expression.names().filter_map(|name| index.get(name).copied()).collect())
        .collect();
    let (mut order, mut done) = (Vec::new(), vec![false; waiting.len()]);
    // Where in the path each item stands, while it does.
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
                let circle = path[first..].iter().map(|(item, _)| *item);
                return Err(circle.chain([need]).collect());
            }
            if !done[need] {
                entered[need] = Some(path.len());
                path.push((need, 0));
            }
        }
    }
    Ok(order)
}
