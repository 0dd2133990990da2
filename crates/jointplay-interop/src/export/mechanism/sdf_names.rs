//! Names that models of Gazebo reserve.

use std::collections::BTreeSet;

use jointplay_core::mechanism::Mechanism;

/// Whether SDF reserves a name: `::` separates those of nested models, and `__…__` are those of the format.
fn is_reserved(name: &str) -> bool {
    name.contains("::") || (name.len() >= 4 && name.starts_with("__") && name.ends_with("__"))
}

/// The mechanism with other names where SDF reserves its own, and what was renamed; `None` where it reserves none.
pub(super) fn with_permitted_names(mechanism: &Mechanism) -> Option<(Mechanism, Vec<String>)> {
    let mut names = Names { taken: all_names(mechanism), renamed: Vec::new() };
    if !is_reserved(mechanism.name()) && !names.taken.iter().any(|name| is_reserved(name)) {
        return None;
    }
    let links = mechanism.links().iter().map(|name| names.permitted("link", name)).collect();
    let mut joints = mechanism.joints().to_vec();
    joints.iter_mut().for_each(|joint| joint.name = names.permitted("joint", &joint.name));
    let mut virtual_joints = mechanism.virtual_joints().to_vec();
    for joint in &mut virtual_joints {
        joint.name = names.permitted("virtual joint", &joint.name);
    }
    let mut frames = mechanism.frames().to_vec();
    frames.iter_mut().for_each(|frame| frame.name = names.permitted("frame", &frame.name));
    let renamed = Mechanism::new(names.permitted("model", mechanism.name()), links, joints)
        .and_then(|made| made.with_virtual_joints(virtual_joints))
        .and_then(|made| made.with_couplings(mechanism.couplings().to_vec()))
        .and_then(|made| made.with_frames(frames))
        .and_then(|made| match mechanism.characteristic_length() {
            Some(length) => made.with_characteristic_length(length),
            None => Ok(made),
        });
    let renamed = renamed.expect("a mechanism is valid with other names, each of which is unique");
    Some((renamed, names.renamed))
}

fn all_names(mechanism: &Mechanism) -> BTreeSet<String> {
    let joints = mechanism.joints().iter().map(|joint| &joint.name);
    let virtual_joints = mechanism.virtual_joints().iter().map(|joint| &joint.name);
    let frames = mechanism.frames().iter().map(|frame| &frame.name);
    let couplings = mechanism.couplings().iter().map(|coupling| &coupling.name);
    let links = mechanism.links().iter();
    links.chain(joints).chain(virtual_joints).chain(frames).chain(couplings).cloned().collect()
}

struct Names {
    taken: BTreeSet<String>,
    renamed: Vec<String>,
}

impl Names {
    /// A name, or one in its place that SDF does not reserve.
    fn permitted(&mut self, what: &str, name: &str) -> String {
        if !is_reserved(name) {
            return name.to_owned();
        }
        let parts = name.split("::").map(|part| part.trim_matches('_'));
        let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
        let base = if parts.is_empty() { what.to_owned() } else { parts.join("/") };
        let numbered = (2..).map(|number| format!("{base} ({number})"));
        let mut names = std::iter::once(base.clone()).chain(numbered);
        let new = names.find(|name| !self.taken.contains(name)).expect("names are finitely many");
        self.taken.insert(new.clone());
        self.renamed.push(format!("{what} {name:?} is named {new:?}: SDF reserves its name"));
        new
    }
}
