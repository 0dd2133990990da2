//! From the instructions of a program to steps.

use jointplay_core::spatial::Tilt;

use super::bounds::{MAX_INSTRUCTIONS, passes};
use super::effector_choice::check_swap;
use super::expander::{Errors, ProgramExpander};
use super::frame::{ArgumentValue, Frame};
use super::ik_cache::IkCache;
use super::occupancy::WaferOccupancy;
use super::resolve::resolve;
use super::resolved::{
    EffectorChoice, EffectorReference, ResolvedArgument, ResolvedBranch, ResolvedCommand,
    ResolvedInstruction, ResolvedQuantity, ResolvedSlot, ResolvedTilt, StationReference,
};
use super::sequence::MotionSequencer;
use super::{
    Handoff, Path, Program, ProgramError, ProgramProblem, RobotState, SourceLocation, Step,
};
use crate::incremental::{Interrupted, StopRequested, uninterrupted};
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
    let start = RobotState::home(&cell.robot);
    let expanded = expand_by(cell, program, &start, &mut IkCache::default(), &|| false);
    uninterrupted(expanded).map(|expansion| expansion.steps)
}

/// The steps of a program, and the state of the robot after them.
pub(crate) struct Expansion {
    pub(crate) steps: Vec<Step>,
    pub(crate) end: RobotState,
}

/// As [`expand`], from another state and with the inverse kinematics of the last program; the state at the end is included.
pub(crate) fn expand_by(
    cell: &Cell,
    program: &Program,
    start: &RobotState,
    ik_cache: &mut IkCache,
    stop: StopRequested<'_>,
) -> Result<Result<Expansion, Vec<ProgramError>>, Interrupted> {
    let (resolved, unresolved) = resolve(cell, program);
    let mut errors = Errors::default();
    for error in unresolved {
        errors.add(error.place, error.problem, || error.context);
    }
    let (mut steps, mut end) = (Vec::new(), start.clone());
    if let Some(resolved) = &resolved {
        ik_cache.begin(cell);
        let mut expander = ProgramExpander {
            resolved,
            occupancy: WaferOccupancy::new(cell),
            sequencer: MotionSequencer::new(cell, ik_cache, start),
            errors: &mut errors,
            instruction: 0,
            work: 0,
            frames: vec![Frame::main()],
            stop,
        };
        if let Err(Ended::Interrupted) = expander.block(&resolved.body) {
            return Err(Interrupted);
        }
        end = expander.sequencer.state();
        steps = expander.sequencer.steps;
        ik_cache.end();
    }
    let errors: Vec<ProgramError> = errors.0.into_values().flatten().collect();
    Ok(if errors.is_empty() { Ok(Expansion { steps, end }) } else { Err(errors) })
}

/// Why the expansion ends before the end of the program.
enum Ended {
    Interrupted,
    /// The limit of instructions is reached; the error is recorded.
    LimitReached,
}

impl From<Interrupted> for Ended {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}

impl<'r> ProgramExpander<'r> {
    /// Counts an instruction, a call, a condition or an empty pass.
    fn count(&mut self, place: SourceLocation) -> Result<(), Ended> {
        if (self.stop)() {
            return Err(Ended::Interrupted);
        }
        self.work += 1;
        if self.work > MAX_INSTRUCTIONS {
            self.report(place, ProgramProblem::LimitReached { allowed: MAX_INSTRUCTIONS });
            return Err(Ended::LimitReached);
        }
        Ok(())
    }

    /// Executes a block.
    fn block(&mut self, body: &'r [ResolvedInstruction]) -> Result<(), Ended> {
        for ResolvedInstruction { place, command } in body {
            let place = *place;
            match command {
                ResolvedCommand::Repeat { times, counter, body } => {
                    let Some(times) = self.value(times) else {
                        self.occupancy.invalidate();
                        continue;
                    };
                    for pass in 1..=passes(times) {
                        let before = self.work;
                        self.frame_mut().counters.push((counter.as_deref(), pass));
                        self.block(body)?;
                        if self.work == before {
                            self.count(place)?;
                        }
                        self.frame_mut().counters.pop();
                    }
                }
                ResolvedCommand::Call { routine, arguments } => {
                    self.count(place)?;
                    self.call(place, *routine, arguments)?;
                }
                ResolvedCommand::If { branches, otherwise } => {
                    self.count(place)?;
                    self.choose(branches, otherwise)?;
                }
                command => {
                    self.count(place)?;
                    self.sequencer.start(self.instruction, place, self.occupancy.loaded());
                    self.instruction += 1;
                    self.execute(place, command);
                }
            }
        }
        Ok(())
    }

