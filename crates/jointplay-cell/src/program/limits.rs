//! Limits of positions that a program commands.

use super::ProgramProblem;
use crate::workcell::Cell;

/// Checks positions that a command asks for against the limits of the robot.
pub(super) fn check_limits(
    cell: &Cell,
    what: &'static str,
    to: &[f64],
) -> Result<(), ProgramProblem> {
    let violations = cell.robot.limit_violations(to).unwrap_or_default();
    if violations.is_empty() { Ok(()) } else { Err(ProgramProblem::Limits { what, violations }) }
}
