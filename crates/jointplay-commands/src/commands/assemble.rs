//! `jointplay assemble`: closed configurations of a mechanism.

use std::fmt::Write as _;

use clap::Args;
use jointplay::format::number::counted;
use jointplay::mechanism::Posed;
use jointplay::report::{self, AssemblyReport};

use crate::arguments::whole;
use crate::failure::Failure;
use crate::mechanism_input::{Input, JointValues, MechanismArgs, ToleranceArgs, joint_values};
use crate::progress::Progress;

/// Close the loops of a mechanism, starting from the initial guess in its file
///
/// If rigid links cannot close for the values of --at, the virtual joints of the file are displaced by the least amount.
/// If the loops do not close, the command fails and reports the best mismatch.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay assemble four-bar
  jointplay assemble four-bar --at A=30
  jointplay assemble four-bar --at A=30 --branches 50
  jointplay assemble bennett --set b=0.1101 --tolerance 1e-3

Exit codes: 0 done, 1 the loops do not close, or a joint limit or clearance is exceeded, 2 bad input or usage.")]
pub(crate) struct Assemble {
    #[command(flatten)]
    pub(crate) mechanism: MechanismArgs,
    /// Commanded joint coordinates, in the units of the file
    #[arg(long, value_name = "JOINT=VALUE", value_parser = joint_values)]
    at: Vec<JointValues>,
    /// Also search for other closed configurations, from this number of random starts, until 16 are found
    #[arg(long, value_name = "STARTS", value_parser = |text: &str| whole::<u16>(text, 1, 10_000))]
    branches: Option<u16>,
    #[command(flatten)]
    near: ToleranceArgs,
}

impl Assemble {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let input = Input { tolerance: self.near.tolerance, ..self.mechanism.load()? };
        let commands = input.commands(&self.at)?;
        let working = Progress::of_work("assembling");
        let Posed { closed, relief } = input.posed(&commands)?;
        let others = match self.branches {
            None => None,
            Some(starts) => Some(input.other_branches(&commands, usize::from(starts), &closed)?),
        };
        drop(working);
        let report = report::assembly(
            &input.file,
            &closed,
            relief.as_ref(),
            input.tolerance,
            others.as_ref(),
        );
        self.mechanism.format.print(&report, |report| text(&input, report))?;
        input.within_limits(&closed.coordinates)
    }
}

fn text(input: &Input, report: &AssemblyReport) -> String {
    let mut text = format!("{}, assembled\n", report.name);
    text.push_str(&input.table(&report.closed.coordinates.0, 0));
    if let Some(displaced) = &report.virtual_joints {
        text.push_str("rigid links do not close; displacement of the virtual joints\n");
        text.push_str(&input.table(&displaced.0, report.closed.coordinates.0.len()));
    }
    let closed = match report.tolerance {
        None => "closed",
        Some(_) => "closed within the tolerance",
    };
    let _ = writeln!(text, "{closed}");
    let _ = writeln!(text, "  residual             {:.1e}", report.closed.residual);
    let _ = writeln!(text, "  iterations           {}", report.closed.iterations);
    if let Some(branches) = &report.branches {
        let _ = writeln!(text, "{} found", counted(branches.len(), "other closed configuration"));
        if let Some(search) = report.branch_search.as_ref().filter(|search| search.limit_reached) {
            let _ = writeln!(
                text,
                "the search ended at its limit of {} after {}: there may be more",
                counted(search.limit, "configuration"),
                counted(search.starts, "start")
            );
        }
        for (i, branch) in branches.iter().enumerate() {
            let _ = writeln!(text, "configuration {}", i + 2);
            text.push_str(&input.table(&branch.coordinates.0, 0));
        }
    }
    text
}
