//! Codes of a controller for the names of a cell.

use std::collections::{BTreeMap, BTreeSet};

use jointplay_format::place::{Error, Place, listed, nearest};

use super::format_spec::{Kind, Value};
use super::problem::Problem;
use super::tree::Table;

/// Codes by name.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Codes {
    table: &'static str,
    place: Place,
    pub(crate) kind: Kind,
    values: BTreeMap<String, Value>,
}

impl Codes {
    /// The codes of a table of the file, if present.
    pub(crate) fn read(top: &Table<'_, '_>, key: &'static str) -> Option<Self> {
        let reader = top.reader;
        let table = top.table(key, format!("`[{key}]`"))?;
        let mut values = BTreeMap::new();
        for (entry, _) in table.entries() {
            let value = match entry.is_text() {
                true => entry.line(reader).map(|text| Value::Text(text.to_owned())),
                false => entry.integer(reader).map(Value::Integer),
            };
            values.extend(value.map(|value| (entry.key.to_owned(), value)));
        }
        let texts = values.values().filter(|value| matches!(value, Value::Text(_))).count();
        if texts > 0 && texts < values.len() {
            table.report(Problem::MixedCodes { table: key });
        }
        let kind = if texts > 0 { Kind::Text } else { Kind::Integer };
        Some(Self { table: key, place: reader.place(table.span.clone()), kind, values })
    }

    /// The code of a name; checked by [`Self::missing`].
    pub(crate) fn code(&self, name: &str) -> Value {
        self.values.get(name).cloned().unwrap_or(Value::Text(String::new()))
    }

    /// The codes as texts, each with its name.
    pub(crate) fn texts(&self) -> Vec<(String, &str)> {
        let text = |value: &Value| match value {
            Value::Text(text) => text.clone(),
            Value::Integer(number) => number.to_string(),
            Value::Real(number) => number.to_string(),
        };
        self.values.iter().map(|(name, value)| (text(value), name.as_str())).collect()
    }

    /// The errors of names without a code.
    pub(crate) fn missing<'n>(
        &self,
        names: impl Iterator<Item = &'n str>,
    ) -> impl Iterator<Item = Error<Problem>> {
        let without_code = |name: &&str| !self.values.contains_key(*name);
        let missing: BTreeSet<&str> = names.filter(without_code).collect();
        missing.into_iter().map(|name| {
            let known: Vec<String> = self.values.keys().cloned().collect();
            let problem = Problem::NoCode {
                table: self.table,
                name: name.to_owned(),
                nearest: nearest(name, known.iter().map(String::as_str)),
                known: listed(&known),
            };
            Error { place: self.place.clone(), problem: Box::new(problem) }
        })
    }
}
