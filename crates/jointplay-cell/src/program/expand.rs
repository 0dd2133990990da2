//! From the instructions of a program to steps.

use std::collections::BTreeMap;
use std::mem::discriminant;

use super::ik_cache::IkCache;
use super::occupancy::WaferOccupancy;
use super::resolve::resolve;
use super::resolved::{
    ResolvedCommand, ResolvedInstruction, ResolvedProgram, ResolvedSlot, ResolvedSlotNumber,
};
use super::sequence::MotionSequencer;
use super::{Handoff, Path, Program, ProgramError, ProgramProblem, SourceLocation, Step};
use crate::incremental::{Interrupted, Stop, uninterrupted};
use crate::robot::EffectorId;
use crate::station::SlotId;
use crate::workcell::Cell;

/// Expands a program in its cell into steps, from the home position on.
///
/// ```text
///    GET:  turn retracted → enter below, tilted → extend → lift to the wafer → lift with it → retract → level
///    PUT:  turn retracted → enter above, tilted → extend → lower to the slot → lower without it → retract → level
/// ```
/// A wafer in a station with a process time is picked when the process is over: a dwell in front of the slot waits for it.
///
/// # Errors
/// All errors of the program in this cell, each once with its location: unknown names, programs without end, wafers that are missing or block their destination, targets out of reach and violated limits.
pub fn expand(cell: &Cell, program: &Program) -> Result<Vec<Step>, Vec<ProgramError>> {
    uninterrupted(expand_by(cell, program, &mut IkCache::default(), &|| false))
}

/// As [`expand`], with the inverse kinematics of the last program.
pub(crate) fn expand_by(
    cell: &Cell,
    program: &Program,
    ik_cache: &mut IkCache,
    stop: Stop<'_>,
) -> Result<Result<Vec<Step>, Vec<ProgramError>>, Interrupted> {
    let (resolved, unresolved) = resolve(cell, program);
    let mut errors = Errors::default();
    for error in unresolved {
        errors.add(error.place, error.problem);
    }
    let mut steps = Vec::new();
    if let Some(resolved) = &resolved {
        ik_cache.begin(cell);
        let mut expander = ProgramExpander {
            resolved,
            occupancy: WaferOccupancy::new(cell),
            sequencer: MotionSequencer::new(cell, ik_cache),
            errors: &mut errors,
            instruction: 0,
            stop,
        };
        expander.block(&resolved.body, &mut Vec::new())?;
        steps = expander.sequencer.steps;
        ik_cache.end();
    }
    let errors: Vec<ProgramError> = errors.0.into_values().flatten().collect();
    Ok(if errors.is_empty() { Ok(steps) } else { Err(errors) })
}

/// Errors, each kind once at a location.
#[derive(Default)]
struct Errors(BTreeMap<SourceLocation, Vec<ProgramError>>);

impl Errors {
    fn add(&mut self, place: SourceLocation, problem: ProgramProblem) {
        let here = self.0.entry(place).or_default();
        let kind = discriminant(&problem);
        match here.iter_mut().find(|error| discriminant(&error.problem) == kind) {
            Some(first) => first.repetitions += 1,
            None => here.push(ProgramError { place, problem, repetitions: 0 }),
        }
    }
}

/// The state of a program during its expansion.
struct ProgramExpander<'r> {
    resolved: &'r ResolvedProgram,
    occupancy: WaferOccupancy<'r>,
    sequencer: MotionSequencer<'r>,
    errors: &'r mut Errors,
    /// Number of instructions executed.
    instruction: usize,
    stop: Stop<'r>,
}

