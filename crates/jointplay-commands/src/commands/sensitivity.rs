//! `jointplay sensitivity`: displacement of the virtual joints for a tilt.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use jointplay::report::{self, BallClearanceReport, SensitivityReport};
use jointplay::spatial::Tilt;

use super::relief;
use crate::arguments::{AnswerArgs, ModelArgs, Rods, TiltArgs};
use crate::failure::Failure;
use crate::mechanism_input::{Input, JointValues, joint_values};
use crate::output::{ball_clearance, characteristic_length, limits, magnitude, three};
use jointplay::format::number::{fixed, rounded};

/// Compute the displacement of the virtual joints for a tilt, with first-order bounds
///
/// The motion starts from the level platform at the same axis height.
/// Without a tilt, it ends at the robot's tilt limit.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay sensitivity --tilt-deg 1.5
  jointplay sensitivity --q-mm 500,501,502 --virtualization polar --metric radius
  jointplay sensitivity gpr-mechanism --command S1[1]=0.1

Exit codes: 0 done, 1 no such pose, or a limit or clearance is exceeded, 2 bad input or usage.")]
pub(crate) struct SensitivityCommand {
    /// Mechanism file (TOML) with virtual joints, or a name from `jointplay catalogue` [default: the paper's robot]
    #[arg(value_name = "FILE", conflicts_with_all = ["robot", "q_mm", "azimuth_deg", "tilt_deg", "height_mm", "ignore_limits", "virtualization", "solver", "metric"])]
    file: Option<PathBuf>,
    /// Commanded joint coordinates of a mechanism, in the units of the file
    #[arg(long, value_name = "JOINT=VALUE", value_parser = joint_values, requires = "file")]
    command: Vec<JointValues>,
    /// Rod lengths at the end of the motion, instead of a tilt
    #[arg(long, value_name = "Q1,Q2,Q3", value_parser = crate::arguments::rods, conflicts_with_all = ["azimuth_deg", "tilt_deg", "height_mm"])]
    q_mm: Option<Rods>,
    #[command(flatten)]
    tilt: TiltArgs,
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
}

impl SensitivityCommand {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        if let Some(path) = &self.file {
            let input = Input::read(path, &self.answer.robot.set.set)?;
            return relief::run(&input, &self.command, &self.answer);
        }
        let gpr = self.answer.load()?;
        let (model, options) = (self.model.model(), self.model.options());
        let (rods, tilt) = match &self.q_mm {
            Some(rods) => (rods.0, gpr.plane_tilt(&rods.0)),
            None => {
                let tilt = self.tilt.tilt(gpr.limits().tilt_max);
                (gpr.inverse(tilt, self.tilt.axis_height(&gpr))?, tilt)
            }
        };
        let broken = self.answer.limits.check(&gpr, &rods, tilt)?;
        let end = gpr.forward(rods, model, &options)?;
        let level = gpr.inverse(Tilt::LEVEL, end.axis_height())?;
        let start = gpr.forward(level, model, &options)?;
        let play = gpr.play_between(start, end, model)?;
        let report = report::sensitivity(&gpr, &play, model, &broken);
        self.answer.format.print(&report, text)?;
        let BallClearanceReport { lower_bound_um, available_um, is_sufficient, .. } =
            &report.ball_clearance;
        match (available_um, is_sufficient) {
            (Some(available), Some(false)) => Err(Failure::OverClearance(format!(
                "the balls need a radial clearance of at least {} µm, and have {} µm",
                fixed(*lower_bound_um, 3),
                rounded(*available, 3)
            ))),
            _ => Ok(()),
        }
    }
}

fn text(report: &SensitivityReport) -> String {
    let mut text = String::new();
    let um = |mm: f64| fixed(mm * 1e3, 3);
    let _ = writeln!(
        text,
        "tilt {}° at azimuth {}°, {} virtual joints{}",
        fixed(report.tilt_deg, 6),
        fixed(report.azimuth_deg, 6),
        report.virtualization,
        characteristic_length(&report.virtual_joints, report.characteristic_length_mm)
    );
    let _ = writeln!(text, "  rods q (mm)          {}", three(&report.q_mm, 6));
    for (name, values) in &report.virtual_joints.0 {
        let (symbol, unit) = name.rsplit_once('_').unwrap_or((name, ""));
        let _ = writeln!(text, "  {:<21}{}", format!("{symbol} ({unit})"), three(values, 6));
    }
    let _ = writeln!(text, "displacement of the virtual joints from level");
    let _ = writeln!(text, "  exact ‖ΔX‖ (µm)      {:>14}", um(report.displacement_mm));
    let _ =
        writeln!(text, "  estimates (µm), Jacobian at        lower         upper    linear ‖dX‖");
    for bounds in &report.bounds {
        let _ = writeln!(
            text,
            "    {:<19}{:>14}{:>14}{:>14}   {}",
            bounds.derivatives_at,
            um(bounds.lower_mm),
            um(bounds.upper_mm),
            um(bounds.linear_mm),
            if bounds.held { "contains ‖ΔX‖" } else { "does not contain ‖ΔX‖" }
        );
    }
    let values: String =
        report.singular_values.iter().map(|&value| format!(" {}", magnitude(value))).collect();
    let _ = writeln!(text, "sensitivity ∂X/∂P at the tilt");
    let _ = writeln!(text, "  singular values     {values}");
    let _ = writeln!(text, "shares of ΔX");
    for (source, shares) in [
        ("motion of rods 1, 2, 3", &report.rod_shares),
        ("required by sides 12, 23, 31", &report.side_shares),
    ] {
        let shares = match shares {
            Some(shares) => {
                shares.iter().map(|s| format!("{:>13}%", fixed(s * 100.0, 2))).collect()
            }
            None => "       no displacement".to_owned(),
        };
        let _ = writeln!(text, "  {source:<30}{shares}");
    }
    text + &ball_clearance(&report.ball_clearance) + &limits(&report.limits_broken)
}
