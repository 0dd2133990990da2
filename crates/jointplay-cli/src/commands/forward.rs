//! `jointplay forward`: from rods to pose.

use clap::Args;
use jointplay::format::report;

use super::pose_text;
use crate::arguments::{FormatArgs, LimitArgs, ModelArgs, RobotArgs, RodArgs};
use crate::failure::Failure;
use crate::output;

/// Where the platform is for given rods
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay forward --q-mm 500,501,502
  jointplay forward --q-mm 500,501,502 --virtualization polar --solver newton --format json")]
pub(crate) struct ForwardCommand {
    #[command(flatten)]
    rods: RodArgs,
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    robot: RobotArgs,
    #[command(flatten)]
    limits: LimitArgs,
    #[command(flatten)]
    pub(crate) format: FormatArgs,
}

impl ForwardCommand {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let gpr = self.robot.load()?.gpr;
        let model = self.model.model();
        let pose = gpr.forward(self.rods.rods(&gpr), model, &self.model.options())?;
        let broken = self.limits.check_pose(&gpr, &pose)?;
        let report = report::forward(&pose, model, &broken);
        if self.format.json() {
            output::json(&report)
        } else {
            output::text(&pose_text::pose(&report, self.model.options().solver))
        }
    }
}
