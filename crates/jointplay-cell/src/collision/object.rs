//! Collision objects, and what each is attached to.

use jointplay_core::spatial::Pose;

use crate::EntityId;
use crate::geometry::{Placed, Solid, Solids, Span};
use crate::incremental::{Fingerprint, Fingerprinted};
use crate::robot::EffectorId;
use crate::station::SlotId;

/// What holds an item.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Holder {
    World,
    Platform,
    /// A link before the last one of its arm.
    Link {
        arm: usize,
        link: usize,
    },
    /// The last link of an arm, deflected as at this effector.
    Tip(EffectorId),
    Slot(SlotId),
    Effector(EffectorId),
}

impl Holder {
    pub(crate) fn moves(self) -> bool {
        !matches!(self, Self::World | Self::Slot(_))
    }
}

/// What an item is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// Of the cell, by index.
    Body(usize),
    Wafer,
    KeepOut,
}

/// Something that takes room.
#[derive(Clone)]
pub(crate) struct Item {
    /// What it is to the user.
    pub(crate) entity: EntityId,
    pub(crate) solid: Solid,
    /// Number of its solid, which no other solid has.
    number: u64,
    /// Number of its solid where it stands, for what does not move.
    stands: u64,
    pub(crate) holder: Holder,
    pub(crate) role: Role,
    /// Where its holder stands, for what does not move.
    pub(super) standing: Pose,
    /// A box around it, axes those of the base, for what does not move.
    pub(crate) around: [Span; 3],
    /// Whether it was ever laid into a slot.
    pub(crate) laid: bool,
}

impl Item {
    pub(super) fn new(
        entity: EntityId,
        (number, solid): (u64, Solid),
        (holder, role): (Holder, Role),
        solids: &mut Solids,
    ) -> Self {
        let (around, standing) = ([Span { least: 0.0, most: 0.0 }; 3], Pose::identity());
        let (stands, laid) = (0, false);
        let mut item = Self { entity, solid, number, stands, holder, role, standing, around, laid };
        item.stand(standing, solids);
        item
    }

    pub(super) fn stand(&mut self, standing: Pose, solids: &mut Solids) {
        self.standing = standing;
        self.stands = solids.standing(self.number, &standing);
        let placed = Placed { solid: &self.solid, base_from_carrier: &self.standing };
        self.around = placed.around();
    }
}

impl Fingerprinted for Item {
    /// Collider and parent, and the pose of a fixed object; neither entity nor role, which distances do not depend on.
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        match self.holder {
            Holder::World | Holder::Slot(_) => fingerprint.add(&0_u64).add(&self.stands),
            Holder::Platform => fingerprint.add(&1_u64).add(&self.number),
            Holder::Link { arm, link } => {
                fingerprint.add(&2_u64).add(&self.number).add(&arm).add(&link)
            }
            Holder::Effector(id) => fingerprint.add(&3_u64).add(&self.number).add(&id),
            Holder::Tip(id) => fingerprint.add(&4_u64).add(&self.number).add(&id),
        };
    }
}
