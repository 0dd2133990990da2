//! Kinds of the parameters of routines, by their use.

use std::collections::{BTreeMap, VecDeque};

use super::parameter_kind::ParameterKind;
use super::{
    Name, Number, Program, ProgramError, ProgramProblem, ProgramVisitor, SourceLocation, Unit,
};

/// A parameter, by the indices of its routine and of itself.
type ParameterIndex = (usize, usize);

/// Kinds of the parameters of all routines; `None` for a parameter without use.
pub(super) struct ParameterKinds {
    kinds: Vec<Vec<Option<(ParameterKind, SourceLocation)>>>,
    pub(super) errors: Vec<ProgramError>,
}

impl ParameterKinds {
    /// Infers the kinds from the bodies of the routines, and from those that they call.
    pub(super) fn infer(program: &Program, routines: &BTreeMap<&str, (usize, usize)>) -> Self {
        let kinds = program.routines.iter().map(|one| vec![None; one.parameters.len()]).collect();
        let mut inferred = Self { kinds, errors: Vec::new() };
        // Parameters that are passed on, by the parameter of the called routine.
        let mut passed: BTreeMap<ParameterIndex, Vec<(ParameterIndex, SourceLocation)>> =
            BTreeMap::new();
        let mut found = VecDeque::new();
        for (index, routine) in program.routines.iter().enumerate() {
            let names = routine.parameters.iter().enumerate();
            let names = names.map(|(at, name)| (name.text.as_str(), at)).collect();
            let mut uses = Uses { names, routines, kinds: Vec::new(), passed: Vec::new() };
            uses.block(&routine.body);
            for (at, kind, place) in uses.kinds {
                found.push_back(((index, at), kind, place));
            }
            for (at, callee, place) in uses.passed {
                passed.entry(callee).or_default().push(((index, at), place));
            }
        }
        while let Some((at, kind, place)) = found.pop_front() {
            if let Some(kind) = inferred.add(program, at, kind, place) {
                for &(caller, place) in passed.get(&at).into_iter().flatten() {
                    found.push_back((caller, kind, place));
                }
            }
        }
        inferred
    }

    /// Adds a use; the kind of the parameter where it is new.
    fn add(
        &mut self,
        program: &Program,
        (routine, index): ParameterIndex,
        kind: ParameterKind,
        place: SourceLocation,
    ) -> Option<ParameterKind> {
        let known = self.kinds.get_mut(routine)?.get_mut(index)?;
        let Some((before, first)) = *known else {
            *known = Some((kind, place));
            return Some(kind);
        };
        let Some(both) = before.and(kind) else {
            let name = program.routines[routine].parameters[index].text.clone();
            let problem = ProgramProblem::ParameterUse { name, before, line: first.line, kind };
            self.errors.push(ProgramError::new(place, problem));
            return None;
        };
        *known = Some((both, first));
        (both != before).then_some(both)
    }

    /// Kind of a parameter.
    pub(super) fn kind(&self, routine: usize, index: usize) -> Option<ParameterKind> {
        self.kinds.get(routine)?.get(index)?.map(|(kind, _)| kind)
    }
}

/// Uses of the parameters of one routine.
struct Uses<'p> {
    names: BTreeMap<&'p str, usize>,
    routines: &'p BTreeMap<&'p str, (usize, usize)>,
    kinds: Vec<(usize, ParameterKind, SourceLocation)>,
    /// Parameters that are arguments of calls, with the parameters of the called routines.
    passed: Vec<(usize, ParameterIndex, SourceLocation)>,
}

impl ProgramVisitor for Uses<'_> {
    fn number(&mut self, number: &Number, _unit: Option<Unit>) {
        number.expression.variables().for_each(|name| self.name(name, ParameterKind::Number));
    }

    fn arguments(&mut self, routine: &Name, arguments: &[Number]) {
        let callee = self.routines.get(routine.text.as_str()).map(|(index, _)| *index);
        for (index, argument) in arguments.iter().enumerate() {
            match (argument.expression.as_variable(), callee) {
                (Some(name), Some(callee)) => {
                    if let Some(&at) = self.names.get(name.text.as_str()) {
                        self.passed.push((at, (callee, index), argument.place));
                    }
                }
                (Some(_), None) => {}
                (None, _) => self.number(argument, None),
            }
        }
    }

    fn station(&mut self, name: &Name) {
        self.name(name, ParameterKind::Station);
    }

    fn location(&mut self, name: &Name) {
        self.name(name, ParameterKind::Location);
    }

    fn effector(&mut self, name: &Name) {
        self.name(name, ParameterKind::Effector);
    }
}

impl Uses<'_> {
    fn name(&mut self, name: &Name, kind: ParameterKind) {
        if let Some(&at) = self.names.get(name.text.as_str()) {
            self.kinds.push((at, kind, name.place));
        }
    }
}
