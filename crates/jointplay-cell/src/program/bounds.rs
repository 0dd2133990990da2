//! How long a program runs, before it does.

use std::collections::BTreeMap;

use super::problem::Count;
use super::resolve::{Line, Resolved, ResolvedCommand};
use super::{Place, Program, ProgramProblem};

/// Most instructions that a program may come to, routines and passes counted out.
pub const MAX_INSTRUCTIONS: u64 = 20_000;

/// How deep CALL and REPEAT may stand within each other.
pub const MAX_CALLS: usize = 64;

/// What is too long where no one line is.
pub(super) const WHOLE: &str = "the program";

/// Where a program becomes too long or too deep, and how.
type UnboundedProgram = (Place, ProgramProblem);

/// That a program comes to its end within [`MAX_INSTRUCTIONS`] and [`MAX_CALLS`].
///
/// # Errors
/// The first place that keeps it from that.
pub(super) fn check_bounds(program: &Program, resolved: &Resolved) -> Result<(), UnboundedProgram> {
    let mut counter =
        BlockCounter { program, resolved, known: BTreeMap::new(), running: Vec::new() };
    let extent = counter.block(&resolved.body, 0)?;
    if extent.instructions <= MAX_INSTRUCTIONS {
        return Ok(());
    }
    let place = program.body.first().map_or_else(Place::default, |first| first.place);
    Err(too_long(place, WHOLE, extent.instructions))
}

fn too_long(place: Place, what: &'static str, found: u64) -> UnboundedProgram {
    (place, ProgramProblem::TooLong { what, found: Count(found), allowed: MAX_INSTRUCTIONS })
}

/// What a block comes to.
#[derive(Clone, Copy)]
struct BlockSize {
    instructions: u64,
    /// How many blocks and routines stand within each other.
    depth: usize,
}

/// Counts how many instructions a program comes to, before any is run.
struct BlockCounter<'p> {
    program: &'p Program,
    resolved: &'p Resolved,
    /// Of routines that have been counted.
    known: BTreeMap<usize, BlockSize>,
    /// Routines that are being counted, the caller before the called.
    running: Vec<usize>,
}

impl BlockCounter<'_> {
    fn block(&mut self, body: &[Line], outer: usize) -> Result<BlockSize, UnboundedProgram> {
        let mut sum = BlockSize { instructions: 0, depth: 0 };
        for line in body {
            let (what, instructions, depth) = match &line.act {
                ResolvedCommand::Repeat { times, body } => {
                    self.enter(line.place, outer + 1)?;
                    let each = self.block(body, outer + 1)?;
                    // An empty pass takes its time to run through as well.
                    let all = each.instructions.max(1).saturating_mul(*times);
                    ("this REPEAT", all, 1 + each.depth)
                }
                ResolvedCommand::Call(routine) => {
                    self.enter(line.place, outer + 1)?;
                    let called = self.routine(line.place, *routine, outer + 1)?;
                    self.enter(line.place, outer + 1 + called.depth)?;
                    ("this CALL", called.instructions.saturating_add(1), 1 + called.depth)
                }
                _ => ("", 1, 0),
            };
            if instructions > MAX_INSTRUCTIONS {
                return Err(too_long(line.place, what, instructions));
            }
            sum.instructions = sum.instructions.saturating_add(instructions);
            sum.depth = sum.depth.max(depth);
        }
        Ok(sum)
    }

    fn enter(&self, place: Place, depth: usize) -> Result<(), UnboundedProgram> {
        if depth <= MAX_CALLS {
            return Ok(());
        }
        let problem = ProgramProblem::TooDeep { allowed: MAX_CALLS };
        Err((place, problem))
    }

    fn routine(
        &mut self,
        place: Place,
        index: usize,
        outer: usize,
    ) -> Result<BlockSize, UnboundedProgram> {
        if let Some(from) = self.running.iter().position(|&running| running == index) {
            let circle = self.running[from..].iter().chain([&index]);
            let name = |&routine: &usize| self.program.routines[routine].name.text.clone();
            let problem = ProgramProblem::Recursive { routines: circle.map(name).collect() };
            return Err((place, problem));
        }
        if let Some(&known) = self.known.get(&index) {
            return Ok(known);
        }
        self.running.push(index);
        let resolved = self.resolved;
        let extent = self.block(&resolved.routines[index], outer)?;
        self.running.pop();
        self.known.insert(index, extent);
        Ok(extent)
    }
}
