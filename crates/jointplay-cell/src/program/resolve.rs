//! Resolution of the names of a program in its cell.

use std::collections::BTreeMap;

use super::bounds::{WHOLE, check_bounds};
use super::resolved::{
    ResolvedCommand, ResolvedInstruction, ResolvedProgram, ResolvedSlot, ResolvedSlotNumber,
};
use super::{
    AxisTarget, Command, Instruction, Name, Program, ProgramError, ProgramProblem, SlotName,
    SlotNumber, SourceLocation,
};
use crate::robot::{EffectorId, HybridRobot};
use crate::workcell::Cell;

/// Resolves all names of a program.
///
/// # Errors
/// All errors; where the program can be expanded all the same, to find further errors, it is returned with them.
pub(super) fn resolve(
    cell: &Cell,
    program: &Program,
) -> (Option<ResolvedProgram>, Vec<ProgramError>) {
    let mut routines = BTreeMap::new();
    let mut resolver = Resolver { cell, routines: BTreeMap::new(), errors: Vec::new() };
    for (index, routine) in program.routines.iter().enumerate() {
        let Name { text, place } = &routine.name;
        if let Some(&(_, line)) = routines.get(text.as_str()) {
            let (what, name) = (ROUTINE, text.clone());
            resolver.error(*place, ProgramProblem::Duplicate { what, name, line });
        } else {
            routines.insert(text.as_str(), (index, place.line));
        }
    }
    resolver.routines = routines;
    let mut resolved = ResolvedProgram {
        body: resolver.block(&program.body, &mut Vec::new()),
        routines: (program.routines.iter())
            .map(|routine| resolver.block(&routine.body, &mut Vec::new()))
            .collect(),
    };
    let mut errors = resolver.errors;
    // Unbounded parts are excluded, so that further errors are found.
    for _ in 0..MAX_UNBOUNDED {
        let Err((place, problem)) = check_bounds(program, &resolved) else {
            return (Some(resolved), errors);
        };
        // No single instruction is the cause.
        let whole = matches!(
            *problem,
            ProgramProblem::TooDeep { .. } | ProgramProblem::TooLong { what: WHOLE, .. }
        );
        errors.push(ProgramError { place, problem: *problem, repetitions: 0 });
        if whole || !resolved.mark_unresolved(place) {
            break;
        }
    }
    (None, errors)
}

/// Errors of single lines of a program that could not be parsed as a whole: names, units, unbounded repetition.
///
/// Unknown routines and counters are not reported, because they may be defined in the part that was not parsed; wafers and targets are not checked.
#[must_use]
pub fn name_errors(cell: &Cell, program: &Program) -> Vec<ProgramError> {
    let (_, mut errors) = resolve(cell, program);
    errors.retain(|error| {
        !matches!(error.problem, ProgramProblem::Unknown { what: ROUTINE | COUNTER, .. })
    });
    errors
}

/// Kinds of names, in messages.
const ROUTINE: &str = "the routine";
const COUNTER: &str = "the counter";

/// Largest number of unbounded instructions that are reported together.
const MAX_UNBOUNDED: usize = 10;

struct Resolver<'p> {
    cell: &'p Cell,
    /// Index and line of each routine, by name.
    routines: BTreeMap<&'p str, (usize, usize)>,
    errors: Vec<ProgramError>,
}

/// The counters of the REPEATs around an instruction, outermost first.
type Counters<'p> = Vec<Option<&'p Name>>;

impl<'p> Resolver<'p> {
    fn error(&mut self, place: SourceLocation, problem: ProgramProblem) {
        self.errors.push(ProgramError { place, problem, repetitions: 0 });
    }

    fn block(
        &mut self,
        body: &'p [Instruction],
        counters: &mut Counters<'p>,
    ) -> Vec<ResolvedInstruction> {
        let mut lines = Vec::with_capacity(body.len());
        for instruction in body {
            let command =
                self.command(instruction, counters).unwrap_or(ResolvedCommand::Unresolved);
            lines.push(ResolvedInstruction { place: instruction.place, command });
        }
        lines
    }

