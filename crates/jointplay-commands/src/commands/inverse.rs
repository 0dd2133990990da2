//! `jointplay inverse`: inverse kinematics, from tilt and height to rod lengths.

use clap::{Args, ValueEnum};
use jointplay::gpr::{AxisHeight, CenterHeight};
use jointplay::report;

use super::pose_text;
use crate::arguments::{AnswerArgs, ModelArgs, TiltArgs};
use crate::failure::Failure;

/// Compute rod lengths for a tilt (inverse kinematics) and the resulting platform pose
///
/// Without a tilt, the platform is level.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay inverse --azimuth-deg 17 --tilt-deg 1.5 --height-mm 500
  jointplay inverse --azimuth-deg 17 --tilt-deg 1.5 --height-of center --virtualization radial")]
pub(crate) struct Inverse {
    #[command(flatten)]
    tilt: TiltArgs,
    /// Point whose height is commanded
    #[arg(long, value_enum, default_value = "axis")]
    height_of: HeightOf,
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
}

#[derive(Clone, Copy, ValueEnum)]
enum HeightOf {
    /// intersection of the platform plane with the base axis
    Axis,
    /// centre of the platform
    Center,
}

impl Inverse {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let gpr = self.answer.load()?;
        let (model, options) = (self.model.model(), self.model.options());
        let (tilt, height) = (self.tilt.tilt(0.0), self.tilt.height(&gpr));
        // Limits first: beyond them the solver for the virtual joints may not converge.
        let rods = gpr.inverse(tilt, AxisHeight(height))?;
        let mut broken = self.answer.limits.check(&gpr, &rods, tilt)?;
        let pose = match self.height_of {
            HeightOf::Axis => gpr.forward(rods, model, &options)?,
            HeightOf::Center => {
                let pose = gpr.inverse_for_center(tilt, CenterHeight(height), model, &options)?;
                broken = self.answer.limits.check(&gpr, &pose.rods, tilt)?;
                pose
            }
        };
        let report = report::forward(&gpr, &pose, model, &broken);
        self.answer.format.print(&report, |report| pose_text::pose(report, options.solver))
    }
}
