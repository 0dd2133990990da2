//! Resolution of the names of a program in its cell.

use std::collections::BTreeMap;

use super::bounds::{WHOLE, check_bounds};
use super::effector_choice::{check_swap, choose_effector};
use super::parameter_kinds::ParameterKinds;
use super::quantity::{AllowedValues, Quantity, Unit};
use super::resolved::{
    EffectorChoice, EffectorReference, ResolvedBranch, ResolvedCommand, ResolvedInstruction,
    ResolvedProgram, ResolvedQuantity, ResolvedRoutine, ResolvedSlot, ResolvedTilt,
    StationReference,
};
use super::resolver::Resolver;
use super::scope::{ROUTINE, Scope, VARIABLE};
use super::{
    AxisTarget, Command, Instruction, Name, Number, Program, ProgramError, ProgramProblem,
    SlotName, SourceLocation,
};
use crate::robot::AxisKind;
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
    let mut errors = Vec::new();
    for (index, routine) in program.routines.iter().enumerate() {
        let Name { text, place } = &routine.name;
        if let Some(&(_, line)) = routines.get(text.as_str()) {
            let (what, name) = (ROUTINE, text.clone());
            errors.push(ProgramError::new(*place, ProgramProblem::Duplicate { what, name, line }));
        } else {
            routines.insert(text.as_str(), (index, place.line));
        }
    }
    let mut kinds = ParameterKinds::infer(program, &routines);
    errors.append(&mut kinds.errors);
    let parameters = BTreeMap::new();
    let mut resolver = Resolver { cell, program, routines, kinds, parameters, errors };
    resolver.evaluate_parameters();
    let mut resolved = ResolvedProgram {
        body: resolver.block(&program.body, &mut Scope::default()),
        routines: (program.routines.iter().enumerate())
            .map(|(index, routine)| {
                let parameters = resolver.routine_parameters(&routine.parameters);
                let body = resolver.block(&routine.body, &mut Scope::of_routine(index, routine));
                ResolvedRoutine { parameters, body }
            })
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
        errors.push(ProgramError::new(place, *problem));
        if whole || !resolved.mark_unresolved(place) {
            break;
        }
    }
    (None, errors)
}

/// Errors of single lines of a program that could not be parsed as a whole: names, units, unbounded repetition.
///
/// Unknown routines, counters and parameters are not reported, because they may be defined in the part that was not parsed; wafers and targets are not checked.
#[must_use]
pub fn name_errors(cell: &Cell, program: &Program) -> Vec<ProgramError> {
    let (_, mut errors) = resolve(cell, program);
    errors.retain(|error| {
        !matches!(
            error.problem,
            ProgramProblem::Unknown { what: ROUTINE | VARIABLE, .. }
                | ProgramProblem::ArgumentCount { .. }
        )
    });
    errors
}

/// Largest number of unbounded instructions that are reported together.
const MAX_UNBOUNDED: usize = 10;

impl<'p> Resolver<'p> {
    fn block(
        &mut self,
        body: &'p [Instruction],
        scope: &mut Scope<'p>,
    ) -> Vec<ResolvedInstruction> {
        let mut lines = Vec::with_capacity(body.len());
        for instruction in body {
            let command = self.command(instruction, scope).unwrap_or(ResolvedCommand::Invalid);
            lines.push(ResolvedInstruction { place: instruction.place, command });
        }
        lines
    }