    /// The command with its names resolved; `None` where it has an error, which is recorded.
    fn command(
        &mut self,
        instruction: &'p Instruction,
        counters: &mut Counters<'p>,
    ) -> Option<ResolvedCommand> {
        let place = instruction.place;
        Some(match &instruction.command {
            Command::Home => ResolvedCommand::Home,
            Command::Move { targets } => {
                let found: Vec<_> = targets.iter().map(|target| self.axis(target)).collect();
                ResolvedCommand::Move(found.into_iter().collect::<Option<_>>()?)
            }
            Command::MoveLine { effector, by } => {
                let effector = match effector {
                    Some(name) => self.effector(name),
                    None => self.only_one(place, "the robot has several effectors", &self.all()),
                };
                if let Some(&value) = by.iter().find(|length| !length.is_finite()) {
                    let allowed = "a finite length in m";
                    self.error(
                        place,
                        ProgramProblem::Range { what: "the displacement", value, allowed },
                    );
                    return None;
                }
                ResolvedCommand::MoveLine { effector: effector?, by: *by }
            }
            Command::Get { from, effector } => {
                let (from, effector) =
                    self.slot_and_effector(place, from, effector.as_ref(), counters)?;
                ResolvedCommand::Get { from, effector }
            }
            Command::Put { to, effector } => {
                let (to, effector) =
                    self.slot_and_effector(place, to, effector.as_ref(), counters)?;
                ResolvedCommand::Put { to, effector }
            }
            Command::Goto { to, effector } => {
                let (to, effector) =
                    self.slot_and_effector(place, to, effector.as_ref(), counters)?;
                ResolvedCommand::Goto { to, effector }
            }
            Command::Transfer { from, to, effector } => {
                let (from, to) = (self.slot(from, counters), self.slot(to, counters));
                let named = effector.as_ref().map(|name| self.effector(name));
                let (from, to) = (from?, to?);
                let effector = match named {
                    Some(found) => {
                        let found = found?;
                        let may = [from, to].map(|slot| self.may_use(place, found, slot.station));
                        may.iter().all(|may| *may).then_some(found)?
                    }
                    None => self.common_effector(place, from.station, to.station)?,
                };
                ResolvedCommand::Transfer { from, to, effector }
            }
            Command::Swap { at, get, put } => {
                let slot = self.slot(at, counters);
                let (picking, placing) = (self.effector(get), self.effector(put));
                let (slot, picking, placing) = (slot?, picking?, placing?);
                if picking == placing {
                    let effector = get.text.clone();
                    self.error(put.place, ProgramProblem::SameEffector { effector });
                    return None;
                }
                let may = [(get, picking), (put, placing)]
                    .map(|(name, id)| self.may_use(name.place, id, slot.station));
                may.iter().all(|may| *may).then_some(ResolvedCommand::Swap {
                    at: slot,
                    get: picking,
                    put: placing,
                })?
            }
            Command::Wait { seconds } => {
                let ok = seconds.is_finite() && *seconds >= 0.0;
                let allowed = "finite and not negative, in s";
                self.check_range(place, "the time", *seconds, ok, allowed)?;
                ResolvedCommand::Wait(*seconds)
            }
            Command::Speed { fraction } => {
                let ok = *fraction > 0.0 && *fraction <= 1.0;
                self.check_range(
                    place,
                    "the speed",
                    *fraction,
                    ok,
                    "a fraction above 0, at most 1",
                )?;
                ResolvedCommand::Speed(*fraction)
            }
            Command::Blend { radius } => {
                let ok = radius.is_finite() && *radius >= 0.0;
                let allowed = "finite and not negative, in m";
                self.check_range(place, "the radius of blending", *radius, ok, allowed)?;
                ResolvedCommand::Blend(*radius)
            }
            Command::Tilt { tilt } => {
                let ok = tilt.pitch.abs() < std::f64::consts::FRAC_PI_2;
                self.check_range(
                    place,
                    "the tilt",
                    tilt.pitch,
                    ok,
                    "less than a right angle, in rad",
                )?;
                let allowed = "finite, in rad";
                self.check_range(place, "the azimuth", tilt.yaw, tilt.yaw.is_finite(), allowed)?;
                ResolvedCommand::Tilt(*tilt)
            }
            Command::Call { routine } => {
                if let Some(&(index, _)) = self.routines.get(routine.text.as_str()) {
                    ResolvedCommand::Call(index)
                } else {
                    let known = self.routines.keys().map(|name| (*name).to_owned()).collect();
                    self.unknown(ROUTINE, routine, known);
                    return None;
                }
            }
            Command::Repeat { times, counter, body } => {
                let same = |outer: &&Name| Some(&outer.text) == counter.as_ref().map(|it| &it.text);
                if let Some(name) = counter
                    && let Some(outer) = counters.iter().flatten().find(|outer| same(outer))
                {
                    let (what, line) = (COUNTER, outer.place.line);
                    let problem = ProgramProblem::Duplicate { what, name: name.text.clone(), line };
                    self.error(name.place, problem);
                }
                counters.push(counter.as_ref());
                let body = self.block(body, counters);
                counters.pop();
                ResolvedCommand::Repeat { times: *times, body }
            }
        })
    }

