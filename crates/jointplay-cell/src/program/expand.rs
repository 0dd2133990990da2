//! From instructions to steps.

use std::collections::BTreeMap;
use std::mem::discriminant;

use super::ik_cache::IkCache;
use super::occupancy::WaferOccupancy;
use super::resolve::{Line, Number, Resolved, ResolvedCommand, Slot, resolve};
use super::sequence::MotionSequencer;
use super::{Path, Place, Program, ProgramError, ProgramProblem, Step};
use crate::incremental::{Interrupted, Stop, uninterrupted};
use crate::robot::EffectorId;
use crate::station::SlotId;
use crate::workcell::Cell;

/// The steps that a program comes to in its cell, from the home position on.
///
/// ```text
///    GET:  turn retracted → enter below, tilted → extend → lift to the wafer → lift with it → retract → level
///    PUT:  turn retracted → enter above, tilted → extend → lower to the slot → lower without it → retract → level
/// ```
/// A wafer that lies in a station with a process time is fetched when that is over: a step waits before the slot.
///
/// # Errors
/// Everything that is wrong with the program in this cell, each thing once with its place: names, programs without end, wafers that are missing or in the way, places out of reach and limits that stop them.
pub fn expand(cell: &Cell, program: &Program) -> Result<Vec<Step>, Vec<ProgramError>> {
    uninterrupted(expand_by(cell, program, &mut IkCache::default(), &|| false))
}

/// The same, with what is known of the last program's places.
pub(crate) fn expand_by(
    cell: &Cell,
    program: &Program,
    places: &mut IkCache,
    stop: Stop<'_>,
) -> Result<Result<Vec<Step>, Vec<ProgramError>>, Interrupted> {
    let (resolved, unresolved) = resolve(cell, program);
    let mut errors = Errors::default();
    for error in unresolved {
        errors.add(error.place, error.problem);
    }
    let mut steps = Vec::new();
    if let Some(resolved) = &resolved {
        places.begin(cell);
        let mut run = ProgramExpander {
            resolved,
            presence: WaferOccupancy::new(cell),
            robot: MotionSequencer::new(cell, places),
            errors: &mut errors,
            instruction: 0,
            stop,
        };
        run.block(&resolved.body, &mut Vec::new())?;
        steps = run.robot.steps;
        places.end();
    }
    let errors: Vec<ProgramError> = errors.0.into_values().flatten().collect();
    Ok(if errors.is_empty() { Ok(steps) } else { Err(errors) })
}

/// What is wrong, each thing once a place.
#[derive(Default)]
struct Errors(BTreeMap<Place, Vec<ProgramError>>);

impl Errors {
    fn add(&mut self, place: Place, problem: ProgramProblem) {
        let here = self.0.entry(place).or_default();
        let kind = discriminant(&problem);
        match here.iter_mut().find(|error| discriminant(&error.problem) == kind) {
            Some(first) => first.more += 1,
            None => here.push(ProgramError { place, problem, more: 0 }),
        }
    }
}

/// A program on its way through the cell.
struct ProgramExpander<'r> {
    resolved: &'r Resolved,
    presence: WaferOccupancy<'r>,
    robot: MotionSequencer<'r>,
    errors: &'r mut Errors,
    /// How many instructions have been run.
    instruction: usize,
    stop: Stop<'r>,
}

