//! Values in a study file: a number, a range, a list, or a distribution.

use std::ops::Range;

use jointplay_study::plan::Variation;
use toml::{Spanned, Value};

use super::{Error, Problem};
use crate::place::nearest;
use crate::steps;

/// What values a key may have, and how they become SI.
pub(super) struct Key {
    pub(super) name: &'static str,
    /// Least and greatest, in the unit of the file.
    pub(super) bounds: (f64, f64),
    pub(super) to_si: fn(f64) -> f64,
}

const KINDS: [&str; 2] = ["uniform", "normal"];

/// Reads the values of a key.
pub(super) fn read(text: &str, key: &Key, value: &Spanned<Value>) -> Result<Variation, Error> {
    let wrong = |problem| Error::at(text, value.span(), problem);
    let name = key.name;
    let numbers = match value.get_ref() {
        Value::Integer(number) => vec![*number as f64],
        Value::Float(number) => vec![*number],
        Value::String(range) => {
            steps::parse(range).map_err(|source| wrong(Problem::Range { key: name, source }))?
        }
        Value::Array(entries) => {
            let numbers = numbers(entries).ok_or_else(|| wrong(Problem::Spread { key: name }))?;
            if numbers.is_empty() {
                return Err(wrong(Problem::Empty { key: name }));
            }
            numbers
        }
        Value::Table(table) => return drawn(text, key, value.span(), table),
        _ => return Err(wrong(Problem::Spread { key: name })),
    };
    for &number in &numbers {
        within(key, number).map_err(wrong)?;
    }
    Ok(Variation::Values(numbers.into_iter().map(key.to_si).collect()))
}

fn drawn(
    text: &str,
    key: &Key,
    span: Range<usize>,
    table: &toml::Table,
) -> Result<Variation, Error> {
    let wrong = |problem| Error::at(text, span.clone(), problem);
    let name = key.name;
    let mut entries = table.iter();
    let (Some((kind, pair)), None) = (entries.next(), entries.next()) else {
        return Err(wrong(Problem::Spread { key: name }));
    };
    if !KINDS.contains(&kind.as_str()) {
        return Err(wrong(Problem::Unknown {
            what: "distribution",
            found: kind.clone(),
            nearest: nearest(kind, KINDS.into_iter()),
            known: KINDS.map(str::to_owned).to_vec(),
        }));
    }
    let pair = pair.as_array().and_then(|entries| numbers(entries));
    let Some([first, second]) = pair.and_then(|pair| <[f64; 2]>::try_from(pair).ok()) else {
        return Err(wrong(Problem::Spread { key: name }));
    };
    within(key, first).map_err(wrong)?;
    if kind == "uniform" {
        within(key, second).map_err(wrong)?;
        if first >= second {
            return Err(wrong(Problem::Reversed { key: name, from: first, to: second }));
        }
        return Ok(Variation::Uniform { from: (key.to_si)(first), to: (key.to_si)(second) });
    }
    if second <= 0.0 {
        return Err(wrong(Problem::Deviation { key: name, value: second }));
    }
    within(key, second).map_err(wrong)?;
    Ok(Variation::Normal { mean: (key.to_si)(first), deviation: (key.to_si)(second) })
}

fn numbers(entries: &[Value]) -> Option<Vec<f64>> {
    entries
        .iter()
        .map(|entry| match entry {
            Value::Integer(number) => Some(*number as f64),
            Value::Float(number) => Some(*number),
            _ => None,
        })
        .collect()
}

fn within(key: &Key, value: f64) -> Result<(), Problem> {
    let (name, (min, max)) = (key.name, key.bounds);
    if !value.is_finite() {
        Err(Problem::NotFinite { key: name, value })
    } else if (min..=max).contains(&value) {
        Ok(())
    } else {
        Err(Problem::Beyond { key: name, value, min, max })
    }
}
