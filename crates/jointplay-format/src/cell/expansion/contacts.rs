//! Allowed contacts of groups of bodies.

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use super::document::{Node, Value};
use super::groups::Groups;

/// Replaces each pair of `may_touch` with the name of a group by the pairs of its bodies.
pub(super) fn expand_groups<'a>(document: &mut DeTable<'a>, bodies: &[Node<'a>], groups: &Groups) {
    let Some(value) = document.get_mut("may_touch") else { return };
    let DeValue::Array(list) = value.get_mut() else { return };
    let is_body = |name: &str| bodies.iter().any(|body| body.text("name") == Some(name));
    let members = |value: &Value<'a>| -> Vec<Value<'a>> {
        let members = value.get_ref().as_str().filter(|name| !is_body(name));
        let members = members.and_then(|name| groups.members(name));
        let Some(members) = members else { return vec![value.clone()] };
        let members = members.iter().filter(|name| is_body(name));
        let named =
            |name: &String| Spanned::new(value.span(), DeValue::String(name.clone().into()));
        members.map(named).collect()
    };
    let pairs = |pair: &Value<'a>| -> Vec<Value<'a>> {
        let Some([one, other]) = pair.get_ref().as_array().map(AsRef::as_ref) else {
            return vec![pair.clone()];
        };
        let (ones, others) = (members(one), members(other));
        let pairs = ones.iter().flat_map(|one| others.iter().map(move |other| [one, other]));
        let value = |two: [&Value<'a>; 2]| {
            let list: DeArray<'a> = two.into_iter().cloned().collect();
            Spanned::new(pair.span(), DeValue::Array(list))
        };
        pairs.map(value).collect()
    };
    *list = list.iter().flat_map(pairs).collect();
}

/// Adds pairs to `may_touch`.
pub(super) fn append<'a>(document: &mut DeTable<'a>, pairs: Vec<Value<'a>>) {
    let Some(first) = pairs.first() else { return };
    match document.get_mut("may_touch").map(Spanned::get_mut) {
        Some(DeValue::Array(list)) => pairs.into_iter().for_each(|pair| list.push(pair)),
        // A value of another type is reported where contacts are read.
        Some(_) => {}
        None => {
            let key = Spanned::new(first.span(), "may_touch".into());
            let span = first.span();
            document.insert(key, Spanned::new(span, DeValue::Array(pairs.into_iter().collect())));
        }
    }
}