impl ProgramExpander<'_> {
    /// Goes through a block; `passes` are those of the REPEATs around it, from 1.
    fn block(&mut self, body: &[Line], passes: &mut Vec<u64>) -> Result<(), Interrupted> {
        let resolved = self.resolved;
        for Line { place, act } in body {
            if (self.stop)() {
                return Err(Interrupted);
            }
            match act {
                ResolvedCommand::Repeat { times, body } => {
                    for pass in 1..=*times {
                        passes.push(pass);
                        self.block(body, passes)?;
                        passes.pop();
                    }
                }
                ResolvedCommand::Call(routine) => {
                    self.block(&resolved.routines[*routine], &mut Vec::new())?
                }
                act => {
                    self.robot.start(self.instruction, *place, self.presence.loaded());
                    self.instruction += 1;
                    self.simple(*place, act, passes);
                }
            }
        }
        Ok(())
    }

    fn simple(&mut self, place: Place, act: &ResolvedCommand, passes: &[u64]) {
        match *act {
            ResolvedCommand::Home => self.robot.home(),
            ResolvedCommand::Move(ref targets) => {
                let done = self.robot.move_axes(targets);
                self.report(place, done);
            }
            ResolvedCommand::MoveLine { effector, by } => {
                let done = self.robot.move_line(effector, by);
                self.report(place, done);
            }
            ResolvedCommand::Get { from, effector } => self.get(place, from, effector, passes),
            ResolvedCommand::Put { to, effector } => self.put(place, to, effector, passes),
            ResolvedCommand::Transfer { from, to, effector } => {
                self.get(place, from, effector, passes);
                self.put(place, to, effector, passes);
            }
            ResolvedCommand::Swap { at, get, put } => {
                self.get(place, at, get, passes);
                self.put(place, at, put, passes);
            }
            ResolvedCommand::Goto { to, effector } => {
                if let Some(slot) = self.slot(to, passes) {
                    let done = self.robot.goto(effector, slot);
                    self.report(place, done);
                }
            }
            ResolvedCommand::Wait(seconds) => self.robot.stand(Path::Dwell(seconds)),
            ResolvedCommand::Speed(share) => self.robot.speed = share,
            ResolvedCommand::Blend(radius) => self.robot.blend = radius,
            ResolvedCommand::Tilt(tilt) => {
                let done = self.robot.tilt(tilt);
                self.report(place, done);
            }
            ResolvedCommand::Unclear => self.presence.forget(),
            ResolvedCommand::Call(_) | ResolvedCommand::Repeat { .. } => {
                unreachable!("gone through by block")
            }
        }
    }

    fn report(&mut self, place: Place, done: Result<(), ProgramProblem>) {
        if let Err(problem) = done {
            self.errors.add(place, problem);
        }
    }

    /// The slot of this pass, if the station has it.
    fn slot(&mut self, slot: Slot, passes: &[u64]) -> Option<SlotId> {
        let found = match slot.number {
            Number::Fixed(number) => number,
            Number::Counted { repeat, offset, down } => {
                let pass = i128::from(passes[repeat]);
                i128::from(offset) + if down { -pass } else { pass }
            }
        };
        let station = &self.robot.cell.stations[slot.station];
        let slots = station.slots;
        if let Ok(number @ 1..) = usize::try_from(found)
            && number <= slots
        {
            return Some(SlotId { station: slot.station, slot: number });
        }
        let station = station.name.clone();
        self.errors.add(slot.place, ProgramProblem::NoSlot { station, found, slots });
        None
    }

    fn get(&mut self, place: Place, from: Slot, effector: EffectorId, passes: &[u64]) {
        let Some(slot) = self.slot(from, passes) else {
            self.presence.forget();
            return;
        };
        for problem in self.presence.before_get(effector, slot) {
            self.errors.add(place, problem);
        }
        let process_time = self.robot.cell.stations[slot.station].process_time;
        let since = self.presence.left_by(slot).filter(|_| process_time > 0.0);
        let wait = since.map(|since| Path::ProcessDwell { since, seconds: process_time });
        let done = self.robot.get(effector, slot, wait);
        self.report(place, done);
        // What was meant, also where it went wrong: later lines are held to it.
        self.presence.get(effector, slot, place);
    }

    fn put(&mut self, place: Place, to: Slot, effector: EffectorId, passes: &[u64]) {
        let Some(slot) = self.slot(to, passes) else {
            self.presence.forget();
            return;
        };
        for problem in self.presence.before_put(effector, slot) {
            self.errors.add(place, problem);
        }
        let done = self.robot.put(effector, slot);
        let step = done.as_ref().ok().copied();
        self.report(place, done.map(|_| ()));
        self.presence.put(effector, slot, place, step);
    }
}