    /// The command with its names resolved; `None` where it has an error, which is recorded.
    fn command(
        &mut self,
        instruction: &'p Instruction,
        scope: &mut Scope<'p>,
    ) -> Option<ResolvedCommand> {
        let place = instruction.place;
        Some(match &instruction.command {
            Command::Home => ResolvedCommand::Home,
            Command::Move { targets } => {
                let found: Vec<_> = targets.iter().map(|target| self.axis(target, scope)).collect();
                ResolvedCommand::Move(found.into_iter().collect::<Option<_>>()?)
            }
            Command::MoveLine { effector, by } => {
                let effector = self.choice(place, effector.as_ref(), &[], scope);
                let [x, y, z] = by.each_ref().map(|length| {
                    let (what, allowed) = ("the displacement", AllowedValues::LENGTH);
                    self.optional(what, length.as_ref(), allowed, scope)
                });
                ResolvedCommand::MoveLine { effector: effector?, by: [x?, y?, z?] }
            }
            Command::Get { from, effector } => {
                let (from, effector) = self.visit(place, from, effector.as_ref(), scope)?;
                ResolvedCommand::Get { from, effector }
            }
            Command::Put { to, effector } => {
                let (to, effector) = self.visit(place, to, effector.as_ref(), scope)?;
                ResolvedCommand::Put { to, effector }
            }
            Command::Goto { to, effector } => {
                let (to, effector) = self.visit(place, to, effector.as_ref(), scope)?;
                ResolvedCommand::Goto { to, effector }
            }
            Command::Transfer { from, to, effector } => {
                let (from, to) = (self.slot(from, scope), self.slot(to, scope));
                let named = self.effector(effector.as_ref(), scope);
                let (from, to, named) = (from?, to?, named?);
                let choice = EffectorChoice { named, place };
                self.check_choice(choice, &[from.station, to.station])?;
                ResolvedCommand::Transfer { from, to, effector: choice }
            }
            Command::Swap { at, get, put } => {
                let slot = self.slot(at, scope);
                let named = [get, put].map(|name| (name.place, self.effector(Some(name), scope)));
                let slot = slot?;
                let [get, put] =
                    named.map(|(place, named)| named.map(|named| EffectorChoice { named, place }));
                let (get, put) = (get?, put?);
                if let (EffectorReference::Fixed(one), EffectorReference::Fixed(other)) =
                    (get.named, put.named)
                {
                    self.checked(put.place, check_swap(self.cell, one, other))?;
                }
                let may = [get, put].map(|choice| self.check_choice(choice, &[slot.station]));
                may.into_iter().collect::<Option<Vec<()>>>()?;
                ResolvedCommand::Swap { at: slot, get, put }
            }
            Command::Wait { duration } => ResolvedCommand::Wait(self.quantity(
                "the time",
                duration,
                AllowedValues::TIME,
                scope,
            )?),
            Command::Speed { fraction } => ResolvedCommand::Speed(self.quantity(
                "the share of the limits",
                fraction,
                AllowedValues::SPEED,
                scope,
            )?),
            Command::Blend { radius } => {
                let (what, allowed) = ("the radius of blending", AllowedValues::BLEND_RADIUS);
                ResolvedCommand::Blend(self.optional(what, radius.as_ref(), allowed, scope)?)
            }
            Command::Tilt { tilt: None } => ResolvedCommand::Tilt(None),
            Command::Tilt { tilt: Some(tilt) } => {
                let angle = self.quantity("the tilt", &tilt.angle, AllowedValues::TILT, scope);
                let azimuth =
                    self.quantity("the azimuth", &tilt.azimuth, AllowedValues::ANGLE, scope);
                ResolvedCommand::Tilt(Some(ResolvedTilt { angle: angle?, azimuth: azimuth? }))
            }
            Command::Call { routine, arguments } => self.call(routine, arguments, scope)?,
            Command::Repeat { times, counter, body } => {
                self.repeat(times, counter.as_ref(), body, scope)?
            }
            Command::If { branches, otherwise } => {
                let mut resolved = Vec::with_capacity(branches.len());
                for branch in branches {
                    let condition = self.condition(&branch.condition, scope);
                    let body = self.block(&branch.body, scope);
                    resolved.push(condition.map(|condition| ResolvedBranch { condition, body }));
                }
                let otherwise = self.block(otherwise, scope);
                let branches = resolved.into_iter().collect::<Option<_>>()?;
                ResolvedCommand::If { branches, otherwise }
            }
        })
    }

    fn repeat(
        &mut self,
        times: &'p Number,
        counter: Option<&'p Name>,
        body: &'p [Instruction],
        scope: &mut Scope<'p>,
    ) -> Option<ResolvedCommand> {
        let times = self.number(times, scope);
        if let Some(name) = counter {
            self.check_free(name, scope);
        }
        scope.counters.push(counter);
        let body = self.block(body, scope);
        scope.counters.pop();
        let (what, allowed) = ("the number of passes", AllowedValues::PASSES);
        let times = self.allowed(ResolvedQuantity { what, number: times?, allowed })?;
        Some(ResolvedCommand::Repeat { times, counter: counter.map(|it| it.text.clone()), body })
    }

