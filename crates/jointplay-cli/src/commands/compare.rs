//! `jointplay compare`: all models side by side.

use std::fmt::Write as _;

use clap::Args;
use jointplay::format::number::number;
use jointplay::format::report::{self, CompareReport};
use jointplay::format::units::m_from_mm;
use jointplay::gpr::AxisHeight;
use jointplay::plot::results::comparison as comparison_figure;
use jointplay::spatial::Tilt;
use jointplay::study::{compare, refine};
use jointplay::virtualization::built_in;

use crate::arguments::{AnswerArgs, MetricArgs, SolverName, Steps, finite, length, pitches, yaw};
use crate::failure::Failure;
use crate::figure::{FIGURE_REFINEMENT, FigureArgs, Format};
use crate::output::{self, fixed, limits};

/// What every model says of a range of tilts, side by side
///
/// The models agree on the plane and the sides, and differ in where the platform sits over them: their centre shifts have opposite signs.
/// Which one is true is physics, not kinematics: see docs/explanation/errata.md.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay compare
  jointplay compare --pitch-deg 0:2:0.1 --ignore-limits --figure shifts.svg")]
pub(crate) struct Compare {
    /// Azimuth of all tilts
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = finite)]
    yaw_deg: f64,
    /// The tilts
    #[arg(long, value_name = "FROM:TO:STEP", default_value = "0:1.5:0.25", value_parser = pitches)]
    pitch_deg: Steps,
    /// Axis height; without it, the robot's working height
    #[arg(long, value_name = "MM", value_parser = length)]
    height_mm: Option<f64>,
    /// How the virtual displacements are found
    #[arg(long, value_enum, default_value = "closed-form")]
    solver: SolverName,
    #[command(flatten)]
    metric: MetricArgs,
    #[command(flatten)]
    figure: FigureArgs,
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
}

/// Width of a PNG figure [px].
const PNG_WIDTH: u32 = 1800;

impl Compare {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        self.figure.target()?;
        let gpr = self.answer.load()?;
        let height = AxisHeight(self.height_mm.map_or(gpr.working_height(), m_from_mm));
        let yaw = yaw(self.yaw_deg);
        let pitches: Vec<f64> = self.pitch_deg.0.iter().map(|pitch| pitch.to_radians()).collect();
        let mut broken = Vec::new();
        // The ends of the range break whatever any of its tilts does at this azimuth and height.
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
        let written = self.figure.write(|format| match format {
            Format::Svg => figure.to_svg().map(String::into_bytes),
            Format::Png => figure.to_png(PNG_WIDTH),
        })?;
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
        "centre shift x, y (µm), tilts toward yaw {}° at axis height {} mm",
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
        "farthest that a socket moves in the platform; approximate: is off its ball (µm)"
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
                "{}: no answer from {}° on",
                model.virtualization,
                number(report.pitch_deg[model.center_shift_x_um.len()])
            );
            let _ = writeln!(text, "  {failure}");
        }
    }
    text + &limits(&report.limits_broken)
}

/// A number of the table, or a dash where the model has none.
fn cell(value: Option<&f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |&value| fixed(value, 3))
}
