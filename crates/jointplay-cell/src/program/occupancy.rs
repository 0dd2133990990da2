//! Wafers on effectors and in slots during the expansion of a program.

use std::collections::BTreeMap;

use super::{Place, ProgramProblem};
use crate::program::resolve::effector_name;
use crate::robot::EffectorId;
use crate::station::SlotId;
use crate::workcell::Cell;

/// Whether an effector or a slot holds a wafer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Holds {
    Nothing,
    Wafer,
    /// Unknown, because a line with an error may have changed it.
    Unknown,
}

/// State of an effector or a slot, and the location of its last change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Holding {
    holds: Holds,
    since: Option<Place>,
}

/// Wafers on effectors and in slots at one instruction of a program.
pub(super) struct WaferOccupancy<'c> {
    cell: &'c Cell,
    effectors: BTreeMap<EffectorId, Holding>,
    slots: BTreeMap<SlotId, Holding>,
    /// State of effectors and slots that are not listed.
    elsewhere: Holds,
    /// Steps at whose end wafers were placed, for stations that process them.
    placed: BTreeMap<SlotId, usize>,
}

impl<'c> WaferOccupancy<'c> {
    pub(super) fn new(cell: &'c Cell) -> Self {
        let full = Holding { holds: Holds::Wafer, since: None };
        Self {
            cell,
            effectors: cell.carried.iter().map(|&id| (id, full)).collect(),
            slots: cell.occupied.iter().map(|&slot| (slot, full)).collect(),
            elsewhere: Holds::Nothing,
            placed: BTreeMap::new(),
        }
    }

    /// Makes all states unknown, after a line with an error.
    pub(super) fn invalidate(&mut self) {
        self.effectors.values_mut().chain(self.slots.values_mut()).for_each(|state| {
            state.holds = Holds::Unknown;
        });
        self.elsewhere = Holds::Unknown;
        self.placed.clear();
    }

    fn effector(&self, id: EffectorId) -> Holding {
        let other = Holding { holds: self.elsewhere, since: None };
        self.effectors.get(&id).copied().unwrap_or(other)
    }

    fn slot(&self, slot: SlotId) -> Holding {
        self.slots.get(&slot).copied().unwrap_or(Holding { holds: self.elsewhere, since: None })
    }

    /// Effectors that carry a wafer, in order.
    pub(super) fn loaded(&self) -> Vec<EffectorId> {
        let loaded = self.effectors.iter().filter(|(_, state)| state.holds == Holds::Wafer);
        loaded.map(|(&id, _)| id).collect()
    }

    /// Step at whose end the wafer in a slot was placed; `None` where the program did not place it.
    pub(super) fn placed_by(&self, slot: SlotId) -> Option<usize> {
        self.placed.get(&slot).copied()
    }

    /// Problems of picking a wafer.
    pub(super) fn before_get(&self, id: EffectorId, slot: SlotId) -> Vec<ProgramProblem> {
        let mut problems = Vec::new();
        let (hand, place) = (self.effector(id), self.slot(slot));
        if hand.holds == Holds::Wafer {
            problems.push(ProgramProblem::EffectorLoaded {
                effector: effector_name(&self.cell.robot, id).to_owned(),
                since: hand.since.map(|place| place.line),
            });
        }
        if place.holds == Holds::Nothing {
            problems.push(ProgramProblem::EmptySlot {
                slot: slot_name(self.cell, slot),
                since: place.since.map(|place| place.line),
            });
        }
        problems
    }

    /// Problems of placing a wafer.
    pub(super) fn before_put(&self, id: EffectorId, slot: SlotId) -> Vec<ProgramProblem> {
        let mut problems = Vec::new();
        let (hand, place) = (self.effector(id), self.slot(slot));
        if hand.holds == Holds::Nothing {
            problems.push(ProgramProblem::EffectorEmpty {
                effector: effector_name(&self.cell.robot, id).to_owned(),
                since: hand.since.map(|place| place.line),
            });
        }
        if place.holds == Holds::Wafer {
            problems.push(ProgramProblem::SlotOccupied {
                slot: slot_name(self.cell, slot),
                since: place.since.map(|place| place.line),
            });
        }
        problems
    }

    /// Moves the wafer from the slot to the effector.
    pub(super) fn get(&mut self, id: EffectorId, slot: SlotId, place: Place) {
        self.effectors.insert(id, Holding { holds: Holds::Wafer, since: Some(place) });
        self.slots.insert(slot, Holding { holds: Holds::Nothing, since: Some(place) });
        self.placed.remove(&slot);
    }

    /// Moves the wafer from the effector to the slot, at the end of a step if that is known.
    pub(super) fn put(&mut self, id: EffectorId, slot: SlotId, place: Place, step: Option<usize>) {
        self.effectors.insert(id, Holding { holds: Holds::Nothing, since: Some(place) });
        self.slots.insert(slot, Holding { holds: Holds::Wafer, since: Some(place) });
        if let Some(step) = step {
            self.placed.insert(slot, step);
        }
    }
}

/// A slot as messages call it.
pub(super) fn slot_name(cell: &Cell, slot: SlotId) -> String {
    let station = &cell.stations[slot.station];
    match station.slots {
        1 => station.name.clone(),
        _ => format!("slot {} of {}", slot.slot, station.name),
    }
}
