//! Report on the displacement of wafers and the uncertainty of their positions.

use jointplay_cell::displacement::{
    Basis, Bound, Cause, Contribution, Tolerances, WaferDisplacement,
};
use jointplay_cell::robot::EffectorId;
use jointplay_cell::workcell::Cell;
use jointplay_format::cell::robot::virtualization_name;
use jointplay_format::units::{deg, mm, um};
use serde::Serialize;

/// Result of `cell displacement`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct DisplacementReport {
    /// Name of the cell.
    pub cell: String,
    /// Name of the robot.
    pub robot: String,
    /// Virtualization that determines the platform's position over the rods.
    pub virtualization: &'static str,
    /// Multiple of the standard deviation in expanded uncertainties.
    pub coverage_factor: f64,
    /// The wafers.
    pub wafers: Vec<WaferDisplacementReport>,
}

/// Displacement of one wafer.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct WaferDisplacementReport {
    /// Name of the effector.
    pub effector: String,
    /// Name of the station, if the wafer is in one.
    pub station: Option<String>,
    /// The slot, from 1.
    pub slot: Option<usize>,
    /// Tilt direction of the platform.
    pub tilt_azimuth_deg: f64,
    /// Tilt angle of the platform.
    pub tilt_angle_deg: f64,
    /// Distance of the wafer from the robot's axis over the level platform.
    pub reach_mm: f64,
    /// Height of the wafer over the platform plane, the lever of the tilt.
    pub lever_mm: f64,
    /// Displacement of the platform's centre from the base axis.
    pub platform_center_um: [f64; 3],
    /// Known displacements, from the level platform of a rigid robot with the same positions of the motors.
    pub shifts: Vec<ShiftReport>,
    /// Sum of the known displacements.
    pub total_mm: [f64; 3],
    /// Horizontal part of the sum.
    pub total_horizontal_mm: f64,
    /// Contributions to the uncertainty of the position; relative to the slot if the wafer is in one.
    pub contributions: Vec<ContributionReport>,
    /// Sum of all largest deviations.
    pub linear_sum: BoundReport,
    /// Expanded uncertainty of all contributions.
    pub expanded: BoundReport,
    /// Causes without all data, and the keys of the cell file that are missing.
    pub unknown: Vec<UnknownReport>,
}

/// Known displacement by one cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ShiftReport {
    /// The cause.
    pub cause: &'static str,
    /// `physics`, `model`, `measurement` or `tolerance`.
    pub basis: &'static str,
    /// Displacement along x, y and z of the base frame.
    pub shift_mm: [f64; 3],
    /// Horizontal part.
    pub horizontal_mm: f64,
}

/// Contribution of a cause to the uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ContributionReport {
    /// The cause.
    pub cause: &'static str,
    /// `physics`, `model`, `measurement` or `tolerance`.
    pub basis: &'static str,
    /// Number of parameters.
    pub parameters: usize,
    /// Sum of the largest deviations.
    pub linear_sum: BoundReport,
    /// Coverage factor times the standard deviation.
    pub expanded: BoundReport,
}

/// Bound to either side.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct BoundReport {
    /// In the horizontal plane, in the least certain direction.
    pub horizontal_um: f64,
    /// Along the vertical.
    pub vertical_um: f64,
}

/// A cause without data.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct UnknownReport {
    /// The cause.
    pub cause: &'static str,
    /// Missing keys of the cell file: of `[tolerances]`, or of the station.
    pub keys: Vec<&'static str>,
}

/// Reports displacements.
#[must_use]
pub fn displacement(cell: &Cell, wafers: &[WaferDisplacement]) -> DisplacementReport {
    DisplacementReport {
        cell: cell.name.clone(),
        robot: cell.robot.name.clone(),
        virtualization: virtualization_name(cell.robot.model.virtualization),
        coverage_factor: cell.coverage_factor,
        wafers: wafers.iter().map(|one| wafer(cell, one)).collect(),
    }
}

