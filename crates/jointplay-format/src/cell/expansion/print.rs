//! The expanded document as text.

use std::borrow::Cow;
use std::fmt::Write;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::super::tree::Reader;
use super::document::Value;

/// A document as TOML, with the values of its expressions, keys and tables in the order of their positions.
pub(in super::super) fn print<'a>(document: &DeTable<'a>, reader: &Reader<'a>) -> String {
    let mut text = String::new();
    let (tables, values): (Vec<_>, Vec<_>) =
        sorted(document).into_iter().partition(|(_, value)| is_table(value));
    for (key, value) in values {
        let _ = writeln!(text, "{} = {}", quoted_key(key.get_ref()), inline(value, reader));
    }
    for (key, value) in tables {
        let key = quoted_key(key.get_ref());
        match value.get_ref() {
            DeValue::Table(table) => section(&mut text, &format!("[{key}]"), table, reader),
            DeValue::Array(list) => {
                let tables = list.iter().filter_map(|value| value.get_ref().as_table());
                tables.for_each(|table| section(&mut text, &format!("[[{key}]]"), table, reader));
            }
            _ => {}
        }
    }
    text
}

fn section<'a>(text: &mut String, heading: &str, table: &DeTable<'a>, reader: &Reader<'a>) {
    let _ = writeln!(text, "\n{heading}");
    for (key, value) in sorted(table) {
        let _ = writeln!(text, "{} = {}", quoted_key(key.get_ref()), inline(value, reader));
    }
}

/// Whether a value is a table, or a list of tables only.
fn is_table(value: &Value) -> bool {
    match value.get_ref() {
        DeValue::Table(_) => true,
        DeValue::Array(list) => {
            !list.is_empty() && list.iter().all(|value| value.get_ref().is_table())
        }
        _ => false,
    }
}

/// Keys and values in the order of the file, the name first.
fn sorted<'t, 'a>(table: &'t DeTable<'a>) -> Vec<(&'t Spanned<Cow<'a, str>>, &'t Value<'a>)> {
    let mut sorted: Vec<_> = table.iter().collect();
    sorted.sort_by_key(|(key, value)| (key.get_ref() != "name", value.span().start));
    sorted
}

fn inline<'a>(value: &Value<'a>, reader: &Reader<'a>) -> String {
    let listed = |parts: Vec<String>| parts.join(", ");
    match value.get_ref() {
        DeValue::String(text) => match reader.evaluated(value.span().start) {
            Some(number) => decimal(number),
            None => quoted(text),
        },
        DeValue::Integer(number) => number.to_string(),
        DeValue::Float(number) => number.to_string(),
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Datetime(value) => value.to_string(),
        DeValue::Array(list) => {
            format!("[{}]", listed(list.iter().map(|value| inline(value, reader)).collect()))
        }
        DeValue::Table(table) => {
            let pairs = sorted(table).into_iter().map(|(key, value)| {
                format!("{} = {}", quoted_key(key.get_ref()), inline(value, reader))
            });
            format!("{{ {} }}", listed(pairs.collect()))
        }
    }
}

/// A finite number as TOML, which reads as the same number.
fn decimal(number: f64) -> String {
    // Whole numbers without a fraction, for counts have none.
    format!("{number}")
}

fn quoted_key(key: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
    if !key.is_empty() && key.chars().all(is_bare) { key.to_owned() } else { quoted(key) }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
