//! Lists of tables, copied with other positions.

use std::borrow::Cow;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value with its position.
pub(super) type Value<'a> = Spanned<DeValue<'a>>;

/// A table of a list, with its position.
#[derive(Clone)]
pub(super) struct Node<'a> {
    pub(super) span: Range<usize>,
    pub(super) table: DeTable<'a>,
}

impl<'a> Node<'a> {
    /// The text of a key, if it is one.
    pub(super) fn text(&self, key: &str) -> Option<&str> {
        self.table.get(key)?.get_ref().as_str()
    }

    /// The node with all positions moved by an offset.
    pub(super) fn moved(&self, by: usize) -> Self {
        Self { span: moved_span(&self.span, by), table: moved_table(&self.table, by) }
    }

    /// Sets a key to a text, at a position.
    pub(super) fn set_text(&mut self, key: &'static str, text: String, span: Range<usize>) {
        self.set(key, Spanned::new(span, DeValue::String(Cow::Owned(text))));
    }

    /// Sets a key.
    pub(super) fn set(&mut self, key: &'static str, value: Value<'a>) {
        // An existing key would keep its position.
        self.table.remove(key);
        self.table.insert(Spanned::new(value.span(), Cow::Borrowed(key)), value);
    }

    fn into_value(self) -> Value<'a> {
        Spanned::new(self.span, DeValue::Table(self.table))
    }
}

fn moved_span(span: &Range<usize>, by: usize) -> Range<usize> {
    span.start + by..span.end + by
}

/// A table with all positions moved by an offset.
pub(super) fn moved_table<'a>(table: &DeTable<'a>, by: usize) -> DeTable<'a> {
    let moved = |(key, value): (&Spanned<Cow<'a, str>>, &Value<'a>)| {
        let key = Spanned::new(moved_span(&key.span(), by), key.get_ref().clone());
        (key, moved_value(value, by))
    };
    table.iter().map(moved).collect()
}

/// A value with all positions moved by an offset.
pub(super) fn moved_value<'a>(value: &Value<'a>, by: usize) -> Value<'a> {
    let moved = match value.get_ref() {
        DeValue::Array(list) => {
            DeValue::Array(list.iter().map(|value| moved_value(value, by)).collect())
        }
        DeValue::Table(table) => DeValue::Table(moved_table(table, by)),
        other => other.clone(),
    };
    Spanned::new(moved_span(&value.span(), by), moved)
}

/// Removes the tables of `[[key]]` from a document; a value of another type remains, for its reader reports it.
pub(super) fn take_list<'a>(document: &mut DeTable<'a>, key: &str) -> Vec<Node<'a>> {
    let is_list = |value: &Value<'a>| {
        let list = value.get_ref().as_array();
        list.is_some_and(|list| list.iter().all(|value| value.get_ref().is_table()))
    };
    if !document.get(key).is_some_and(is_list) {
        return Vec::new();
    }
    let Some(DeValue::Array(list)) = document.remove(key).map(Spanned::into_inner) else {
        return Vec::new();
    };
    let node = |value: Value<'a>| {
        let span = value.span();
        match value.into_inner() {
            DeValue::Table(table) => Some(Node { span, table }),
            _ => None,
        }
    };
    list.into_iter().filter_map(node).collect()
}

/// Sets the tables of `[[key]]`; none where there are none.
pub(super) fn set_list<'a>(document: &mut DeTable<'a>, key: &'static str, nodes: Vec<Node<'a>>) {
    let Some(first) = nodes.first() else { return };
    let span = first.span.clone();
    let list = nodes.into_iter().map(Node::into_value).collect();
    let key = Spanned::new(span.clone(), Cow::Borrowed(key));
    document.insert(key, Spanned::new(span, DeValue::Array(list)));
}
