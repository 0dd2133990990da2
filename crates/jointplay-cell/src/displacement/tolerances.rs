//! Tolerances of robot and cell.

use super::cause::Cause;

/// Largest deviations of dimensions and positions from their nominal values, to either side; `None` where they are not known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tolerances {
    /// Position of each rod's axis in the base plane, along x and along y (m).
    pub guide: Option<f64>,
    /// Position of each socket in the platform plane, radially and tangentially (m).
    pub socket: Option<f64>,
    /// Zero of each rod (m).
    pub rod_zero: Option<f64>,
    /// Position of the arm's first joint on the platform, in each direction (m).
    pub mount: Option<f64>,
    /// Length, offset and rise of each link (m).
    pub link: Option<f64>,
    /// Zero of each rotary joint of the arm (rad); a linear joint has that of the links.
    pub joint_zero: Option<f64>,
    /// Smallest step of the linear axes (m).
    pub linear_resolution: Option<f64>,
    /// Smallest step of the rotary axes (rad).
    pub rotary_resolution: Option<f64>,
    /// Share by which the droop of the arm deviates from its table or cantilever.
    pub droop_share: Option<f64>,
    /// Share by which the sag of the wafer deviates from the thin plate.
    pub sag_share: Option<f64>,
}

impl Tolerances {
    /// Whether all tolerances that a cause has are known.
    pub(super) fn is_complete(&self, cause: Cause) -> bool {
        let all: &[Option<f64>] = match cause {
            Cause::AxisResolution => &[self.linear_resolution, self.rotary_resolution],
            Cause::PlatformTolerances => &[self.guide, self.socket, self.rod_zero],
            Cause::ArmTolerances => &[self.mount, self.link, self.joint_zero],
            Cause::Droop => &[self.droop_share],
            Cause::Sag => &[self.sag_share],
            Cause::Lever | Cause::PlatformModel | Cause::Compensation | Cause::Station => &[],
        };
        all.iter().all(Option::is_some)
    }
}
