//! Locations of all wafers during a program.

use std::collections::BTreeMap;
use std::ops::Range;

use super::step::{Handoff, Step};
use crate::EntityId;
use crate::robot::EffectorId;
use crate::station::SlotId;
use crate::workcell::Cell;

/// Slot or effector that supports a wafer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum WaferLocation {
    /// A slot of a station.
    Slot(SlotId),
    /// An end effector.
    Effector(EffectorId),
}

/// Stay of a wafer in one location.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WaferStay {
    /// The location.
    pub location: WaferLocation,
    /// Index of the step at whose end the wafer arrives; `None` from the start of the program.
    pub arrival_step: Option<usize>,
    /// Index of the step at whose end the wafer leaves; `None` until the end of the program.
    pub departure_step: Option<usize>,
}

/// Change of the location of a wafer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LocationChange {
    /// Index of the step at whose end the wafer changes its location.
    pub step: usize,
    /// Index of the wafer.
    pub wafer: usize,
    /// New location of the wafer.
    pub to: WaferLocation,
}

/// Locations of all wafers of a cell during the steps of a program.
///
/// Wafers are counted from 0: those in slots at the start in the order of [`Cell::occupied`], then those on effectors in the order of [`Cell::loaded_effectors`].
///
/// # Example
/// ```
/// use jointplay_cell::program::{Handoff, Step, WaferLocation, WaferLocations};
/// use jointplay_cell::workcell::Cell;
///
/// /// Locations after the last step, by wafer.
/// fn final_locations(cell: &Cell, steps: &[Step]) -> Vec<WaferLocation> {
///     let locations = WaferLocations::of_steps(cell, steps);
///     locations.wafers().map(|wafer| locations.location(wafer)).collect()
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct WaferLocations {
    wafer_ids: Vec<EntityId>,
    stays: Vec<Vec<WaferStay>>,
    changes: Vec<LocationChange>,
    /// Wafers by their present location.
    occupants: BTreeMap<WaferLocation, usize>,
}

impl WaferLocation {
    /// The slot; `None` for an effector.
    #[must_use]
    pub fn slot(self) -> Option<SlotId> {
        match self {
            Self::Slot(slot) => Some(slot),
            Self::Effector(_) => None,
        }
    }

    /// The effector; `None` for a slot.
    #[must_use]
    pub fn effector(self) -> Option<EffectorId> {
        match self {
            Self::Slot(_) => None,
            Self::Effector(id) => Some(id),
        }
    }
}

impl Handoff {
    /// Slot of the hand-off.
    #[must_use]
    pub fn slot(self) -> SlotId {
        match self {
            Self::Picked(_, slot) | Self::Placed(_, slot) => slot,
        }
    }

    /// Location that the wafer leaves.
    #[must_use]
    pub fn source(self) -> WaferLocation {
        match self {
            Self::Picked(_, slot) => WaferLocation::Slot(slot),
            Self::Placed(effector, _) => WaferLocation::Effector(effector),
        }
    }

    /// Location at which the wafer arrives.
    #[must_use]
    pub fn destination(self) -> WaferLocation {
        match self {
            Self::Picked(effector, _) => WaferLocation::Effector(effector),
            Self::Placed(_, slot) => WaferLocation::Slot(slot),
        }
    }
}

impl WaferLocations {
    /// Locations before the first step.
    #[must_use]
    pub fn at_start(cell: &Cell) -> Self {
        let in_slots = cell.occupied.iter().map(|&slot| WaferLocation::Slot(slot));
        let carried = cell.loaded_effectors.iter().map(|&id| WaferLocation::Effector(id));
        let locations: Vec<WaferLocation> = in_slots.chain(carried).collect();
        let wafer_id = |location: &WaferLocation| match *location {
            WaferLocation::Slot(slot) => EntityId::Wafer(slot),
            WaferLocation::Effector(id) => EntityId::HeldWafer(id),
        };
        let stay = |&location: &WaferLocation| {
            vec![WaferStay { location, arrival_step: None, departure_step: None }]
        };
        Self {
            wafer_ids: locations.iter().map(wafer_id).collect(),
            stays: locations.iter().map(stay).collect(),
            changes: Vec::new(),
            occupants: locations.into_iter().enumerate().map(|(k, at)| (at, k)).collect(),
        }
    }

    /// Locations during steps, whose hand-offs are applied in order.
    #[must_use]
    pub fn of_steps(cell: &Cell, steps: &[Step]) -> Self {
        let mut locations = Self::at_start(cell);
        for (index, step) in steps.iter().enumerate() {
            if let Some(handoff) = step.handoff {
                locations.apply(index, handoff);
            }
        }
        locations
    }

    /// Applies the hand-off at the end of a step; `None`, without a change, where there is no wafer to hand off, or where its destination is occupied.
    ///
    /// # Arguments
    /// * `step` – index of the step, not below those of earlier calls
    pub fn apply(&mut self, step: usize, handoff: Handoff) -> Option<LocationChange> {
        let (from, to) = (handoff.source(), handoff.destination());
        if self.occupants.contains_key(&to) {
            return None;
        }
        let wafer = self.occupants.remove(&from)?;
        self.occupants.insert(to, wafer);
        let stays = &mut self.stays[wafer];
        if let Some(last) = stays.last_mut() {
            last.departure_step = Some(step);
        }
        stays.push(WaferStay { location: to, arrival_step: Some(step), departure_step: None });
        let change = LocationChange { step, wafer, to };
        self.changes.push(change);
        Some(change)
    }

    /// Indices of all wafers.
    pub fn wafers(&self) -> Range<usize> {
        0..self.wafer_ids.len()
    }

    /// Identity of a wafer.
    ///
    /// # Panics
    /// If there is no such wafer.
    #[must_use]
    pub fn wafer_id(&self, wafer: usize) -> EntityId {
        self.wafer_ids[wafer]
    }

    /// Stays of a wafer in the order of time, one at least.
    ///
    /// # Panics
    /// If there is no such wafer.
    #[must_use]
    pub fn stays(&self, wafer: usize) -> &[WaferStay] {
        &self.stays[wafer]
    }

    /// Location of a wafer after the last step.
    ///
    /// # Panics
    /// If there is no such wafer.
    #[must_use]
    pub fn location(&self, wafer: usize) -> WaferLocation {
        self.stays[wafer].last().expect("a wafer has a stay").location
    }

    /// Wafer in a location after the last step.
    #[must_use]
    pub fn occupant(&self, location: WaferLocation) -> Option<usize> {
        self.occupants.get(&location).copied()
    }

    /// Changes of locations in the order of time.
    #[must_use]
    pub fn location_changes(&self) -> &[LocationChange] {
        &self.changes
    }

    /// Changes of locations at the ends of some steps.
    #[must_use]
    pub fn location_changes_in(&self, steps: &Range<usize>) -> &[LocationChange] {
        let first = |step: usize| self.changes.partition_point(|change| change.step < step);
        &self.changes[first(steps.start)..first(steps.end)]
    }

    /// Number of different wafers that are placed into a slot.
    #[must_use]
    pub fn placed_wafers(&self) -> usize {
        let is_placed =
            |stay: &WaferStay| stay.arrival_step.is_some() && stay.location.slot().is_some();
        self.stays.iter().filter(|stays| stays.iter().any(is_placed)).count()
    }
}
