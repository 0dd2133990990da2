//! Joints that close loops of an open chain, and couplings, from a loop closure file.

use jointplay_core::mechanism::{Coupling, Joint, Kinematics, Mechanism, MechanismError};
use jointplay_core::spatial::Pose;
use nalgebra::DVector;
use toml::de::DeValue;

use super::coupling::{NamedCoordinates, coupling};
use super::header::{MAX_BYTES, units};
use super::joint::{Links, joint};
use super::problem::{Errors, Problem};
use super::read::FALLBACK_UNITS;
use super::tree::{Entry, Table};
use super::values::Values;
use crate::toml_reader::{parameters, read_document};

/// The `kind` of a loop closure file.
const KIND: &str = "loops";

/// Closes loops of an open chain by the joints of a file, for formats such as URDF that have trees only.
///
/// Couplings may name joints of the chain and of the file.
/// A joint is placed on one of the links by `in`, or without it in the base frame, with all joint coordinates at zero; or on each of its links by `frames`.
///
/// # Errors
/// All errors in the order of their places in `text`: those of a mechanism file, links that the chain does not have, and a mechanism that already has loops.
///
/// # Example
/// ```
/// # let chain = jointplay_format::mechanism::parse(r#"
/// #     kind = "mechanism"
/// #     name = "pair"
/// #     units = { length = "mm", angle = "deg" }
/// #     base = "base"
/// #     joint = [
/// #         { name = "a", kind = "revolute", links = ["base", "left"], point = [0, 0, 0], axis = [0, 0, 1] },
/// #         { name = "b", kind = "revolute", links = ["base", "right"], point = [0, 0, 0], axis = [0, 0, 1] },
/// #     ]
/// # "#)?.mechanism;
/// let closed = jointplay_format::mechanism::with_loops(&chain, r#"
///     kind = "loops"
///     units = { length = "mm", angle = "deg" }
///     [[joint]]
///     name = "tips"
///     kind = "spherical"
///     links = ["left", "right"]
///     in = "left"
///     point = [0, 0, 100]
/// "#)?;
/// assert_eq!(closed.loops(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn with_loops(chain: &Mechanism, text: &str) -> Result<Mechanism, Errors> {
    read_document(text, MAX_BYTES, "a file of loops", |top| {
        if !top.reader.is_clean() || top.has_other_kind(KIND) {
            return None;
        }
        if chain.loops() > 0 {
            top.report_at("kind", Problem::HasLoops { found: chain.loops() });
            return None;
        }
        let closed = closed(chain, top);
        top.finish();
        closed
    })
}

fn closed(chain: &Mechanism, top: &Table) -> Option<Mechanism> {
    let reader = top.reader;
    let units = units(top).unwrap_or(FALLBACK_UNITS);
    let scope = parameters::resolve(top, &[], units.angle).scope;
    let values = Values { reader, units, scope };
    let base_from_link = Kinematics::new(chain)
        .link_poses(&DVector::zeros(chain.joint_freedoms() + chain.virtual_joints().len()))
        .expect("zeros are finite, and as many as there are coordinates");
    let chain_links = ChainLinks { base_from_link, links: Links::of(chain.links()) };
    let mut links = chain_links.links.clone();
    let mut tables = top.tables("joint");
    let has_couplings = top.entry("coupling").is_some();
    if tables.is_empty() && !has_couplings {
        top.needed("joint");
    }
    let added: Vec<Option<Joint>> = tables
        .iter_mut()
        .map(|table| closing_joint(&values, table, &chain_links, &mut links))
        .collect();
    let of_chain = chain.joints().iter().cloned().map(Some);
    let joints: Vec<Option<Joint>> = of_chain.chain(added).collect();
    let named_coordinates = NamedCoordinates::new(&joints);
    let mut coupling_tables = top.tables("coupling");
    let couplings: Vec<_> = coupling_tables
        .iter_mut()
        .map(|table| coupling(&values, table, &named_coordinates))
        .collect();
    let joints = joints.into_iter().collect::<Option<Vec<Joint>>>()?;
    let couplings = couplings.into_iter().collect::<Option<Vec<Coupling>>>()?;
    let couplings = chain.couplings().iter().cloned().chain(couplings).collect();
    tables.extend(coupling_tables);
    let closed = chain.clone().with_joints(joints);
    let result = closed.and_then(|closed| closed.with_couplings(couplings));
    result.map_err(|error| report(top, &tables, error)).ok()
}

/// The links of an open chain at zero coordinates.
struct ChainLinks {
    base_from_link: Vec<Pose>,
    links: Links,
}

/// A joint that closes a loop, with its frames on its links.
fn closing_joint(
    values: &Values,
    table: &mut Table,
    chain: &ChainLinks,
    links: &mut Links,
) -> Option<Joint> {
    let are_known = are_links_known(values, table, chain);
    let placing_link = table.entry("in").map(|entry| {
        if table.entry("frames").is_some() {
            let why = "`frames` places this joint on each of its links already".to_owned();
            entry.report(values.reader, Problem::Misplaced { key: "in", why });
            return None;
        }
        let name = entry.text(values.reader)?;
        is_link_known(values, &entry, chain).then(|| name.to_owned())
    });
    let mut joint = joint(values, table, links)?;
    if !are_known {
        return None;
    }
    if table.entry("frames").is_none() {
        let mut base_from = Pose::identity();
        if let Some(link) = placing_link {
            base_from = chain.base_from_link[links.index(&link?)];
        }
        let base_from_joint = base_from * joint.frames[0];
        let frame = |link: usize| chain.base_from_link[link].inverse() * base_from_joint;
        joint.frames = joint.links.map(frame);
    }
    Some(joint)
}

/// Whether the chain has all links that a joint names; unknown ones are reported.
fn are_links_known(values: &Values, table: &Table, chain: &ChainLinks) -> bool {
    let Some(DeValue::Array(list)) = table.entry("links").map(|entry| entry.value.get_ref()) else {
        return true;
    };
    let entries = list.iter().map(|value| Entry { key: "links", value });
    // All are looked up, so that each unknown one is reported.
    entries.filter(|entry| !is_link_known(values, entry, chain)).count() == 0
}

fn is_link_known(values: &Values, entry: &Entry, chain: &ChainLinks) -> bool {
    let Some(name) = entry.value.get_ref().as_str() else { return true };
    let is_known = chain.links.has(name);
    if !is_known {
        entry.unknown(values.reader, "link", name, &chain.links.names);
    }
    is_known
}

/// Reports an error of the closed mechanism at the joint or coupling that it is about.
fn report(top: &Table, tables: &[Table], error: MechanismError) {
    use MechanismError as E;
    let about = match &error {
        E::NameTwice { name }
        | E::CoupledRotation { coupling: name, .. }
        | E::CoupledTwice { coupling: name, .. }
        | E::CoupledMany { coupling: name, .. }
        | E::JoinedToItself { joint: name, .. }
        | E::NotFinite { name, .. } => {
            let names = tables.iter().rev().filter_map(|table| table.entry("name"));
            names.into_iter().find(|entry| entry.value.get_ref().as_str() == Some(name))
        }
        _ => None,
    };
    match about {
        Some(entry) => entry.report(top.reader, error),
        None => top.report_at("kind", error),
    }
}
