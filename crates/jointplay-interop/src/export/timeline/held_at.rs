//! Supports of wafers.

use std::hash::{Hash, Hasher};

use jointplay_cell::robot::EffectorId;
use jointplay_cell::station::SlotId;
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::Pose;

use crate::export::scene::{Held, rounded};
use crate::export::segment::{POSE_NUMBERS, numbers_of};

/// Fraction of a metre to which the pose of a wafer is rounded, and of the vector part of its quaternion.
const PLACES: f64 = 1e9;

/// Support of a wafer, and the wafer's pose there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldAt {
    /// The effector; `None` for a wafer in a slot.
    pub effector: Option<EffectorId>,
    /// The slot; `None` for a wafer on an effector.
    pub slot: Option<SlotId>,
    /// Origin x, y, z (m) and vector part x, y, z of its unit quaternion, whose scalar part is positive: in the wafer frame of the effector, or in the base frame.
    pub pose: [f64; POSE_NUMBERS],
}

/// Initial supports of all wafers, in the order of a cell's wafers.
#[must_use]
pub fn wafers_at_start(cell: &Cell) -> Vec<HeldAt> {
    let in_slots = cell.occupied.iter().map(|&slot| {
        let at = cell.stations[slot.station].slot_frame(slot.slot);
        HeldAt { effector: None, slot: Some(slot), pose: numbers_of(&at) }
    });
    let carried = cell.carried.iter().map(|&id| HeldAt {
        effector: Some(id),
        slot: None,
        pose: numbers_of(&Pose::identity()),
    });
    in_slots.chain(carried).collect()
}

impl HeldAt {
    pub(super) fn hash_into(&self, hasher: &mut impl Hasher) {
        (self.effector, self.slot.map(|slot| (slot.station, slot.slot))).hash(hasher);
        self.pose.map(f64::to_bits).hash(hasher);
    }

    pub(super) fn new(held: &Held, slot: Option<SlotId>) -> Self {
        let (effector, pose) = match held {
            Held::InSlot(at) => (None, at),
            Held::On(id, at) => (Some(*id), at),
        };
        // Rounded, so that the pose is the same after any number of hand-offs.
        Self { effector, slot, pose: numbers_of(pose).map(|number| rounded(number, PLACES)) }
    }
}