    fn check_range(
        &mut self,
        place: SourceLocation,
        what: &'static str,
        value: f64,
        ok: bool,
        allowed: &'static str,
    ) -> Option<()> {
        if !ok {
            self.error(place, ProgramProblem::Range { what, value, allowed });
        }
        ok.then_some(())
    }

    fn unknown(&mut self, what: &'static str, name: &Name, known: Vec<String>) {
        let found = name.text.clone();
        self.error(name.place, ProgramProblem::Unknown { what, found, known });
    }

    fn axis(&mut self, target: &AxisTarget) -> Option<(usize, f64)> {
        let axes = &self.cell.robot.axes;
        let Some(index) = axes.iter().position(|axis| axis.name == target.axis.text) else {
            let known = axes.iter().map(|axis| axis.name.clone()).collect();
            self.unknown("the axis", &target.axis, known);
            return None;
        };
        let axis = &axes[index];
        if axis.kind != target.kind {
            let (name, kind) = (axis.name.clone(), axis.kind);
            self.error(target.axis.place, ProgramProblem::AxisUnit { axis: name, kind });
            return None;
        }
        let position = target.position;
        let finite = position.is_finite();
        self.check_range(target.axis.place, "the position", position, finite, "finite")?;
        Some((index, position))
    }

    fn all(&self) -> Vec<EffectorId> {
        effectors(&self.cell.robot)
    }

    fn effector(&mut self, name: &Name) -> Option<EffectorId> {
        let robot = &self.cell.robot;
        let found = self.all().into_iter().find(|&id| effector_name(robot, id) == name.text);
        if found.is_none() {
            let known = self.names(&self.all());
            self.unknown("the effector", name, known);
        }
        found
    }

    fn names(&self, ids: &[EffectorId]) -> Vec<String> {
        ids.iter().map(|&id| effector_name(&self.cell.robot, id).to_owned()).collect()
    }

    /// The only element of a list, or an error.
    fn only_one(
        &mut self,
        place: SourceLocation,
        context: &str,
        ids: &[EffectorId],
    ) -> Option<EffectorId> {
        if let &[only] = ids {
            return Some(only);
        }
        let (context, known) = (context.to_owned(), self.names(ids));
        self.error(place, ProgramProblem::WhichEffector { context, known });
        None
    }