impl ProgramExpander<'_> {
    /// Executes a block; `passes` are those of the enclosing REPEATs, from 1.
    fn block(
        &mut self,
        body: &[ResolvedInstruction],
        passes: &mut Vec<u64>,
    ) -> Result<(), Interrupted> {
        let resolved = self.resolved;
        for ResolvedInstruction { place, command } in body {
            if (self.stop)() {
                return Err(Interrupted);
            }
            match command {
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
                command => {
                    self.sequencer.start(self.instruction, *place, self.occupancy.loaded());
                    self.instruction += 1;
                    self.execute(*place, command, passes);
                }
            }
        }
        Ok(())
    }

    fn execute(&mut self, place: SourceLocation, command: &ResolvedCommand, passes: &[u64]) {
        match *command {
            ResolvedCommand::Home => self.sequencer.home(),
            ResolvedCommand::Move(ref targets) => {
                let done = self.sequencer.move_axes(targets);
                self.report(place, done);
            }
            ResolvedCommand::MoveLine { effector, by } => {
                let done = self.sequencer.move_line(effector, by);
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
                    let done = self.sequencer.goto(effector, slot);
                    self.report(place, done);
                }
            }
            ResolvedCommand::Wait(seconds) => self.sequencer.dwell(Path::Dwell(seconds)),
            ResolvedCommand::Speed(fraction) => self.sequencer.speed_scaling = fraction,
            ResolvedCommand::Blend(radius) => self.sequencer.blend_radius = radius,
            ResolvedCommand::Tilt(tilt) => {
                let done = self.sequencer.tilt(tilt);
                self.report(place, done);
            }
            ResolvedCommand::Unresolved => self.occupancy.invalidate(),
            ResolvedCommand::Call(_) | ResolvedCommand::Repeat { .. } => {
                unreachable!("executed by `block`")
            }
        }
    }

    fn report(&mut self, place: SourceLocation, done: Result<(), ProgramProblem>) {
        if let Err(problem) = done {
            self.errors.add(place, problem);
        }
    }

    /// The slot of this pass, if the station has it.
    fn slot(&mut self, slot: ResolvedSlot, passes: &[u64]) -> Option<SlotId> {
        let found = match slot.number {
            ResolvedSlotNumber::Fixed(number) => number,
            ResolvedSlotNumber::Counted { repeat, offset, down } => {
                let pass = i128::from(passes[repeat]);
                i128::from(offset) + if down { -pass } else { pass }
            }
        };
        let station = &self.sequencer.cell.stations[slot.station];
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

    fn get(
        &mut self,
        place: SourceLocation,
        from: ResolvedSlot,
        effector: EffectorId,
        passes: &[u64],
    ) {
        let Some(slot) = self.slot(from, passes) else {
            self.occupancy.invalidate();
            return;
        };
        let handoff = Handoff::Picked(effector, slot);
        for problem in self.occupancy.problems(handoff) {
            self.errors.add(place, problem);
        }
        let process_time = self.sequencer.cell.stations[slot.station].process_time;
        let placed_at_step = self.occupancy.placed_by(slot).filter(|_| process_time > 0.0);
        let wait = placed_at_step
            .map(|step| Path::ProcessDwell { placed_at_step: step, seconds: process_time });
        let done = self.sequencer.get(effector, slot, wait);
        self.hand_off(handoff, place, done);
    }

    fn put(
        &mut self,
        place: SourceLocation,
        to: ResolvedSlot,
        effector: EffectorId,
        passes: &[u64],
    ) {
        let Some(slot) = self.slot(to, passes) else {
            self.occupancy.invalidate();
            return;
        };
        let handoff = Handoff::Placed(effector, slot);
        for problem in self.occupancy.problems(handoff) {
            self.errors.add(place, problem);
        }
        let done = self.sequencer.put(effector, slot);
        self.hand_off(handoff, place, done);
    }

    /// Applies a hand-off at the end of the step that the sequencer returned.
    fn hand_off(
        &mut self,
        handoff: Handoff,
        place: SourceLocation,
        done: Result<usize, ProgramProblem>,
    ) {
        let step = done.as_ref().ok().copied();
        self.report(place, done.map(|_| ()));
        self.occupancy.apply(handoff, place, step);
    }
}
