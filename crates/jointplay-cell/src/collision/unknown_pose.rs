//! Times at which poses are unknown.

use super::link_poses::Unplaced;
use crate::violation::{Found, Hit, Unit, When};

/// A time at which the poses of all that moves are unknown.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Lost {
    pub(crate) when: When,
    pub(crate) why: Unplaced,
}

impl Lost {
    /// Reports it.
    pub(crate) fn report(self, found: &mut Found) {
        let Self { when, why: Unplaced { kind, why } } = self;
        let (about, unit) = ((kind, 0, 0), Unit::None);
        let hit = Hit { about, kind, severity: 0.0, value: 0.0, limit: 0.0, unit };
        found.add(when, hit, || why);
    }
}