    /// A quantity, checked where it is constant.
    fn quantity(
        &mut self,
        what: &'static str,
        quantity: &Quantity,
        allowed: AllowedValues,
        scope: &Scope<'_>,
    ) -> Option<ResolvedQuantity> {
        let number = self.number(&quantity.number, scope)?;
        self.allowed(ResolvedQuantity { what, number, allowed })
    }

    /// A quantity where there is one.
    fn optional(
        &mut self,
        what: &'static str,
        quantity: Option<&Quantity>,
        allowed: AllowedValues,
        scope: &Scope<'_>,
    ) -> Option<Option<ResolvedQuantity>> {
        match quantity {
            Some(quantity) => self.quantity(what, quantity, allowed, scope).map(Some),
            None => Some(None),
        }
    }

    /// The quantity, if it may have an allowed value.
    fn allowed(&mut self, quantity: ResolvedQuantity) -> Option<ResolvedQuantity> {
        let ResolvedQuantity { what, number, allowed } = &quantity;
        if let Some(found) = number.constant().filter(|&value| !allowed.contains(value)) {
            let (what, allowed) = (*what, *allowed);
            self.error(number.place, ProgramProblem::Value { what, found, allowed });
            return None;
        }
        Some(quantity)
    }

    fn axis(
        &mut self,
        target: &AxisTarget,
        scope: &Scope<'_>,
    ) -> Option<(usize, ResolvedQuantity)> {
        let axes = &self.cell.robot.axes;
        let Some(index) = axes.iter().position(|axis| axis.name == target.axis.text) else {
            let known = axes.iter().map(|axis| axis.name.clone()).collect();
            self.unknown("the axis", &target.axis, known);
            return None;
        };
        let axis = &axes[index];
        let (unit, allowed) = match axis.kind {
            AxisKind::Rotary => (Unit::Degree, AllowedValues::ANGLE),
            AxisKind::Linear => (Unit::Millimeter, AllowedValues::LENGTH),
        };
        if target.position.unit != unit {
            let (name, kind) = (axis.name.clone(), axis.kind);
            self.error(target.axis.place, ProgramProblem::AxisUnit { axis: name, kind });
            return None;
        }
        Some((index, self.quantity("the position", &target.position, allowed, scope)?))
    }

    /// The effector of an instruction without stations or with those that are known, checked where all are known.
    fn choice(
        &mut self,
        place: SourceLocation,
        name: Option<&Name>,
        stations: &[StationReference],
        scope: &Scope<'_>,
    ) -> Option<EffectorChoice> {
        let named = self.effector(name, scope)?;
        let choice = EffectorChoice { named, place: name.map_or(place, |name| name.place) };
        self.check_choice(choice, stations)?;
        Some(choice)
    }

    /// Checks an effector where neither it nor the stations depend on arguments.
    fn check_choice(
        &mut self,
        choice: EffectorChoice,
        stations: &[StationReference],
    ) -> Option<()> {
        let named = match choice.named {
            EffectorReference::Fixed(id) => Some(id),
            EffectorReference::Only => None,
            EffectorReference::Argument(_) => return Some(()),
        };
        let fixed = stations.iter().map(|station| match station {
            StationReference::Fixed(index) => Some(*index),
            StationReference::Argument(_) => None,
        });
        let Some(fixed) = fixed.collect::<Option<Vec<usize>>>() else { return Some(()) };
        self.checked(choice.place, choose_effector(self.cell, named, &fixed)).map(|_| ())
    }

    /// A slot and the effector that uses it.
    fn visit(
        &mut self,
        place: SourceLocation,
        slot: &SlotName,
        effector: Option<&Name>,
        scope: &Scope<'_>,
    ) -> Option<(ResolvedSlot, EffectorChoice)> {
        let slot = self.slot(slot, scope);
        let named = self.effector(effector, scope);
        let (slot, named) = (slot?, named?);
        let choice = EffectorChoice { named, place: effector.map_or(place, |name| name.place) };
        self.check_choice(choice, &[slot.station])?;
        Some((slot, choice))
    }
}
