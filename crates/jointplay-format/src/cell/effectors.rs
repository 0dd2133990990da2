//! Effectors by name.

use std::collections::BTreeMap;

use jointplay_cell::robot::{EffectorId, HybridRobot};

use super::problem::Fault;
use super::tree::{Entry, Reader};

/// Effectors by name, in the order of arms.
pub(super) type Effectors = Vec<(String, EffectorId)>;

pub(super) fn effectors(robot: &HybridRobot) -> Effectors {
    let of_arm = |(arm, one): (usize, &jointplay_cell::robot::Arm)| {
        let id = move |(effector, named): (usize, &jointplay_cell::robot::Effector)| {
            (named.name.clone(), EffectorId { arm, effector })
        };
        one.effectors.iter().enumerate().map(id).collect::<Vec<_>>()
    };
    robot.arms.iter().enumerate().flat_map(of_arm).collect()
}

/// The effectors of a list of names; all effectors, if the key is absent.
pub(super) fn named_effectors(
    entry: &Entry,
    reader: &Reader,
    known: &Effectors,
) -> Vec<EffectorId> {
    let names: Vec<String> = known.iter().map(|(name, _)| name.clone()).collect();
    let mut seen = BTreeMap::new();
    let of = |entry: Entry| {
        let name = entry.text(reader)?;
        let Some((_, id)) = known.iter().find(|(known, _)| known == name) else {
            entry.unknown(reader, "effector", name, &names);
            return None;
        };
        if let Some(first) = seen.insert(name.to_owned(), reader.line(entry.span())) {
            let (what, found) = ("effector".to_owned(), name.to_owned());
            entry.report(reader, Fault::Twice { what, found, first });
        }
        Some(*id)
    };
    entry.list(reader).unwrap_or_default().into_iter().filter_map(of).collect()
}
