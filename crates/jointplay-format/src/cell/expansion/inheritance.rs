//! Tables that take the keys of another one: `like = "LP1"`.

use std::collections::BTreeMap;

use toml::de::DeTable;

use super::super::problem::Fault;
use super::super::tree::{Entry, Reader};
use super::document::Node;

/// Keys that no table takes from another one.
const OWN_KEYS: [&str; 3] = ["name", "like", "repeat"];

/// Shapes, of which a body has one.
const SHAPES: [&str; 5] = ["box", "cylinder", "capsule", "convex", "mesh"];

/// The tables of one kind, with the keys that they take from others of their kind or from templates.
///
/// # Arguments
/// * `kind` – the key of the tables, for messages
pub(super) fn inherit<'a>(
    reader: &Reader<'a>,
    kind: &str,
    nodes: Vec<Node<'a>>,
    templates: &[Node<'a>],
) -> Vec<Node<'a>> {
    if nodes.iter().all(|node| !node.table.contains_key("like")) {
        return nodes;
    }
    let mut originals: BTreeMap<&str, &Node<'a>> = BTreeMap::new();
    // The first of several tables with one name; the others are reported where names are read.
    for node in nodes.iter().chain(templates) {
        if let Some(name) = node.text("name") {
            originals.entry(name).or_insert(node);
        }
    }
    nodes.iter().map(|node| whole(reader, kind, node, &originals)).collect()
}

fn whole<'a>(
    reader: &Reader<'a>,
    kind: &str,
    node: &Node<'a>,
    originals: &BTreeMap<&str, &Node<'a>>,
) -> Node<'a> {
    let mut found = node.clone();
    let mut chain: Vec<&str> = node.text("name").into_iter().collect();
    let mut last = node;
    while let Some(value) = last.table.get("like") {
        let entry = Entry { key: "like", value };
        let Some(name) = value.get_ref().as_str() else {
            entry.type_error(reader, "the name of another table");
            break;
        };
        let Some(original) = originals.get(name) else {
            let names: Vec<String> = originals.keys().map(|&name| name.to_owned()).collect();
            entry.unknown(reader, &format!("{kind} or template"), name, &names);
            break;
        };
        if chain.contains(&name) {
            let circle = [chain.as_slice(), &[name]].concat().join(" → ");
            let why = format!("`like` leads back to its own table: {circle}");
            entry.report(reader, Fault::Unfit(why));
            break;
        }
        chain.push(name);
        take_keys(&mut found.table, &original.table);
        last = original;
    }
    found.table.remove("like");
    found
}

/// Adds the keys of a table that another one neither has nor replaces.
pub(super) fn take_keys<'a>(own: &mut DeTable<'a>, original: &DeTable<'a>) {
    let has_points = |table: &DeTable| {
        let taught = table.get("taught").and_then(|taught| taught.get_ref().as_table());
        taught.is_some_and(|taught| taught.contains_key("points_mm"))
    };
    let plane = [has_points(own), has_points(original)];
    let mut taken = Vec::new();
    for (key, value) in original {
        let name: &str = key.get_ref();
        if !is_replaced(name, &|key| own.contains_key(key), plane) {
            taken.push((key.clone(), value.clone()));
        }
    }
    own.extend(taken);
}

/// Whether a table has or replaces a key of the original.
///
/// # Arguments
/// * `has` – whether the table has a key
/// * `plane` – whether the taught points of the table, and of the original, determine a plane
pub(in super::super) fn is_replaced(
    key: &str,
    has: &dyn Fn(&str) -> bool,
    plane: [bool; 2],
) -> bool {
    let [own_plane, original_plane] = plane;
    has(key)
        || OWN_KEYS.contains(&key)
        || match key {
            "tilt" => (has("taught") && own_plane) || has("carrier_axis"),
            "taught" => (has("tilt") && original_plane) || has("carrier_axis"),
            "carrier_axis" => ["position_mm", "tilt", "taught"].into_iter().any(has),
            "position_mm" => has("carrier_axis"),
            _ => SHAPES.contains(&key) && SHAPES.into_iter().any(has),
        }
}
