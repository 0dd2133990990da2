//! `jointplay compare`: all models over a range of tilts.

use std::fmt::Write as _;

use clap::Args;
use jointplay::cell::robot::EffectorId;
use jointplay::format::cell;
use jointplay::format::number::number;
use jointplay::format::units::m_from_mm;
use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::plot::results::comparison as comparison_figure;
use jointplay::report::{self, CompareReport, WaferOverPlatform};
use jointplay::study::{broken_limits, compare, refine};
use jointplay::virtualization::built_in;

use crate::arguments::{
    AnswerArgs, MetricArgs, SolverName, Steps, azimuth, finite, length, tilt_angles,
};
use crate::failure::Failure;
use crate::figure::{FIGURE_REFINEMENT, FigureArgs};
use crate::output::{self, limits};
use crate::source::{Kind, Source};
use jointplay::format::number::fixed;

/// Compare all models over a range of tilts
///
/// The models agree on the platform plane and on the sides; they differ in the in-plane position of the platform, and their centre shifts can have opposite signs.
/// Kinematics alone cannot decide between them; see docs/explanation/errata.md.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay compare
  jointplay compare --robot dual-arm
  jointplay compare --tilt-deg 0:2:0.1 --ignore-limits --figure shifts.svg")]
pub(crate) struct Compare {
    /// Tilt direction γ
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = finite)]
    azimuth_deg: f64,
    /// Tilt angles α
    #[arg(long, value_name = "FROM:TO:STEP", default_value = "0:1.5:0.25", value_parser = tilt_angles)]
    tilt_deg: Steps,
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
        let (gpr, wafers) = self.robot()?;
        let height = AxisHeight(self.height_mm.map_or(gpr.working_height(), m_from_mm));
        let azimuth = azimuth(self.azimuth_deg);
        let tilt_angles: Vec<f64> =
            self.tilt_deg.0.iter().map(|tilt_angle| tilt_angle.to_radians()).collect();
        let broken = broken_limits(&gpr, azimuth, &tilt_angles, height)?;
        let broken = self.answer.limits.accepted(broken)?;
        let options = self.metric.options(self.solver);
        let comparison = compare(&gpr, &built_in(), azimuth, &tilt_angles, height, &options)?;
        let report = report::compare(&comparison, &broken, &wafers);
        self.answer.format.print(&report, table)?;
        if self.figure.target()?.is_none() {
            return Ok(());
        }
        let fine = refine(&tilt_angles, FIGURE_REFINEMENT);
        let figure =
            comparison_figure(&compare(&gpr, &built_in(), azimuth, &fine, height, &options)?);
        let written = self.figure.write(&figure)?;
        match written {
            Some(path) if !self.answer.format.json() => {
                output::text(&format!("figure: {}\n", path.display()))
            }
            _ => Ok(()),
        }
    }
}

impl Compare {
    /// The three-rod robot, and the wafers over it if the file has arms.
    fn robot(&self) -> Result<(Gpr, Vec<WaferOverPlatform>), Failure> {
        let Some(path) = &self.answer.robot.robot else {
            return Ok((self.answer.load()?, Vec::new()));
        };
        let source = Source::read(path, cell::MAX_BYTES)?;
        if source.kind() != Some(Kind::Arms) {
            return Ok((self.answer.load()?, Vec::new()));
        }
        self.answer.robot.set.refuse("--set: a robot with arms has no parameters")?;
        let robot = cell::robot::parse(&source.text)
            .map_err(|errors| Failure::invalid(&errors, &source.label))?;
        let wafer = |id: EffectorId| {
            let height =
                robot.wafer_height(id).map_err(|error| Failure::Robot(error.to_string()))?;
            let effector = robot.arms[id.arm].effectors[id.effector].name.clone();
            Ok(WaferOverPlatform { effector, height })
        };
        let wafers = robot.effectors().map(wafer).collect::<Result<Vec<_>, Failure>>()?;
        Ok((robot.gpr.without_limit_checks(), wafers))
    }
}

fn table(report: &CompareReport) -> String {
    let mut text = String::new();
    let names: String = report.models.iter().map(|m| format!("{:>20}", m.virtualization)).collect();
    let _ = writeln!(
        text,
        "centre shift x, y (µm), tilt direction {}°, axis height {} mm",
        number(report.azimuth_deg),
        number(report.height_mm)
    );
    let _ = writeln!(text, "   tilt (deg){names}{:>20}", "approximate");
    for (i, tilt_angle) in report.tilt_deg.iter().enumerate() {
        let _ = write!(text, "  {:>11}", fixed(*tilt_angle, 4));
        for model in &report.models {
            let (x, y) = (model.center_shift_x_um.get(i), model.center_shift_y_um.get(i));
            let _ = write!(text, "{:>10}{:>10}", entry(x), entry(y));
        }
        let _ = writeln!(text, "{:>10}{:>10}", fixed(0.0, 3), fixed(0.0, 3));
    }
    let _ = writeln!(
        text,
        "largest socket displacement in the platform; approximate: largest gap between socket and ball (µm)"
    );
    let _ = writeln!(text, "   tilt (deg){names}{:>20}", "approximate");
    for (i, tilt_angle) in report.tilt_deg.iter().enumerate() {
        let _ = write!(text, "  {:>11}", fixed(*tilt_angle, 4));
        for model in &report.models {
            let _ = write!(text, "{:>20}", entry(model.largest_displacement_um.get(i)));
        }
        let _ = writeln!(text, "{:>20}", fixed(report.approximate_gap_um[i], 3));
    }
    for model in &report.models {
        if let Some(failure) = &model.failure {
            let _ = writeln!(
                text,
                "{}: no solution from {}° on",
                model.virtualization,
                number(report.tilt_deg[model.center_shift_x_um.len()])
            );
            let _ = writeln!(text, "  {failure}");
        }
    }
    let _ = writeln!(
        text,
        "centre shifts are those of the platform's centre; the centre of a wafer moves in addition by the lever of the tilt"
    );
    if report.wafers.is_empty() {
        let _ = writeln!(
            text,
            "  lever not known: the robot file has no arms; compare a robot with arms, or use `jointplay cell displacement`"
        );
    } else {
        let names: String = report
            .wafers
            .iter()
            .map(|wafer| {
                format!(
                    "{:>30}",
                    format!("{}, {} mm high", wafer.effector, fixed(wafer.height_mm, 1))
                )
            })
            .collect();
        let _ = writeln!(text, "lever x, y (µm)\n   tilt (deg){names}");
        for (i, tilt_angle) in report.tilt_deg.iter().enumerate() {
            let _ = write!(text, "  {:>11}", fixed(*tilt_angle, 4));
            for wafer in &report.wafers {
                let [x, y] = [wafer.lever_x_um[i], wafer.lever_y_um[i]].map(|um| fixed(um, 1));
                let _ = write!(text, "{x:>15}{y:>15}");
            }
            text.push('\n');
        }
    }
    text + &limits(&report.limits_broken)
}

/// A number of the table, or a dash if the model has no solution.
fn entry(value: Option<&f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |&value| fixed(value, 3))
}
