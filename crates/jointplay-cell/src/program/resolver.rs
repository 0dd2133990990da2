//! State of the resolution of a program's names.

use std::collections::BTreeMap;

use super::parameter_kinds::ParameterKinds;
use super::{Name, Program, ProgramError, ProgramProblem, SourceLocation};
use crate::workcell::Cell;

/// A program and its cell, and the errors so far.
pub(super) struct Resolver<'p> {
    pub(super) cell: &'p Cell,
    pub(super) program: &'p Program,
    /// Index and line of each routine, by name.
    pub(super) routines: BTreeMap<&'p str, (usize, usize)>,
    pub(super) kinds: ParameterKinds,
    /// Values of the parameters of the program, by name; `None` where the value has an error.
    pub(super) parameters: BTreeMap<&'p str, (Option<f64>, usize)>,
    pub(super) errors: Vec<ProgramError>,
}

impl Resolver<'_> {
    pub(super) fn error(&mut self, place: SourceLocation, problem: ProgramProblem) {
        self.errors.push(ProgramError::new(place, problem));
    }

    /// A value, or `None` with its error recorded.
    pub(super) fn checked<T>(
        &mut self,
        place: SourceLocation,
        result: Result<T, ProgramProblem>,
    ) -> Option<T> {
        result.map_err(|problem| self.error(place, problem)).ok()
    }

    pub(super) fn unknown(&mut self, what: &'static str, name: &Name, known: Vec<String>) {
        let found = name.text.clone();
        self.error(name.place, ProgramProblem::Unknown { what, found, known });
    }
}