    /// Executes a routine with its arguments.
    fn call(
        &mut self,
        place: SourceLocation,
        routine: usize,
        arguments: &'r [ResolvedArgument],
    ) -> Result<(), Ended> {
        let mut values = Vec::with_capacity(arguments.len());
        for argument in arguments {
            values.push(match argument {
                ResolvedArgument::Number(number) => {
                    let Some(value) = self.finite("the argument", number) else {
                        self.occupancy.invalidate();
                        return Ok(());
                    };
                    ArgumentValue::Number(value)
                }
                ResolvedArgument::Station(StationReference::Fixed(station)) => {
                    ArgumentValue::Station(*station)
                }
                ResolvedArgument::Effector(EffectorReference::Fixed(effector)) => {
                    ArgumentValue::Effector(*effector)
                }
                ResolvedArgument::Station(StationReference::Argument(index))
                | ResolvedArgument::Effector(EffectorReference::Argument(index))
                | ResolvedArgument::Location(index) => self.frame().arguments[*index],
                ResolvedArgument::Effector(EffectorReference::Only) | ResolvedArgument::Unused => {
                    ArgumentValue::Unused
                }
            });
        }
        let resolved = self.resolved;
        let routine = &resolved.routines[routine];
        let counters = Vec::new();
        self.frames.push(Frame { routine: Some((routine, place)), arguments: values, counters });
        self.block(&routine.body)?;
        self.frames.pop();
        Ok(())
    }

    /// Executes the first branch whose condition holds; after an error, none of them.
    fn choose(
        &mut self,
        branches: &'r [ResolvedBranch],
        otherwise: &'r [ResolvedInstruction],
    ) -> Result<(), Ended> {
        for ResolvedBranch { condition, body } in branches {
            match self.holds(condition) {
                Some(true) => return self.block(body),
                Some(false) => {}
                None => {
                    self.occupancy.invalidate();
                    return Ok(());
                }
            }
        }
        self.block(otherwise)
    }

    fn execute(&mut self, place: SourceLocation, command: &ResolvedCommand) {
        match command {
            ResolvedCommand::Home => self.sequencer.home(),
            ResolvedCommand::Move(targets) => {
                let positions =
                    targets.iter().map(|(axis, position)| Some((*axis, self.si(position)?)));
                if let Some(positions) = positions.collect::<Option<Vec<_>>>() {
                    let done = self.sequencer.move_axes(&positions);
                    self.report_result(place, done);
                }
            }
            ResolvedCommand::MoveLine { effector, by } => self.move_line(place, *effector, by),
            ResolvedCommand::Get { from, effector } => {
                let visit = self.visit(from, *effector);
                self.get(place, visit);
            }
            ResolvedCommand::Put { to, effector } => {
                let visit = self.visit(to, *effector);
                self.put(place, visit);
            }
            ResolvedCommand::Transfer { from, to, effector } => {
                self.transfer(place, from, to, *effector);
            }
            ResolvedCommand::Swap { at, get, put } => self.swap(place, at, *get, *put),
            ResolvedCommand::Goto { to, effector } => {
                if let Some((to, effector)) = self.visit(to, *effector) {
                    let done = self.sequencer.goto(effector, to);
                    self.report_result(place, done);
                }
            }
            ResolvedCommand::Wait(duration) => {
                if let Some(seconds) = self.si(duration) {
                    self.sequencer.dwell(Path::Dwell(seconds));
                }
            }
            ResolvedCommand::Speed(fraction) => {
                if let Some(fraction) = self.si(fraction) {
                    self.sequencer.speed_scaling = fraction;
                }
            }
            ResolvedCommand::Blend(None) => self.sequencer.blend_radius = 0.0,
            ResolvedCommand::Blend(Some(radius)) => {
                if let Some(radius) = self.si(radius) {
                    self.sequencer.blend_radius = radius;
                }
            }
            ResolvedCommand::Tilt(target) => {
                let tilt = match target {
                    None => Some(Tilt::LEVEL),
                    Some(ResolvedTilt { angle, azimuth }) => {
                        let (angle, azimuth) = (self.si(angle), self.si(azimuth));
                        angle.zip(azimuth).map(|(angle, azimuth)| Tilt { azimuth, angle })
                    }
                };
                if let Some(tilt) = tilt {
                    let done = self.sequencer.tilt(tilt);
                    self.report_result(place, done);
                }
            }
            ResolvedCommand::Invalid => self.occupancy.invalidate(),
            ResolvedCommand::Call { .. }
            | ResolvedCommand::Repeat { .. }
            | ResolvedCommand::If { .. } => unreachable!("executed by `block`"),
        }
    }

