//! Names of numbers, stations, effectors and routines, as an instruction sees them.

use super::effector_choice::{effector_name, names};
use super::parameter_kind::ParameterKind;
use super::resolved::{
    EffectorReference, ResolvedArgument, ResolvedCommand, ResolvedCondition, ResolvedLocation,
    ResolvedNumber, ResolvedSlot, StationReference, Variable,
};
use super::resolver::Resolver;
use super::{Condition, Name, Number, ProgramProblem, Routine, SlotName};
use crate::robot::EffectorId;

/// Kinds of names, in messages.
pub(super) const ROUTINE: &str = "the routine";
pub(super) const VARIABLE: &str = "the counter or parameter";
const STATION: &str = "the station";
const EFFECTOR: &str = "the effector";

/// Names that are defined around an instruction.
#[derive(Default)]
pub(super) struct Scope<'p> {
    /// Index of the routine, and its parameters.
    routine: Option<(usize, &'p [Name])>,
    /// Counters of the REPEATs around the instruction, outermost first.
    pub(super) counters: Vec<Option<&'p Name>>,
}

impl<'p> Scope<'p> {
    pub(super) fn of_routine(index: usize, routine: &'p Routine) -> Self {
        Self { routine: Some((index, &routine.parameters)), counters: Vec::new() }
    }

    /// Index of the parameter of the routine with a name.
    fn argument(&self, name: &str) -> Option<usize> {
        self.routine?.1.iter().position(|parameter| parameter.text == name)
    }
}

impl<'p> Resolver<'p> {
    /// Evaluates the parameters of the program, each from those before it.
    pub(super) fn evaluate_parameters(&mut self) {
        for parameter in &self.program.parameters {
            let name = &parameter.name;
            self.check_free(name, &Scope::default());
            let number = self.number(&parameter.value, &Scope::default());
            let value = number.and_then(|number| {
                let found = number.constant()?;
                let [min, max] = parameter.range.unwrap_or([f64::MIN, f64::MAX]);
                if (min..=max).contains(&found) {
                    return Some(found);
                }
                let problem = ProgramProblem::Parameter {
                    name: name.text.clone(),
                    found,
                    unit: parameter.unit,
                    range: parameter.range,
                };
                self.error(number.place, problem);
                None
            });
            self.parameters.entry(&name.text).or_insert((value, name.place.line));
        }
    }

    /// Names of the parameters of a routine.
    pub(super) fn routine_parameters(&mut self, parameters: &[Name]) -> Vec<String> {
        for (index, name) in parameters.iter().enumerate() {
            let first = parameters[..index].iter().find(|other| other.text == name.text);
            self.check_unused(name, first.map(|first| first.place.line));
        }
        parameters.iter().map(|name| name.text.clone()).collect()
    }

    /// Reports a counter or parameter whose name is in use.
    pub(super) fn check_free(&mut self, name: &Name, scope: &Scope<'_>) {
        let arguments = scope.routine.map_or(&[][..], |(_, parameters)| parameters);
        let outer = scope.counters.iter().flatten().copied().chain(arguments);
        let mut outer = outer.filter(|outer| outer.text == name.text);
        let line = outer.next().map(|outer| outer.place.line);
        self.check_unused(name, line);
    }

    fn check_unused(&mut self, name: &Name, line: Option<usize>) {
        let of_program = self.parameters.get(name.text.as_str()).map(|(_, line)| *line);
        if let Some(line) = line.or(of_program) {
            let problem =
                ProgramProblem::Duplicate { what: VARIABLE, name: name.text.clone(), line };
            self.error(name.place, problem);
        }
    }

    /// A number with its variables resolved.
    pub(super) fn number(&mut self, number: &Number, scope: &Scope<'_>) -> Option<ResolvedNumber> {
        let mut complete = true;
        let resolved = number.expression.try_map(|name| {
            let variable = self.variable(name, scope);
            complete &= variable.is_some();
            Ok::<_, ()>(variable.unwrap_or(Variable::Constant(f64::NAN)))
        });
        let expression = resolved.ok().filter(|_| complete)?;
        Some(ResolvedNumber { place: number.place, expression })
    }

