//! `jointplay compare`: all models over a range of tilts.

use std::fmt::Write as _;

use clap::Args;
use jointplay::format::number::number;
use jointplay::format::units::m_from_mm;
use jointplay::gpr::AxisHeight;
use jointplay::plot::results::comparison as comparison_figure;
use jointplay::report::{self, CompareReport};
use jointplay::spatial::Tilt;
use jointplay::study::{compare, refine};
use jointplay::virtualization::built_in;

use crate::arguments::{AnswerArgs, MetricArgs, SolverName, Steps, finite, length, pitches, yaw};
use crate::failure::Failure;
use crate::figure::{FIGURE_REFINEMENT, FigureArgs};
use crate::output::{self, fixed, limits};

/// Compare all models over a range of tilts
///
/// The models agree on the platform plane and on the sides; they differ in the in-plane position of the platform, and their centre shifts can have opposite signs.
/// Kinematics alone cannot decide between them; see docs/explanation/errata.md.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay compare
  jointplay compare --pitch-deg 0:2:0.1 --ignore-limits --figure shifts.svg")]
pub(crate) struct Compare {
    /// Tilt direction γ
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = finite)]
    yaw_deg: f64,
    /// Tilt angles α
    #[arg(long, value_name = "FROM:TO:STEP", default_value = "0:1.5:0.25", value_parser = pitches)]
    pitch_deg: Steps,
    /// Axis height [default: the robot's working height]
    #[arg(long, value_name = "MM", value_parser = length)]
    height_mm: Option<f64>,
    /// Solver for the virtual joints
    #[arg(long, value_enum, default_value = "closed-form")]
    solver: SolverName,
    #[command(flatten)]
    metric: MetricArgs,
    #[command(flatten)]
    figure: FigureArgs,
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
}

impl Compare {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        self.figure.target()?;
        let gpr = self.answer.load()?;
        let height = AxisHeight(self.height_mm.map_or(gpr.working_height(), m_from_mm));
        let yaw = yaw(self.yaw_deg);
        let pitches: Vec<f64> = self.pitch_deg.0.iter().map(|pitch| pitch.to_radians()).collect();
        let mut broken = Vec::new();
        // At one azimuth and height, the ends of the range exceed every limit that any tilt of it exceeds.
        let ends =
            [pitches.iter().copied().reduce(f64::min), pitches.iter().copied().reduce(f64::max)];
        for pitch in ends.into_iter().flatten() {
            let tilt = Tilt { yaw, pitch };
            for limit in self.answer.limits.check(&gpr, &gpr.inverse(tilt, height)?, tilt)? {
                if !broken.contains(&limit) {
                    broken.push(limit);
                }
            }
        }
        let options = self.metric.options(self.solver);
        let comparison = compare(&gpr, &built_in(), yaw, &pitches, height, &options)?;
        let report = report::compare(&comparison, &broken);
        self.answer.format.print(&report, table)?;
        if self.figure.target()?.is_none() {
            return Ok(());
        }
        let fine = refine(&pitches, FIGURE_REFINEMENT);
        let figure = comparison_figure(&compare(&gpr, &built_in(), yaw, &fine, height, &options)?);
        let written = self.figure.write(&figure)?;
        match written {
            Some(path) if !self.answer.format.json() => {
                output::text(&format!("figure: {}\n", path.display()))
            }
            _ => Ok(()),
        }
    }
}

fn table(report: &CompareReport) -> String {
    let mut text = String::new();
    let names: String = report.models.iter().map(|m| format!("{:>20}", m.virtualization)).collect();
    let _ = writeln!(
        text,
        "centre shift x, y (µm), tilt direction {}°, axis height {} mm",
        number(report.yaw_deg),
        number(report.height_mm)
    );
    let _ = writeln!(text, "  pitch (deg){names}{:>20}", "approximate");
    for (i, pitch) in report.pitch_deg.iter().enumerate() {
        let _ = write!(text, "  {:>11}", fixed(*pitch, 4));
        for model in &report.models {
            let (x, y) = (model.center_shift_x_um.get(i), model.center_shift_y_um.get(i));
            let _ = write!(text, "{:>10}{:>10}", cell(x), cell(y));
        }
        let _ = writeln!(text, "{:>10}{:>10}", fixed(0.0, 3), fixed(0.0, 3));
    }
    let _ = writeln!(
        text,
        "largest socket displacement in the platform; approximate: largest gap between socket and ball (µm)"
    );
    let _ = writeln!(text, "  pitch (deg){names}{:>20}", "approximate");
    for (i, pitch) in report.pitch_deg.iter().enumerate() {
        let _ = write!(text, "  {:>11}", fixed(*pitch, 4));
        for model in &report.models {
            let _ = write!(text, "{:>20}", cell(model.largest_displacement_um.get(i)));
        }
        let _ = writeln!(text, "{:>20}", fixed(report.approximate_gap_um[i], 3));
    }
    for model in &report.models {
        if let Some(failure) = &model.failure {
            let _ = writeln!(
                text,
                "{}: no solution from {}° on",
                model.virtualization,
                number(report.pitch_deg[model.center_shift_x_um.len()])
            );
            let _ = writeln!(text, "  {failure}");
        }
    }
    text + &limits(&report.limits_broken)
}

/// A number of the table, or a dash if the model has no solution.
fn cell(value: Option<&f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |&value| fixed(value, 3))
}
