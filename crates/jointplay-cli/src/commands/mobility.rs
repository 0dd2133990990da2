//! `jointplay mobility`: what can move.

use std::fmt::Write as _;

use clap::Args;
use jointplay::format::report::{self, MobilityReport};
use jointplay::mobility::{RANK_THRESHOLD, augmented_mobility, finite_mobility};
use jointplay::virtualization::{Planar, SolveOptions};

use crate::arguments::{AnswerArgs, RodArgs, VirtualizationName};
use crate::failure::Failure;
use crate::output::{limits, magnitude, three};

/// What the constraints let move: counted, to first order, and for real
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay mobility                                      level: shaky
  jointplay mobility --q-mm 500,501,502                   tilted: stiff
  jointplay mobility --q-mm 500,501,502 --virtualization polar")]
pub(crate) struct Mobility {
    #[command(flatten)]
    rods: RodArgs,
    /// Also the mobility with these virtual joints free
    #[arg(long, value_enum)]
    virtualization: Option<VirtualizationName>,
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
}

impl Mobility {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let gpr = self.answer.load()?;
        // The rigid mechanism is the one whose virtual joints are held; which virtualization holds them makes no difference.
        let options = SolveOptions::default();
        let rods = self.rods.rods(&gpr);
        let broken = self.answer.limits.check_rods(&gpr, &rods)?;
        let pose = gpr.forward(rods, &Planar, &options)?;
        let rigid = gpr.system(&Planar);
        let finite = finite_mobility(&rigid, &rigid.configuration(&pose), RANK_THRESHOLD)?;
        let augmented = match self.virtualization {
            None => None,
            Some(name) => {
                let model = name.model();
                let relieved = gpr.system(model);
                let at = relieved.configuration(&gpr.forward(pose.rods, model, &options)?);
                Some((model.name(), augmented_mobility(&relieved, &at, RANK_THRESHOLD)?))
            }
        };
        let augmented = augmented.as_ref().map(|(name, found)| (*name, found));
        let report = report::mobility(&pose, gpr.kutzbach_mobility(), &finite, augmented, &broken);
        self.answer.print(&report, text)
    }
}

fn text(report: &MobilityReport) -> String {
    let mut text = String::new();
    let [lower, upper] = report.finite_mobility_bounds;
    let finite =
        report.finite_mobility.map_or(format!("undecided, {lower} to {upper}"), |h| h.to_string());
    let _ = writeln!(text, "mobility at q = {} mm", three(&report.q_mm, 6).trim_start());
    let _ = writeln!(text, "  counted (Kutzbach)   {:>3}", report.kutzbach_mobility);
    let _ = writeln!(text, "  to first order       {:>3}", report.instantaneous_mobility);
    let _ = writeln!(text, "  for real             {finite:>3}");
    if report.finite_mobility.is_some_and(|finite| finite < report.instantaneous_mobility) {
        let _ = writeln!(
            text,
            "  shaky: {} motions are only instantaneous",
            report.instantaneous_mobility - lower
        );
    }
    let _ = writeln!(text, "constraints");
    let _ = writeln!(text, "  rank                 {:>3}", report.rank);
    let _ = writeln!(text, "  redundant            {:>3}", report.redundancy);
    let _ = writeln!(
        text,
        "singular values, lengths in units of {} mm",
        report.characteristic_length_mm
    );
    singular_values(&mut text, &report.singular_values, report.rank);
    let _ = writeln!(text, "  threshold            {:.3e}", report.threshold);
    if let Some(augmented) = &report.augmented {
        let _ = writeln!(text, "with the {} virtual joints free", augmented.virtualization);
        let _ = writeln!(text, "  rank                 {:>3}", augmented.augmented_rank);
        let _ = writeln!(text, "  mobility             {:>3}", augmented.augmented_mobility);
        singular_values(&mut text, &augmented.augmented_singular_values, augmented.augmented_rank);
    }
    text + &limits(&report.limits_broken)
}

/// Values that count, then a bar, then those that do not.
fn singular_values(text: &mut String, values: &[f64], rank: usize) {
    let list = |values: &[f64]| {
        values.iter().map(|&value| format!(" {}", magnitude(value))).collect::<String>()
    };
    for (row, chunk) in values[..rank].chunks(6).enumerate() {
        let label = if row == 0 { "counted" } else { "" };
        let _ = writeln!(text, "  {label:<20}{}", list(chunk));
    }
    if rank < values.len() {
        let _ = writeln!(text, "  {:<20}{}", "zero", list(&values[rank..]));
    }
}
