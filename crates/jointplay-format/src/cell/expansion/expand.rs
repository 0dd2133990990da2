//! From a document to its expansion.

use std::collections::BTreeMap;

use toml::de::DeTable;

use super::super::problem::Fault;
use super::super::tree::Reader;
use super::contacts;
use super::document::{Node, set_list, take_list};
use super::inheritance::inherit;
use super::library::Library;
use super::part::Parts;
use super::pattern::repeat;

/// Largest number of tables that patterns and parts generate.
const MAX_GENERATED: usize = 4000;

/// Kinds of tables that patterns and parts generate.
#[derive(Default)]
pub(super) struct Lists<'a> {
    pub(super) frames: Vec<Node<'a>>,
    pub(super) stations: Vec<Node<'a>>,
    pub(super) bodies: Vec<Node<'a>>,
    pub(super) zones: Vec<Node<'a>>,
}

/// Names of bodies by the name of the pattern or part that they belong to.
#[derive(Default)]
pub(super) struct Groups {
    members: BTreeMap<String, Vec<String>>,
    generated: usize,
}

impl Groups {
    /// Adds a member of a group.
    pub(super) fn add(&mut self, group: &str, member: &str) {
        self.members.entry(group.to_owned()).or_default().push(member.to_owned());
    }

    /// Names of the members of a group, also of groups in it.
    pub(super) fn members(&self, group: &str) -> Option<Vec<String>> {
        let direct = self.members.get(group)?;
        let nested = |name: &String| match self.members.get(name) {
            Some(members) if name != group => members.clone(),
            _ => vec![name.clone()],
        };
        Some(direct.iter().flat_map(nested).collect())
    }

    /// Adds all groups to others, with other names.
    pub(super) fn add_prefixed(self, to: &mut Self, rename: &dyn Fn(&str) -> String) {
        for (group, members) in self.members {
            for member in members {
                to.add(&rename(&group), &rename(&member));
            }
        }
    }

    /// Counts generated tables; false beyond the limit.
    pub(super) fn add_copies(&mut self, count: usize) -> bool {
        self.generated += count;
        self.generated <= MAX_GENERATED
    }

    /// The problem of too many generated tables.
    pub(super) fn too_many() -> Fault {
        Fault::Unfit(format!(
            "patterns and parts generate more than {MAX_GENERATED} tables: reduce `count`"
        ))
    }
}

impl<'a> Lists<'a> {
    /// Takes the tables of a document, with the keys of their templates, and repeated.
    pub(super) fn take(
        reader: &Reader<'a>,
        document: &mut DeTable<'a>,
        templates: &[Node<'a>],
        groups: &mut Groups,
    ) -> Self {
        let mut take = |kind: &str| {
            let nodes = inherit(reader, kind, take_list(document, kind), templates);
            repeat(reader, nodes, groups)
        };
        Self {
            frames: take("frame"),
            stations: take("station"),
            bodies: take("body"),
            zones: take("zone"),
        }
    }
}

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
