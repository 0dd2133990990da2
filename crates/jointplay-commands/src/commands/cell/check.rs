//! `jointplay cell check`: the check of a program.

use clap::Args;

use super::input::InputArgs;
use super::text;
use crate::failure::Failure;
use crate::output;

/// Check a program for reach, limits, slip, collisions and zones, instruction by instruction
///
/// Reports every file error (line, column) and every violation of the trajectory (time), not just the first.
/// A program with `PARAMETER lot = 25` runs with another value by `--set lot=13`.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell check
  jointplay cell check --format json

Exit codes: 0 no violations, 1 violations or unreachable, 2 bad input or usage, 130 interrupted.")]
pub(super) struct Check {
    #[command(flatten)]
    pub(super) input: InputArgs,
}

impl Check {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let planned = self.input.plan()?;
        let document = planned.document();
        if self.input.format().json() {
            output::json(&document)?;
        } else {
            output::text(&text::report(&document, &planned))?;
        }
        planned.exit()
    }
}
