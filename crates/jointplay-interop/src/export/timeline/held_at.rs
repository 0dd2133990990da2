//! Location of a wafer, and its frame there.

use std::hash::{Hash, Hasher};

use jointplay_cell::program::{WaferLocation, WaferLocations};
use jointplay_cell::workcell::Cell;

use crate::export::scene::rounded;
use crate::export::segment::{POSE_NUMBERS, numbers_of};
use crate::export::wafer_frames::WaferFrame;

/// Resolution of the origin of a wafer, as parts of a metre, and of the vector part of its quaternion.
const PLACES: f64 = 1e9;

/// Location of a wafer, and its frame there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldAt {
    /// Slot or effector that supports the wafer.
    pub location: WaferLocation,
    /// Origin x, y, z (m) and vector part x, y, z of its unit quaternion, whose scalar part is positive: in the wafer frame of the effector, or in the base frame.
    pub pose: [f64; POSE_NUMBERS],
}

/// Locations of all wafers before a program starts, in the order of a cell's wafers.
#[must_use]
pub fn wafers_at_start(cell: &Cell) -> Vec<HeldAt> {
    let locations = WaferLocations::at_start(cell);
    let held = |wafer| {
        let frame = WaferFrame::at_start(cell, &locations, wafer);
        HeldAt { location: frame.location, pose: numbers_of(&frame.pose) }
    };
    locations.wafers().map(held).collect()
}

impl HeldAt {
    pub(super) fn hash_into(&self, hasher: &mut impl Hasher) {
        let slot = self.location.slot().map(|slot| (slot.station, slot.slot));
        (self.location.effector(), slot).hash(hasher);
        self.pose.map(f64::to_bits).hash(hasher);
    }

    pub(super) fn new(frame: &WaferFrame) -> Self {
        // The same pose after any number of moves.
        let pose = numbers_of(&frame.pose).map(|number| rounded(number, PLACES));
        Self { location: frame.location, pose }
    }
}