fn wafer(cell: &Cell, one: &WaferDisplacement) -> WaferDisplacementReport {
    let EffectorId { arm, effector } = one.wafer.effector;
    let factor = cell.coverage_factor;
    let millimetres = |vector: &nalgebra::Vector3<f64>| <[f64; 3]>::from(*vector).map(mm);
    WaferDisplacementReport {
        effector: cell.robot.arms[arm].effectors[effector].name.clone(),
        station: one.wafer.slot.map(|slot| cell.stations[slot.station].name.clone()),
        slot: one.wafer.slot.map(|slot| slot.slot),
        tilt_azimuth_deg: if one.tilt.angle > 0.0 { deg(one.tilt.azimuth) } else { 0.0 },
        tilt_angle_deg: deg(one.tilt.angle),
        reach_mm: mm(one.reach),
        lever_mm: mm(one.lever),
        platform_center_um: <[f64; 3]>::from(one.platform_shift).map(um),
        shifts: one
            .shifts
            .iter()
            .map(|shift| ShiftReport {
                cause: cause(shift.cause),
                basis: basis(shift.cause.basis()),
                shift_mm: millimetres(&shift.shift),
                horizontal_mm: mm(shift.shift.xy().norm()),
            })
            .collect(),
        total_mm: millimetres(&one.total),
        total_horizontal_mm: mm(one.total.xy().norm()),
        contributions: one
            .contributions
            .iter()
            .map(|one| ContributionReport {
                cause: cause(one.cause),
                basis: basis(one.cause.basis()),
                parameters: one.parameters,
                linear_sum: bound(one.linear_sum),
                expanded: bound(one.expanded(factor)),
            })
            .collect(),
        linear_sum: bound(Contribution::linear_sum(&one.contributions)),
        expanded: bound(Contribution::expanded_sum(&one.contributions, factor)),
        unknown: one
            .unknown
            .iter()
            .map(|&unknown| UnknownReport {
                cause: cause(unknown),
                keys: keys(unknown, &cell.tolerances),
            })
            .collect(),
    }
}

fn bound(bound: Bound) -> BoundReport {
    BoundReport { horizontal_um: um(bound.horizontal), vertical_um: um(bound.vertical) }
}

fn cause(cause: Cause) -> &'static str {
    match cause {
        Cause::Lever => "lever of the tilt",
        Cause::PlatformModel => "platform model",
        Cause::Droop => "droop",
        Cause::Sag => "sag",
        Cause::Compensation => "compensation residual",
        Cause::AxisResolution => "axis resolution",
        Cause::PlatformTolerances => "platform tolerances",
        Cause::ArmTolerances => "arm tolerances",
        Cause::Station => "station",
    }
}

fn basis(basis: Basis) -> &'static str {
    match basis {
        Basis::Physics => "physics",
        Basis::Model => "model",
        Basis::Measurement => "measurement",
        Basis::Tolerance => "tolerance",
    }
}

/// Keys of the cell file that are missing for a cause.
fn keys(cause: Cause, tolerances: &Tolerances) -> Vec<&'static str> {
    let all = match cause {
        Cause::Droop => vec![("droop_percent", tolerances.droop_share)],
        Cause::Sag => vec![("sag_percent", tolerances.sag_share)],
        Cause::AxisResolution => vec![
            ("linear_resolution_um", tolerances.linear_resolution),
            ("rotary_resolution_urad", tolerances.rotary_resolution),
        ],
        Cause::PlatformTolerances => vec![
            ("guide_um", tolerances.guide),
            ("socket_um", tolerances.socket),
            ("rod_zero_um", tolerances.rod_zero),
        ],
        Cause::ArmTolerances => vec![
            ("mount_um", tolerances.mount),
            ("link_um", tolerances.link),
            ("joint_zero_urad", tolerances.joint_zero),
        ],
        Cause::Station => vec![("taught", None), ("uncertainty", None)],
        Cause::Lever | Cause::PlatformModel | Cause::Compensation => Vec::new(),
    };
    all.into_iter().filter(|(_, stated)| stated.is_none()).map(|(key, _)| key).collect()
}
