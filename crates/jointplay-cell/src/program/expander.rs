//! The state of a program during its expansion, and the values of its numbers, slots and conditions there.

use std::collections::BTreeMap;
use std::mem::discriminant;

use super::effector_choice::choose_effector;
use super::frame::{ArgumentValue, Frame};
use super::occupancy::WaferOccupancy;
use super::resolved::{
    EffectorChoice, EffectorReference, ResolvedCondition, ResolvedLocation, ResolvedNumber,
    ResolvedProgram, ResolvedQuantity, ResolvedSlot, StationReference,
};
use super::sequence::MotionSequencer;
use super::{
    AllowedValues, ErrorContext, ProgramError, ProgramProblem, SourceLocation, WaferLocation,
};
use crate::incremental::StopRequested;
use crate::robot::EffectorId;
use crate::station::SlotId;

/// Errors, each kind once at a location.
#[derive(Default)]
pub(super) struct Errors(pub(super) BTreeMap<SourceLocation, Vec<ProgramError>>);

impl Errors {
    /// Adds an error; `context` is that of a first occurrence.
    pub(super) fn add(
        &mut self,
        place: SourceLocation,
        problem: ProgramProblem,
        context: impl FnOnce() -> ErrorContext,
    ) {
        let here = self.0.entry(place).or_default();
        let kind = discriminant(&problem);
        match here.iter_mut().find(|error| discriminant(&error.problem) == kind) {
            Some(first) => first.repetitions += 1,
            None => {
                here.push(ProgramError { place, problem, context: context(), repetitions: 0 });
            }
        }
    }
}

/// The state of a program during its expansion.
pub(super) struct ProgramExpander<'r> {
    pub(super) resolved: &'r ResolvedProgram,
    pub(super) occupancy: WaferOccupancy<'r>,
    pub(super) sequencer: MotionSequencer<'r>,
    pub(super) errors: &'r mut Errors,
    /// Number of instructions executed.
    pub(super) instruction: usize,
    /// Number of instructions, calls, conditions and passes without instruction, for the limit of instructions.
    pub(super) work: u64,
    /// The main instructions, and the routines that are being executed.
    pub(super) frames: Vec<Frame<'r>>,
    pub(super) stop: StopRequested<'r>,
}

