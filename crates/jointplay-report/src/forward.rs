//! Report on a pose.

use jointplay_core::gpr::{BrokenLimit, Gpr, PlatformPose};
use jointplay_core::virtualization::Virtualization;
use jointplay_format::display_units::DisplayUnits;

use crate::ball_clearance::BallClearanceReport;
use crate::limits::LimitReport;
use crate::virtual_joints::VirtualJointGroups;
use jointplay_format::units::{deg, mm};

/// Result of `forward` and `inverse`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[expect(missing_docs, reason = "the field names contain the unit; `PlatformPose` documents them")]
pub struct ForwardReport {
    pub q_mm: [f64; 3],
    pub sides_mm: [f64; 3],
    pub virtualization: String,
    pub solver: String,
    pub characteristic_length_mm: f64,
    pub virtual_joints: VirtualJointGroups,
    pub platform: PlatformReport,
    pub iterations: usize,
    pub residual_mm: f64,
    /// Limits that the pose violates; empty unless limits were ignored.
    pub limits_broken: Vec<LimitReport>,
    /// Clearance of the balls that it needs.
    pub ball_clearance: BallClearanceReport,
}

/// Pose of the platform.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[expect(missing_docs, reason = "the field names contain the unit; `PlatformPose` documents them")]
pub struct PlatformReport {
    pub origin_mm: [f64; 3],
    pub normal: [f64; 3],
    /// Rows of the rotation matrix base_from_platform.
    pub rotation: [[f64; 3]; 3],
    pub azimuth_deg: f64,
    pub tilt_deg: f64,
    pub torsion_deg: f64,
    pub axis_height_mm: f64,
    pub center_height_mm: f64,
    pub center_shift_mm: [f64; 2],
}

/// Reports a pose.
#[must_use]
pub fn forward<V: Virtualization + ?Sized>(
    gpr: &Gpr,
    pose: &PlatformPose,
    virtualization: &V,
    broken: &[BrokenLimit],
) -> ForwardReport {
    let origin = pose.base_from_platform.translation.vector;
    let rotation = pose.base_from_platform.rotation.matrix();
    let tilt = pose.tilt();
    ForwardReport {
        q_mm: pose.rods.map(mm),
        sides_mm: pose.sides.map(mm),
        virtualization: virtualization.name().to_owned(),
        solver: pose.solution.solver.to_string(),
        characteristic_length_mm: mm(pose.solution.characteristic_length),
        virtual_joints: VirtualJointGroups::new(
            virtualization.joints(),
            &pose.solution.virtual_joints,
        ),
        platform: PlatformReport {
            origin_mm: [0, 1, 2].map(|k| mm(origin[k])),
            normal: pose.normal().into(),
            rotation: [0, 1, 2].map(|i| [0, 1, 2].map(|j| rotation[(i, j)])),
            azimuth_deg: deg(tilt.azimuth),
            tilt_deg: deg(tilt.angle),
            torsion_deg: deg(pose.torsion()),
            axis_height_mm: mm(pose.axis_height().0),
            center_height_mm: mm(origin.z),
            center_shift_mm: [mm(pose.center_shift().x), mm(pose.center_shift().y)],
        },
        iterations: pose.solution.iterations,
        residual_mm: mm(pose.solution.residual),
        limits_broken: crate::limits::limits(broken, DisplayUnits::Metric),
        ball_clearance: crate::ball_clearance::ball_clearance(
            &gpr.needed_clearance(pose, virtualization),
        ),
    }
}
