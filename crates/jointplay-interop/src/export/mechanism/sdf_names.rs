//! Names that SDF reserves.

use std::collections::BTreeSet;

use jointplay_core::mechanism::Mechanism;

use super::skeleton::{names, unused};

/// Name of the world as a link.
pub(super) const WORLD: &str = "world";

/// Whether SDF reserves a name: `::` separates those of nested models, and `__…__` are those of the format.
fn is_reserved(name: &str) -> bool {
    name.contains("::") || (name.len() >= 4 && name.starts_with("__") && name.ends_with("__"))
}

/// The mechanism with other names where SDF reserves its own, and what was renamed.
///
/// A link may be named as the world, which it is then.
pub(super) fn with_permitted_names(mechanism: &Mechanism) -> (Mechanism, Vec<String>) {
    let taken = names(mechanism).cloned().collect();
    let mut replaced = Replaced { taken, renamed: Vec::new() };
    let links = mechanism.links().iter().map(|name| replaced.permitted("link", name)).collect();
    let mut joints = mechanism.joints().to_vec();
    joints.iter_mut().for_each(|joint| joint.name = replaced.permitted("joint", &joint.name));
    let mut virtual_joints = mechanism.virtual_joints().to_vec();
    for joint in &mut virtual_joints {
        joint.name = replaced.permitted("virtual joint", &joint.name);
    }
    let mut frames = mechanism.frames().to_vec();
    frames.iter_mut().for_each(|frame| frame.name = replaced.permitted("frame", &frame.name));
    let renamed = Mechanism::new(replaced.permitted("model", mechanism.name()), links, joints)
        .and_then(|made| made.with_virtual_joints(virtual_joints))
        .and_then(|made| made.with_couplings(mechanism.couplings().to_vec()))
        .and_then(|made| made.with_frames(frames))
        .and_then(|made| match mechanism.characteristic_length() {
            Some(length) => made.with_characteristic_length(length),
            None => Ok(made),
        });
    let renamed = renamed.expect("a mechanism is valid with other names, each of which is unused");
    (renamed, replaced.renamed)
}

/// Names in place of those that SDF reserves.
struct Replaced {
    taken: BTreeSet<String>,
    renamed: Vec<String>,
}

impl Replaced {
    /// A name, or one in its place that SDF does not reserve.
    fn permitted(&mut self, what: &str, name: &str) -> String {
        let is_world = name == WORLD && what != "link";
        if !is_reserved(name) && !is_world {
            return name.to_owned();
        }
        let parts = name.split("::").map(|part| part.trim_matches('_'));
        let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
        let base = match parts.join("/") {
            base if base.is_empty() => what.to_owned(),
            base if base == WORLD => format!("{WORLD} {what}"),
            base => base,
        };
        let new = unused(base, |name| self.taken.contains(name));
        self.taken.insert(new.clone());
        self.renamed.push(format!("{what} {name:?} is named {new:?}: SDF reserves its name"));
        new
    }
}
