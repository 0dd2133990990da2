//! What is required of the distance of each pair of collision objects.

use super::object::{Holder, Role};
use super::scene::Scene;
use crate::incremental::{Fingerprint, Fingerprinted};
use crate::program::{Handover, Path, Phase, Step};
use crate::robot::EffectorId;

/// What is asked of the distance of two items during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Rule {
    /// Nothing.
    Free,
    /// Not to touch, and to stay this far apart [m].
    Apart(f64),
    /// As before, asked for by the slots of a station.
    Slots(f64),
    /// Not to enter.
    Out,
}

impl Fingerprinted for Rule {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        fingerprint.add(&match *self {
            Self::Free => (0_u64, 0.0),
            Self::Apart(limit) => (1, limit),
            Self::Slots(limit) => (2, limit),
            Self::Out => (3, 0.0),
        });
    }
}

/// The effector that a step is about.
pub(crate) fn acting(step: &Step) -> Option<EffectorId> {
    match (step.path, step.handover) {
        (Path::Line(id), _) => Some(id),
        (_, Some(Handover::Picked(id, _) | Handover::Placed(id, _))) => Some(id),
        _ => None,
    }
}

impl Scene<'_> {
    /// What is asked of two items, whatever the step.
    ///
    /// Nothing is asked of bodies on one carrier or on two that a joint connects, of pairs that the cell allows, and of a wafer and the link that carries it.
    pub(crate) fn general_rule(&self, a: usize, b: usize) -> Rule {
        let (first, second) = (&self.items[a], &self.items[b]);
        if !(first.holder.moves() || second.holder.moves()) || self.joined(a, b) {
            return Rule::Free;
        }
        if let (Role::Body(i), Role::Body(j)) = (first.role, second.role) {
            let allowed = &self.cell.allowed_pairs;
            if allowed.contains(&[i, j]) || allowed.contains(&[j, i]) {
                return Rule::Free;
            }
        }
        if first.role == Role::KeepOut || second.role == Role::KeepOut {
            return Rule::Out;
        }
        Rule::Apart(self.cell.clearance)
    }

    /// What is asked during a step of an item that moves and one that stands.
    ///
    /// While a step reaches into a slot, what reaches there has to keep the slots' clearance from the wafers of that station and from all that stands, where that is less than the general one; while it lifts or lowers there, its last link may touch the wafer of that very slot.
    pub(crate) fn rule(&self, mover: usize, standing: usize, step: &Step) -> Rule {
        let general = self.general_rule(mover, standing);
        let (Rule::Apart(_), Some(slot), Some(id)) = (general, step.slot, acting(step)) else {
            return general;
        };
        let [inside, other] = [mover, standing].map(|item| self.items[item].holder);
        if inside != Holder::Effector(id) && !carries(inside, id) {
            return general;
        }
        let nearer = self.cell.slot_clearance.min(self.cell.clearance);
        match other {
            Holder::Slot(there) if there == slot => {
                let handing = matches!(step.phase, Phase::Lift | Phase::Lower);
                if handing { Rule::Free } else { Rule::Slots(nearer) }
            }
            Holder::Slot(there) if there.station == slot.station => {
                Rule::Slots(self.cell.slot_clearance)
            }
            _ => Rule::Apart(nearer),
        }
    }

    /// Whether two items are on one carrier, or on two that a joint connects, or one carries the other.
    fn joined(&self, a: usize, b: usize) -> bool {
        let (a, b) = (self.items[a].holder, self.items[b].holder);
        let linked = |x: Holder, y: Holder| match (x, y) {
            (Holder::Platform, Holder::Link { link: 0, .. }) => true,
            (Holder::Platform, Holder::Tip(id)) => self.last_link(id.arm) == 0,
            (Holder::Link { arm, link }, Holder::Link { arm: other, link: next }) => {
                arm == other && link + 1 == next
            }
            (Holder::Link { arm, link }, Holder::Tip(id)) => {
                arm == id.arm && link + 1 == self.last_link(arm)
            }
            (Holder::Tip(one), Holder::Tip(other)) => one.arm == other.arm,
            (link, Holder::Effector(id)) => carries(link, id),
            _ => false,
        };
        a == b || linked(a, b) || linked(b, a)
    }
}

/// Whether a carrier is the link that an effector's wafer is on.
fn carries(link: Holder, id: EffectorId) -> bool {
    matches!(link, Holder::Tip(tip) if tip.arm == id.arm)
}
