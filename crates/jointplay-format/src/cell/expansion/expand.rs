//! From a document to its expansion.

use toml::de::DeTable;

use super::super::tree::Reader;
use super::contacts;
use super::document::{set_list, take_list};
use super::groups::Groups;
use super::inheritance::inherit;
use super::library::Library;
use super::lists::Lists;
use super::part::Parts;
use super::pattern::repeat;

/// The document without templates, patterns and parts.
///
/// # Arguments
/// * `library` – texts of all parts that the document names
pub(in super::super) fn expand<'a>(
    reader: &Reader<'a>,
    document: &DeTable<'a>,
    library: &'a Library,
) -> DeTable<'a> {
    let mut document = document.clone();
    document.remove("parameters");
    let templates = take_list(&mut document, "template");
    let mut groups = Groups::default();
    let lists = Lists::take(reader, &mut document, &templates, &mut groups);
    let instances = inherit(reader, "part", take_list(&mut document, "part"), &templates);
    let instances = repeat(reader, instances, &mut groups);
    let mut parts = Parts { reader, library, lists, groups, contacts: Vec::new() };
    for instance in &instances {
        parts.add(instance);
    }
    let Parts { lists, groups, contacts: pairs, .. } = parts;
    contacts::append(&mut document, pairs);
    contacts::expand_groups(&mut document, &lists.bodies, &groups);
    let Lists { frames, stations, bodies, zones } = lists;
    set_list(&mut document, "frame", frames);
    set_list(&mut document, "station", stations);
    set_list(&mut document, "body", bodies);
    set_list(&mut document, "zone", zones);
    document
}