impl<'r> ProgramExpander<'r> {
    pub(super) fn frame(&self) -> &Frame<'r> {
        self.frames.last().expect("the main instructions have a frame")
    }

    pub(super) fn frame_mut(&mut self) -> &mut Frame<'r> {
        self.frames.last_mut().expect("the main instructions have a frame")
    }

    /// Whether a condition holds; `None` where this is not known, after an error.
    pub(super) fn holds(&mut self, condition: &'r ResolvedCondition) -> Option<bool> {
        match condition {
            ResolvedCondition::Comparison { left, relation, right } => {
                let left = self.finite("the number to compare", left);
                let right = self.finite("the number to compare", right);
                Some(relation.holds(left?, right?))
            }
            ResolvedCondition::Presence { location, occupied } => {
                let location = self.location(location)?;
                Some(self.occupancy.is_occupied(location)? == *occupied)
            }
            ResolvedCondition::Not(condition) => Some(!self.holds(condition)?),
            ResolvedCondition::All(conditions) => {
                for condition in conditions {
                    if !self.holds(condition)? {
                        return Some(false);
                    }
                }
                Some(true)
            }
            ResolvedCondition::Any(conditions) => {
                for condition in conditions {
                    if self.holds(condition)? {
                        return Some(true);
                    }
                }
                Some(false)
            }
        }
    }

    /// The slot or effector of a condition.
    pub(super) fn location(&mut self, location: &ResolvedLocation) -> Option<WaferLocation> {
        Some(match location {
            ResolvedLocation::Slot(slot) => WaferLocation::Slot(self.slot(slot)?),
            ResolvedLocation::Effector(effector) => WaferLocation::Effector(*effector),
            ResolvedLocation::Argument { index, place } => match self.frame().arguments[*index] {
                ArgumentValue::Station(station) => {
                    WaferLocation::Slot(self.slot_of(station, *place, None)?)
                }
                ArgumentValue::Effector(effector) => WaferLocation::Effector(effector),
                ArgumentValue::Number(_) | ArgumentValue::Unused => return None,
            },
        })
    }

    pub(super) fn report(&mut self, place: SourceLocation, problem: ProgramProblem) {
        let frames = &self.frames;
        self.errors.add(place, problem, || ErrorContext {
            variables: frames.last().map_or_else(Vec::new, Frame::variables),
            calls: frames.iter().rev().filter_map(|frame| Some(frame.routine?.1)).collect(),
        });
    }

    pub(super) fn report_result(
        &mut self,
        place: SourceLocation,
        done: Result<(), ProgramProblem>,
    ) {
        if let Err(problem) = done {
            self.report(place, problem);
        }
    }

    /// Value of a quantity in the unit of the text, if it is allowed.
    pub(super) fn value(&mut self, quantity: &ResolvedQuantity) -> Option<f64> {
        let ResolvedQuantity { what, number, allowed } = quantity;
        let found = self.frame().value(number);
        if allowed.contains(found) {
            return Some(found);
        }
        let (what, allowed) = (*what, *allowed);
        self.report(number.place, ProgramProblem::Value { what, found, allowed });
        None
    }

    /// Value of a quantity in SI units, if it is allowed.
    pub(super) fn si(&mut self, quantity: &ResolvedQuantity) -> Option<f64> {
        let value = self.value(quantity)?;
        Some(quantity.allowed.unit.map_or(value, |unit| unit.to_si(value)))
    }

    /// Value of a number, if it is finite.
    pub(super) fn finite(&mut self, what: &'static str, number: &ResolvedNumber) -> Option<f64> {
        let found = self.frame().value(number);
        if found.is_finite() {
            return Some(found);
        }
        self.report(number.place, ProgramProblem::NotFinite { what, found });
        None
    }

    pub(super) fn station(&self, station: StationReference) -> Option<usize> {
        match station {
            StationReference::Fixed(index) => Some(index),
            StationReference::Argument(index) => match self.frame().arguments[index] {
                ArgumentValue::Station(station) => Some(station),
                _ => None,
            },
        }
    }

    /// The slot of this pass, if the station has it.
    pub(super) fn slot(&mut self, slot: &ResolvedSlot) -> Option<SlotId> {
        let station = self.station(slot.station)?;
        self.slot_of(station, slot.place, slot.number.as_ref())
    }

    /// A slot of a station; without a number, its only one.
    pub(super) fn slot_of(
        &mut self,
        station: usize,
        place: SourceLocation,
        number: Option<&ResolvedNumber>,
    ) -> Option<SlotId> {
        let (name, slots) = {
            let station = &self.sequencer.cell.stations[station];
            (&station.name, station.slots)
        };
        let Some(number) = number else {
            if slots == 1 {
                return Some(SlotId { station, slot: 1 });
            }
            let problem = ProgramProblem::WhichSlot { station: name.clone(), slots };
            self.report(place, problem);
            return None;
        };
        let found = self.frame().value(number);
        if let Some(slot) = slot_number(found).filter(|number| (1..=slots).contains(number)) {
            return Some(SlotId { station, slot });
        }
        let problem = match found.is_finite() {
            true => ProgramProblem::NoSlot { station: name.clone(), found, slots },
            false => ProgramProblem::SlotNotFinite { station: name.clone(), found, slots },
        };
        self.report(number.place, problem);
        None
    }

    /// The effector for stations, if they are open to it.
    pub(super) fn effector(
        &mut self,
        choice: EffectorChoice,
        stations: &[usize],
    ) -> Option<EffectorId> {
        let named = match choice.named {
            EffectorReference::Fixed(id) => Some(id),
            EffectorReference::Only => None,
            EffectorReference::Argument(index) => match self.frame().arguments[index] {
                ArgumentValue::Effector(id) => Some(id),
                _ => return None,
            },
        };
        let found = choose_effector(self.sequencer.cell, named, stations);
        found.map_err(|problem| self.report(choice.place, problem)).ok()
    }
}

/// A number as that of a slot; `None` where it is not whole or out of the range of all stations.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole, and from 1 to 100 000"
)]
fn slot_number(number: f64) -> Option<usize> {
    AllowedValues::SLOT_NUMBER.contains(number).then_some(number as usize)
}