    fn variable(&mut self, name: &Name, scope: &Scope<'_>) -> Option<Variable> {
        let is_it = |counter: &Option<&Name>| counter.is_some_and(|it| it.text == name.text);
        if let Some(counter) = scope.counters.iter().rposition(is_it) {
            return Some(Variable::Counter(counter));
        }
        if let Some(argument) = scope.argument(&name.text) {
            return Some(Variable::Argument(argument));
        }
        match self.parameters.get(name.text.as_str()) {
            Some((value, _)) => value.map(Variable::Constant),
            None if name.text == "pi" => Some(Variable::Constant(std::f64::consts::PI)),
            None => {
                if let Some(line) = self.later_declaration(name) {
                    let problem = ProgramProblem::DeclaredLater { name: name.text.clone(), line };
                    self.error(name.place, problem);
                    return None;
                }
                let arguments = scope.routine.map_or(&[][..], |(_, parameters)| parameters);
                let inner = scope.counters.iter().flatten().copied().chain(arguments);
                let inner = inner.map(|it| it.text.clone());
                let outer = self.parameters.keys().map(|name| (*name).to_owned());
                let known = inner.chain(outer).collect();
                self.unknown(VARIABLE, name, known);
                None
            }
        }
    }

    /// Line of the declaration of a parameter after its use.
    fn later_declaration(&self, name: &Name) -> Option<usize> {
        let parameters = self.program.parameters.iter();
        let mut lines = parameters.filter(|one| one.name.text == name.text);
        lines.next().map(|one| one.name.place.line).filter(|&line| line > name.place.line)
    }

    /// A station, or the argument that is one.
    fn station(&mut self, name: &Name, scope: &Scope<'_>) -> Option<StationReference> {
        if let Some(argument) = scope.argument(&name.text) {
            return Some(StationReference::Argument(argument));
        }
        let stations = &self.cell.stations;
        let index = stations.iter().position(|station| station.name == name.text);
        if index.is_none() {
            let known = stations.iter().map(|station| station.name.clone()).collect();
            self.unknown(STATION, name, known);
        }
        index.map(StationReference::Fixed)
    }

    /// A named effector, the argument that is one, or the only one.
    pub(super) fn effector(
        &mut self,
        name: Option<&Name>,
        scope: &Scope<'_>,
    ) -> Option<EffectorReference> {
        let Some(name) = name else { return Some(EffectorReference::Only) };
        if let Some(argument) = scope.argument(&name.text) {
            return Some(EffectorReference::Argument(argument));
        }
        let found = self.effector_named(name);
        if found.is_none() {
            let all: Vec<EffectorId> = self.cell.robot.effectors().collect();
            let known = names(&self.cell.robot, &all);
            self.unknown(EFFECTOR, name, known);
        }
        found.map(EffectorReference::Fixed)
    }

    fn effector_named(&self, name: &Name) -> Option<EffectorId> {
        let robot = &self.cell.robot;
        robot.effectors().find(|&id| effector_name(robot, id) == name.text)
    }

    pub(super) fn slot(&mut self, name: &SlotName, scope: &Scope<'_>) -> Option<ResolvedSlot> {
        let station = self.station(&name.station, scope);
        let number = name.slot.as_ref().map(|number| self.number(number, scope));
        let place = name.station.place;
        let station = station?;
        if let (StationReference::Fixed(index), None) = (station, &number) {
            let station = &self.cell.stations[index];
            if station.slots > 1 {
                let (station, slots) = (station.name.clone(), station.slots);
                self.error(place, ProgramProblem::WhichSlot { station, slots });
                return None;
            }
        }
        let number = match number {
            Some(number) => Some(number?),
            None => None,
        };
        Some(ResolvedSlot { station, place, number })
    }

