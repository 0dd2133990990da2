//! Allowed contacts in the text of a cell file.

use std::collections::BTreeMap;

use toml_edit::{Array, DocumentMut, Item, Value};

use super::lists;

const KEY: &str = "may_touch";

/// Adds pairs of bodies.
pub(super) fn add(document: &mut DocumentMut, pairs: &[[String; 2]]) {
    if pairs.is_empty() {
        return;
    }
    let list = document.entry(KEY).or_insert_with(|| Item::Value(Value::Array(Array::new())));
    let Some(list) = list.as_array_mut() else { return };
    for pair in pairs {
        let pair: Array = pair.iter().map(String::as_str).collect();
        lists::insert(list, list.len(), Value::Array(pair));
    }
}

/// Adds each pair of duplicated bodies under their new names.
pub(super) fn duplicate(document: &mut DocumentMut, renamed: &BTreeMap<String, String>) {
    let new_name = |name: &Value| renamed.get(name.as_str()?).cloned();
    let pairs = document.get(KEY).and_then(Item::as_array).into_iter().flat_map(Array::iter);
    let pairs = pairs.filter_map(|pair| {
        let pair = pair.as_array()?;
        Some([new_name(pair.get(0)?)?, new_name(pair.get(1)?)?])
    });
    let pairs: Vec<_> = pairs.collect();
    add(document, &pairs);
}

/// Removes all pairs with one of these names.
pub(super) fn remove(document: &mut DocumentMut, names: &[&str]) {
    let Some(list) = document.get_mut(KEY).and_then(Item::as_array_mut) else { return };
    let is_named = |one: &Value| one.as_str().is_some_and(|one| names.contains(&one));
    let is_removed = |pair: &Value| pair.as_array().is_some_and(|pair| pair.iter().any(is_named));
    let removed: Vec<usize> =
        (0..list.len()).filter(|&index| list.get(index).is_some_and(is_removed)).collect();
    for &index in removed.iter().rev() {
        lists::remove_value(list, index);
    }
    if list.is_empty() && !removed.is_empty() {
        document.remove(KEY);
    }
}