    fn move_line(
        &mut self,
        place: SourceLocation,
        effector: EffectorChoice,
        by: &[Option<ResolvedQuantity>; 3],
    ) {
        let mut displacement = [Some(0.0); 3];
        for (component, length) in displacement.iter_mut().zip(by) {
            if let Some(length) = length {
                *component = self.si(length);
            }
        }
        let effector = self.effector(effector, &[]);
        if let (Some(effector), [Some(x), Some(y), Some(z)]) = (effector, displacement) {
            let done = self.sequencer.move_line(effector, [x, y, z]);
            self.report_result(place, done);
        }
    }

    /// A slot and the effector that uses it.
    fn visit(
        &mut self,
        slot: &ResolvedSlot,
        choice: EffectorChoice,
    ) -> Option<(SlotId, EffectorId)> {
        let slot = self.slot(slot);
        let effector = self.effector(choice, &[slot?.station]);
        slot.zip(effector)
    }

    fn transfer(
        &mut self,
        place: SourceLocation,
        from: &ResolvedSlot,
        to: &ResolvedSlot,
        choice: EffectorChoice,
    ) {
        let stations = [self.station(from.station), self.station(to.station)];
        let effector = match stations {
            [Some(from), Some(to)] => self.effector(choice, &[from, to]),
            _ => None,
        };
        let Some(effector) = effector else { return self.occupancy.invalidate() };
        let from = self.slot(from);
        self.get(place, from.map(|from| (from, effector)));
        let to = self.slot(to);
        self.put(place, to.map(|to| (to, effector)));
    }

    fn swap(
        &mut self,
        place: SourceLocation,
        at: &ResolvedSlot,
        get: EffectorChoice,
        put: EffectorChoice,
    ) {
        let slot = self.slot(at);
        let effectors = slot.and_then(|slot| {
            let [get, put] = [get, put].map(|choice| self.effector(choice, &[slot.station]));
            get.zip(put)
        });
        let Some((slot, (picking, placing))) = slot.zip(effectors) else {
            return self.occupancy.invalidate();
        };
        if let Err(problem) = check_swap(self.sequencer.cell, picking, placing) {
            self.report(put.place, problem);
            return self.occupancy.invalidate();
        }
        self.get(place, Some((slot, picking)));
        self.put(place, Some((slot, placing)));
    }

    /// Picks the wafer of a slot; without a slot and an effector, the occupancy is unknown.
    fn get(&mut self, place: SourceLocation, visit: Option<(SlotId, EffectorId)>) {
        let Some((slot, effector)) = visit else { return self.occupancy.invalidate() };
        let handoff = Handoff::Picked(effector, slot);
        for problem in self.occupancy.problems(handoff) {
            self.report(place, problem);
        }
        let process_time = self.sequencer.cell.stations[slot.station].process_time;
        let placed_at_step = self.occupancy.placed_by(slot).filter(|_| process_time > 0.0);
        let wait = placed_at_step
            .map(|step| Path::ProcessDwell { placed_at_step: step, seconds: process_time });
        let done = self.sequencer.get(effector, slot, wait);
        self.hand_off(handoff, place, done);
    }

    /// Places a wafer into a slot; without a slot and an effector, the occupancy is unknown.
    fn put(&mut self, place: SourceLocation, visit: Option<(SlotId, EffectorId)>) {
        let Some((slot, effector)) = visit else { return self.occupancy.invalidate() };
        let handoff = Handoff::Placed(effector, slot);
        for problem in self.occupancy.problems(handoff) {
            self.report(place, problem);
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
        self.report_result(place, done.map(|_| ()));
        self.occupancy.apply(handoff, place, step);
    }
}