    /// A call, with its arguments as the routine uses them.
    pub(super) fn call(
        &mut self,
        name: &Name,
        arguments: &[Number],
        scope: &Scope<'_>,
    ) -> Option<ResolvedCommand> {
        let Some(&(routine, _)) = self.routines.get(name.text.as_str()) else {
            let known = self.routines.keys().map(|name| (*name).to_owned()).collect();
            self.unknown(ROUTINE, name, known);
            return None;
        };
        let program = self.program;
        let parameters = &program.routines[routine].parameters;
        if parameters.len() != arguments.len() {
            let problem = ProgramProblem::ArgumentCount {
                routine: name.text.clone(),
                parameters: parameters.iter().map(|name| name.text.clone()).collect(),
                found: arguments.len(),
            };
            self.error(name.place, problem);
            return None;
        }
        let resolved: Vec<Option<ResolvedArgument>> = arguments
            .iter()
            .enumerate()
            .map(|(index, argument)| match self.kinds.kind(routine, index) {
                None => Some(ResolvedArgument::Unused),
                Some(ParameterKind::Number) => {
                    self.number(argument, scope).map(ResolvedArgument::Number)
                }
                Some(kind) => match argument.expression.as_variable() {
                    Some(value) => self.named_argument(value, kind, scope),
                    None => {
                        let (routine, name) = (name.text.clone(), parameters[index].text.clone());
                        let problem = ProgramProblem::ArgumentKind { routine, name, kind };
                        self.error(argument.place, problem);
                        None
                    }
                },
            })
            .collect();
        let arguments = resolved.into_iter().collect::<Option<_>>()?;
        Some(ResolvedCommand::Call { routine, arguments })
    }

    /// An argument that is a station or an effector.
    fn named_argument(
        &mut self,
        name: &Name,
        kind: ParameterKind,
        scope: &Scope<'_>,
    ) -> Option<ResolvedArgument> {
        match kind {
            ParameterKind::Number => None,
            ParameterKind::Station => self.station(name, scope).map(ResolvedArgument::Station),
            ParameterKind::Effector => {
                self.effector(Some(name), scope).map(ResolvedArgument::Effector)
            }
            ParameterKind::Location => Some(match self.location(name, scope)? {
                ResolvedLocation::Slot(slot) => ResolvedArgument::Station(slot.station),
                ResolvedLocation::Effector(id) => {
                    ResolvedArgument::Effector(EffectorReference::Fixed(id))
                }
                ResolvedLocation::Argument { index, .. } => ResolvedArgument::Location(index),
            }),
        }
    }

    /// An effector, or the only slot of a station.
    fn location(&mut self, name: &Name, scope: &Scope<'_>) -> Option<ResolvedLocation> {
        let place = name.place;
        if let Some(index) = scope.argument(&name.text) {
            return Some(ResolvedLocation::Argument { index, place });
        }
        let stations = &self.cell.stations;
        let is_station = stations.iter().any(|station| station.name == name.text);
        match (self.effector_named(name), is_station) {
            (Some(effector), false) => Some(ResolvedLocation::Effector(effector)),
            (Some(_), true) => {
                let name = name.text.clone();
                self.error(place, ProgramProblem::AmbiguousLocation { name });
                None
            }
            (None, true) => {
                let slot = SlotName { station: name.clone(), slot: None };
                self.slot(&slot, scope).map(ResolvedLocation::Slot)
            }
            (None, false) => {
                let all: Vec<EffectorId> = self.cell.robot.effectors().collect();
                let stations = stations.iter().map(|station| station.name.clone());
                let known = stations.chain(names(&self.cell.robot, &all)).collect();
                self.unknown("the station or effector", name, known);
                None
            }
        }
    }

    pub(super) fn condition(
        &mut self,
        condition: &Condition,
        scope: &Scope<'_>,
    ) -> Option<ResolvedCondition> {
        Some(match condition {
            Condition::Comparison { left, relation, right, .. } => {
                let (left, right) = (self.number(left, scope), self.number(right, scope));
                let relation = *relation;
                ResolvedCondition::Comparison { left: left?, relation, right: right? }
            }
            Condition::Presence { location, occupied } => {
                let location = match &location.slot {
                    Some(_) => ResolvedLocation::Slot(self.slot(location, scope)?),
                    None => self.location(&location.station, scope)?,
                };
                ResolvedCondition::Presence { location, occupied: *occupied }
            }
            Condition::Not(condition) => {
                ResolvedCondition::Not(Box::new(self.condition(condition, scope)?))
            }
            Condition::All(conditions) => {
                ResolvedCondition::All(self.conditions(conditions, scope)?)
            }
            Condition::Any(conditions) => {
                ResolvedCondition::Any(self.conditions(conditions, scope)?)
            }
        })
    }

    fn conditions(
        &mut self,
        conditions: &[Condition],
        scope: &Scope<'_>,
    ) -> Option<Vec<ResolvedCondition>> {
        let all: Vec<_> = conditions.iter().map(|one| self.condition(one, scope)).collect();
        all.into_iter().collect()
    }
}
