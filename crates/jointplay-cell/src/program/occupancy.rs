//! Occupancy of effectors and slots during the expansion of a program, also after lines with errors.

use std::collections::BTreeMap;

use super::step::Handoff;
use super::wafer_locations::{WaferLocation, WaferLocations};
use super::{ProgramProblem, SourceLocation};
use crate::program::effector_choice::effector_name;
use crate::robot::EffectorId;
use crate::station::SlotId;
use crate::workcell::Cell;

/// Occupancy of an effector or a slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Occupancy {
    Empty,
    Occupied,
    /// Unknown, because a line with an error may have changed it.
    Unknown,
}

/// Locations of wafers at one instruction of a program, and assumptions where the program has errors.
pub(super) struct WaferOccupancy<'c> {
    cell: &'c Cell,
    locations: WaferLocations,
    /// Locations whose occupancy is assumed, because a line with an error changed it.
    assumed: BTreeMap<WaferLocation, Occupancy>,
    /// Whether all other occupancies are unknown.
    is_unknown: bool,
    /// Instruction that last changed a location.
    changed: BTreeMap<WaferLocation, SourceLocation>,
}

impl<'c> WaferOccupancy<'c> {
    pub(super) fn new(cell: &'c Cell) -> Self {
        Self {
            cell,
            locations: WaferLocations::at_start(cell),
            assumed: BTreeMap::new(),
            is_unknown: false,
            changed: BTreeMap::new(),
        }
    }

    /// Makes the occupancy of all locations unknown, after a line with an error.
    pub(super) fn invalidate(&mut self) {
        self.assumed.clear();
        self.is_unknown = true;
    }

    fn occupancy(&self, location: WaferLocation) -> Occupancy {
        match self.assumed.get(&location) {
            Some(&assumed) => assumed,
            None if self.is_unknown => Occupancy::Unknown,
            None if self.locations.occupant(location).is_some() => Occupancy::Occupied,
            None => Occupancy::Empty,
        }
    }

    /// Whether a location holds a wafer; `None` where a line with an error may have changed it.
    pub(super) fn is_occupied(&self, location: WaferLocation) -> Option<bool> {
        match self.occupancy(location) {
            Occupancy::Empty => Some(false),
            Occupancy::Occupied => Some(true),
            Occupancy::Unknown => None,
        }
    }

    fn is_assumed(&self, location: WaferLocation) -> bool {
        self.is_unknown || self.assumed.contains_key(&location)
    }

    /// Line of the instruction that last changed a location.
    fn changed_at_line(&self, location: WaferLocation) -> Option<usize> {
        self.changed.get(&location).map(|place| place.line)
    }

    /// Effectors that carry a wafer, in order.
    pub(super) fn loaded(&self) -> Vec<EffectorId> {
        let is_loaded =
            |&id: &EffectorId| self.occupancy(WaferLocation::Effector(id)) == Occupancy::Occupied;
        self.cell.robot.effectors().filter(is_loaded).collect()
    }

    /// Step at whose end the wafer in a slot was placed; `None` where the program did not place it.
    pub(super) fn placed_by(&self, slot: SlotId) -> Option<usize> {
        let location = WaferLocation::Slot(slot);
        if self.is_assumed(location) {
            return None;
        }
        let wafer = self.locations.occupant(location)?;
        self.locations.stays(wafer).last()?.arrival_step
    }

    /// Problems of a hand-off, that of the effector first: a wafer is missing, or its destination is occupied.
    pub(super) fn problems(&self, handoff: Handoff) -> Vec<ProgramProblem> {
        let (Handoff::Picked(id, slot) | Handoff::Placed(id, slot)) = handoff;
        let (hand, slot_location) = (WaferLocation::Effector(id), WaferLocation::Slot(slot));
        let picks = matches!(handoff, Handoff::Picked(..));
        let mut problems = Vec::new();
        let effector = || effector_name(&self.cell.robot, id).to_owned();
        let changed_at_line = self.changed_at_line(hand);
        match self.occupancy(hand) {
            Occupancy::Occupied if picks => {
                problems
                    .push(ProgramProblem::EffectorLoaded { effector: effector(), changed_at_line });
            }
            Occupancy::Empty if !picks => {
                problems
                    .push(ProgramProblem::EffectorEmpty { effector: effector(), changed_at_line });
            }
            _ => {}
        }
        let slot = || slot_name(self.cell, slot);
        let changed_at_line = self.changed_at_line(slot_location);
        match self.occupancy(slot_location) {
            Occupancy::Empty if picks => {
                problems.push(ProgramProblem::EmptySlot { slot: slot(), changed_at_line });
            }
            Occupancy::Occupied if !picks => {
                problems.push(ProgramProblem::SlotOccupied { slot: slot(), changed_at_line });
            }
            _ => {}
        }
        problems
    }

    /// Applies a hand-off, at the end of a step if the motion to it exists.
    ///
    /// It counts as executed also where it has a problem, so that one mistake does not cause errors in later lines.
    pub(super) fn apply(&mut self, handoff: Handoff, place: SourceLocation, step: Option<usize>) {
        let (from, to) = (handoff.source(), handoff.destination());
        let is_assumed = self.is_assumed(from) || self.is_assumed(to);
        let applied = match step {
            Some(step) if !is_assumed => self.locations.apply(step, handoff),
            _ => None,
        };
        if applied.is_none() {
            self.assumed.insert(from, Occupancy::Empty);
            self.assumed.insert(to, Occupancy::Occupied);
        }
        self.changed.insert(from, place);
        self.changed.insert(to, place);
    }
}

/// Name of a slot in messages.
pub(super) fn slot_name(cell: &Cell, slot: SlotId) -> String {
    let station = &cell.stations[slot.station];
    match station.slots {
        1 => station.name.clone(),
        _ => format!("slot {} of {}", slot.slot, station.name),
    }
}
