//! Clearance rules: the required distance of each pair of collision objects.

use super::object::{Parent, Role};
use super::scene::Scene;
use crate::incremental::{CacheKey, CacheKeyPart};
use crate::program::{Handoff, Path, Phase, Step};
use crate::robot::EffectorId;

/// Required distance of two collision objects during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ClearanceRule {
    /// The pair is not checked.
    Unchecked,
    /// Minimum clearance (m).
    MinClearance(f64),
    /// Minimum clearance at the slots of a station (m).
    SlotClearance(f64),
    /// No penetration of a keep-out zone.
    KeepOut,
}

impl CacheKeyPart for ClearanceRule {
    fn append_to(&self, cache_key: &mut CacheKey) {
        cache_key.add(&match *self {
            Self::Unchecked => (0_u64, 0.0),
            Self::MinClearance(limit) => (1, limit),
            Self::SlotClearance(limit) => (2, limit),
            Self::KeepOut => (3, 0.0),
        });
    }
}

/// Effector that a step moves along a line, or that takes part in its hand-off.
pub(crate) fn acting_effector(step: &Step) -> Option<EffectorId> {
    match (step.path, step.handoff) {
        (Path::Line(id), _) => Some(id),
        (_, Some(Handoff::Picked(id, _) | Handoff::Placed(id, _))) => Some(id),
        _ => None,
    }
}

impl Scene<'_> {
    /// Clearance rule of two objects, independent of the step.
    ///
    /// Not checked are objects on one body or on two bodies that a joint connects, pairs that the cell allows, and a wafer with the link that holds it.
    pub(crate) fn general_clearance_rule(&self, a: usize, b: usize) -> ClearanceRule {
        let (first, second) = (&self.objects[a], &self.objects[b]);
        if !(first.parent.moves() || second.parent.moves()) || self.are_adjacent(a, b) {
            return ClearanceRule::Unchecked;
        }
        if let (Role::Body(i), Role::Body(j)) = (first.role, second.role) {
            let allowed = &self.cell.allowed_pairs;
            if allowed.contains(&[i, j]) || allowed.contains(&[j, i]) {
                return ClearanceRule::Unchecked;
            }
        }
        if first.role == Role::KeepOut || second.role == Role::KeepOut {
            return ClearanceRule::KeepOut;
        }
        ClearanceRule::MinClearance(self.cell.clearance)
    }

    /// Clearance rule of a moving and a fixed object during a step.
    ///
    /// While a step is in a slot, the end effector and its wafer must satisfy the slot clearance to the wafers of that station, and the lesser of slot clearance and general clearance to all fixed objects.
    /// The wafers of the station need more, by the uncertainty of its frame: see [`Cell::slot_margins`](crate::workcell::Cell::slot_margins).
    /// During lift and lower, the last link may touch the wafer of that slot.
    pub(crate) fn clearance_rule(&self, mover: usize, fixed: usize, step: &Step) -> ClearanceRule {
        let general = self.general_clearance_rule(mover, fixed);
        let (ClearanceRule::MinClearance(_), Some(slot), Some(id)) =
            (general, step.slot, acting_effector(step))
        else {
            return general;
        };
        let [inside, other] = [mover, fixed].map(|object| self.objects[object].parent);
        if inside != Parent::Effector(id) && !holds(inside, id) {
            return general;
        }
        let lesser = self.cell.slot_clearance.min(self.cell.clearance);
        match other {
            Parent::Slot(there) if there == slot => {
                let is_handoff = matches!(step.phase, Phase::Lift | Phase::Lower);
                if is_handoff {
                    ClearanceRule::Unchecked
                } else {
                    ClearanceRule::SlotClearance(lesser + self.slot_margin(there))
                }
            }
            Parent::Slot(there) if there.station == slot.station => {
                ClearanceRule::SlotClearance(self.cell.slot_clearance + self.slot_margin(there))
            }
            _ => ClearanceRule::MinClearance(lesser),
        }
    }

    /// Whether two objects are on one body, on two that a joint connects, or one holds the other.
    fn are_adjacent(&self, a: usize, b: usize) -> bool {
        let (a, b) = (self.objects[a].parent, self.objects[b].parent);
        let linked = |x: Parent, y: Parent| match (x, y) {
            (Parent::Platform, Parent::Link { link: 0, .. }) => true,
            (Parent::Platform, Parent::DeflectedLastLink(id)) => self.last_link(id.arm) == 0,
            (Parent::Link { arm, link }, Parent::Link { arm: other, link: next }) => {
                arm == other && link + 1 == next
            }
            (Parent::Link { arm, link }, Parent::DeflectedLastLink(id)) => {
                arm == id.arm && link + 1 == self.last_link(arm)
            }
            (Parent::DeflectedLastLink(one), Parent::DeflectedLastLink(other)) => {
                one.arm == other.arm
            }
            (link, Parent::Effector(id)) => holds(link, id),
            _ => false,
        };
        a == b || linked(a, b) || linked(b, a)
    }
}

/// Whether a parent is the last link of the arm of an effector.
fn holds(link: Parent, id: EffectorId) -> bool {
    matches!(link, Parent::DeflectedLastLink(tip) if tip.arm == id.arm)
}
