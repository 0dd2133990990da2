//! Names of bodies that patterns and parts generate.

use std::collections::BTreeMap;

use super::super::problem::Fault;

/// Largest number of tables that patterns and parts generate.
const MAX_GENERATED: usize = 4000;

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
