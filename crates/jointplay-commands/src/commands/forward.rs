//! `jointplay forward`: forward kinematics, from rod lengths to the platform pose.

use clap::Args;
use jointplay::report;

use super::pose_text;
use crate::arguments::{AnswerArgs, ModelArgs, RodArgs};
use crate::failure::Failure;

/// Compute the platform pose for given rod lengths (forward kinematics)
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
    pub(crate) answer: AnswerArgs,
}

impl ForwardCommand {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let gpr = self.answer.load()?;
        let model = self.model.model();
        let rods = self.rods.rods(&gpr);
        let broken = self.answer.limits.check_rods(&gpr, &rods)?;
        let pose = gpr.forward(rods, model, &self.model.options())?;
        let report = report::forward(&gpr, &pose, model, &broken);
        self.answer
            .format
            .print(&report, |report| pose_text::pose(report, self.model.options().solver))
    }
}