    /// A slot and the effector that uses it.
    fn slot_and_effector(
        &mut self,
        place: SourceLocation,
        slot: &'p SlotName,
        effector: Option<&Name>,
        counters: &Counters<'p>,
    ) -> Option<(ResolvedSlot, EffectorId)> {
        let slot = self.slot(slot, counters);
        let named = effector.map(|name| (name.place, self.effector(name)));
        let slot = slot?;
        let station = &self.cell.stations[slot.station];
        let effector = match named {
            Some((place, found)) => {
                let found = found?;
                self.may_use(place, found, slot.station).then_some(found)?
            }
            None => {
                let context = format!("station {} is open to several effectors", station.name);
                self.only_one(place, &context, &station.effectors)?
            }
        };
        Some((slot, effector))
    }

    fn may_use(&mut self, place: SourceLocation, effector: EffectorId, station: usize) -> bool {
        let station = &self.cell.stations[station];
        let may = station.effectors.contains(&effector);
        if !may {
            let problem = ProgramProblem::NotAllowed {
                effector: effector_name(&self.cell.robot, effector).to_owned(),
                station: station.name.clone(),
                known: self.names(&station.effectors),
            };
            self.error(place, problem);
        }
        may
    }

    /// The only effector that may use two stations.
    fn common_effector(
        &mut self,
        place: SourceLocation,
        from: usize,
        to: usize,
    ) -> Option<EffectorId> {
        let (one, other) = (&self.cell.stations[from], &self.cell.stations[to]);
        let may = one.effectors.iter().filter(|id| other.effectors.contains(id));
        let both: Vec<EffectorId> = may.copied().collect();
        if both.is_empty() {
            let problem = ProgramProblem::NoCommonEffector {
                from: one.name.clone(),
                to: other.name.clone(),
                may_from: self.names(&one.effectors),
                may_to: self.names(&other.effectors),
            };
            self.error(place, problem);
            return None;
        }
        let context =
            format!("stations {} and {} are open to several effectors", one.name, other.name);
        self.only_one(place, &context, &both)
    }

    fn slot(&mut self, name: &'p SlotName, counters: &Counters<'p>) -> Option<ResolvedSlot> {
        let stations = &self.cell.stations;
        let index = stations.iter().position(|station| station.name == name.station.text);
        if index.is_none() {
            let known = stations.iter().map(|station| station.name.clone()).collect();
            self.unknown("the station", &name.station, known);
        }
        let (number, place) = match &name.slot {
            None => (Some(ResolvedSlotNumber::Fixed(1)), name.station.place),
            Some(SlotNumber::Fixed { number, place }) => (
                Some(ResolvedSlotNumber::Fixed(i128::try_from(*number).unwrap_or(i128::MAX))),
                *place,
            ),
            Some(SlotNumber::Counted { counter, offset, down }) => {
                let is_it = |it: &Option<&Name>| it.is_some_and(|it| it.text == counter.text);
                let number = counters.iter().rposition(is_it).map(|repeat| {
                    ResolvedSlotNumber::Counted { repeat, offset: *offset, down: *down }
                });
                if number.is_none() {
                    let known = counters.iter().flatten().map(|it| it.text.clone()).collect();
                    self.unknown(COUNTER, counter, known);
                }
                (number, counter.place)
            }
        };
        let station = index?;
        if let (None, slots @ 2..) = (&name.slot, stations[station].slots) {
            let station = name.station.text.clone();
            self.error(name.station.place, ProgramProblem::WhichSlot { station, slots });
            return None;
        }
        Some(ResolvedSlot { station, number: number?, place })
    }
}

pub(super) fn effectors(robot: &HybridRobot) -> Vec<EffectorId> {
    let arms = robot.arms.iter().enumerate();
    let on = |(arm, it): (usize, &crate::robot::Arm)| {
        (0..it.effectors.len()).map(move |effector| EffectorId { arm, effector })
    };
    arms.flat_map(on).collect()
}

pub(super) fn effector_name(robot: &HybridRobot, id: EffectorId) -> &str {
    &robot.arms[id.arm].effectors[id.effector].name
}
