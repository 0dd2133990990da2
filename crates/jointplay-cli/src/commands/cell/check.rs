//! `jointplay cell check`: whether a program may be run.

use clap::Args;

use super::input::InputArgs;
use super::text;
use crate::failure::Failure;
use crate::output;

/// Check a program: reach, limits, slip, collisions, zones; instruction by instruction
///
/// Nothing is hidden by the first fault: all that is wrong with the files is told with line and column, and all that is wrong with the motion with its moment.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell check
  jointplay cell check --format json

Exit codes: 0 sound, 1 not safe to run or not reachable, 2 bad input or usage, 130 interrupted.")]
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
        planned.verdict()
    }
}
