//! Bounds on the expansion of a program, checked before it is expanded.

use std::collections::BTreeMap;

use super::problem::Count;
use super::resolved::{ResolvedCommand, ResolvedInstruction, ResolvedProgram};
use super::{Program, ProgramProblem, SourceLocation};

/// Largest number of instructions of an expanded program.
pub const MAX_INSTRUCTIONS: u64 = 20_000;

/// Largest nesting depth of CALL, REPEAT and IF.
pub const MAX_CALL_DEPTH: usize = 64;

/// Name of the whole program in messages, for a program that is too long without any instruction that is.
pub(super) const WHOLE: &str = "the program";

/// Location of a construct that exceeds a bound, and the problem.
type ProgramBoundsError = (SourceLocation, Box<ProgramProblem>);

/// Checks that a program expands to at most [`MAX_INSTRUCTIONS`], nested to at most [`MAX_CALL_DEPTH`]; parts whose size depends on counters, arguments or wafers count with their least size.
///
/// # Errors
/// The first construct that exceeds a bound.
pub(super) fn check_bounds(
    program: &Program,
    resolved: &ResolvedProgram,
) -> Result<(), ProgramBoundsError> {
    let mut counter =
        BlockCounter { program, resolved, known: BTreeMap::new(), running: Vec::new() };
    let size = counter.block(&resolved.body, 0)?;
    if size.instructions <= MAX_INSTRUCTIONS {
        return Ok(());
    }
    let place = program.body.first().map_or_else(SourceLocation::default, |first| first.place);
    Err(too_long(place, WHOLE, size.instructions))
}

fn too_long(place: SourceLocation, what: &'static str, found: u64) -> ProgramBoundsError {
    let problem = ProgramProblem::TooLong { what, found: Count(found), allowed: MAX_INSTRUCTIONS };
    (place, Box::new(problem))
}

/// A number of passes, which is whole and not negative.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole, and from 0 to 1e15"
)]
pub(super) fn passes(times: f64) -> u64 {
    times as u64
}

/// Size of an expanded block.
#[derive(Clone, Copy)]
struct BlockSize {
    instructions: u64,
    /// Nesting depth of blocks and routines.
    depth: usize,
}

/// Counts the instructions of an expanded program without expanding it.
struct BlockCounter<'p> {
    program: &'p Program,
    resolved: &'p ResolvedProgram,
    /// Sizes of routines that have been counted.
    known: BTreeMap<usize, BlockSize>,
    /// Routines that are being counted, the caller before the callee.
    running: Vec<usize>,
}

impl BlockCounter<'_> {
    fn block(
        &mut self,
        body: &[ResolvedInstruction],
        outer: usize,
    ) -> Result<BlockSize, ProgramBoundsError> {
        let mut sum = BlockSize { instructions: 0, depth: 0 };
        for instruction in body {
            let (what, instructions, depth) = match &instruction.command {
                ResolvedCommand::Repeat { times, body, .. } => {
                    self.enter(instruction.place, outer + 1)?;
                    let pass = self.block(body, outer + 1)?;
                    // A number of passes that is known during the expansion only is bounded there.
                    let times = times.number.constant().unwrap_or(0.0);
                    // An empty pass also takes time and counts as one instruction.
                    let all = pass.instructions.max(1).saturating_mul(passes(times));
                    ("this REPEAT", all, 1 + pass.depth)
                }
                ResolvedCommand::If { branches, otherwise } => {
                    self.enter(instruction.place, outer + 1)?;
                    let mut least = self.block(otherwise, outer + 1)?;
                    for branch in branches {
                        let size = self.block(&branch.body, outer + 1)?;
                        least.instructions = least.instructions.min(size.instructions);
                        least.depth = least.depth.max(size.depth);
                    }
                    ("", least.instructions.saturating_add(1), 1 + least.depth)
                }
                ResolvedCommand::Call { routine, .. } => {
                    self.enter(instruction.place, outer + 1)?;
                    let called = self.routine(instruction.place, *routine, outer + 1)?;
                    self.enter(instruction.place, outer + 1 + called.depth)?;
                    ("this CALL", called.instructions.saturating_add(1), 1 + called.depth)
                }
                _ => ("", 1, 0),
            };
            if instructions > MAX_INSTRUCTIONS && !what.is_empty() {
                return Err(too_long(instruction.place, what, instructions));
            }
            sum.instructions = sum.instructions.saturating_add(instructions);
            sum.depth = sum.depth.max(depth);
        }
        Ok(sum)
    }

    fn enter(&self, place: SourceLocation, depth: usize) -> Result<(), ProgramBoundsError> {
        if depth <= MAX_CALL_DEPTH {
            return Ok(());
        }
        Err((place, Box::new(ProgramProblem::TooDeep { allowed: MAX_CALL_DEPTH })))
    }

    fn routine(
        &mut self,
        place: SourceLocation,
        index: usize,
        outer: usize,
    ) -> Result<BlockSize, ProgramBoundsError> {
        if let Some(from) = self.running.iter().position(|&running| running == index) {
            let cycle = self.running[from..].iter().chain([&index]);
            let name = |&routine: &usize| self.program.routines[routine].name.text.clone();
            let problem = ProgramProblem::Recursive { routines: cycle.map(name).collect() };
            return Err((place, Box::new(problem)));
        }
        if let Some(&known) = self.known.get(&index) {
            return Ok(known);
        }
        self.running.push(index);
        let resolved = self.resolved;
        let size = self.block(&resolved.routines[index].body, outer)?;
        self.running.pop();
        self.known.insert(index, size);
        Ok(size)
    }
}
