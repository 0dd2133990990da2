//! Report on all models of the same tilts.

use jointplay_cell::displacement::lever_shift;
use jointplay_core::gpr::BrokenLimit;
use jointplay_core::spatial::Tilt;
use jointplay_format::display_units::DisplayUnits;
use jointplay_study::Comparison;

use crate::limits::LimitReport;
use jointplay_format::explain::explain;
use jointplay_format::units::{deg, mm, um};

/// Result of `compare`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct CompareReport {
    /// Azimuth of all tilts (deg).
    pub azimuth_deg: f64,
    /// Axis height of all tilts (mm).
    pub height_mm: f64,
    /// The tilts (deg).
    pub tilt_deg: Vec<f64>,
    /// One entry per virtualization, each in the order of `tilt_deg`.
    pub models: Vec<ModelReport>,
    /// Largest distance between a socket of the approximate model and its ball (µm); its centre never shifts.
    pub approximate_gap_um: Vec<f64>,
    /// Displacements of wafers by the lever of the tilts, in addition to those of O_p; empty where no arms are known.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wafers: Vec<LeverReport>,
    /// Limits that the tilts violate; empty unless limits were ignored.
    pub limits_broken: Vec<LimitReport>,
}

/// Displacement of a wafer's centre by the lever of the tilts.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct LeverReport {
    /// Name of the effector.
    pub effector: String,
    /// Height of the wafer over the platform plane (mm).
    pub height_mm: f64,
    /// Displacement along x, in the order of `tilt_deg` (µm).
    pub lever_x_um: Vec<f64>,
    /// Displacement along y (µm).
    pub lever_y_um: Vec<f64>,
}

/// A wafer over the platform of a robot with arms.
#[derive(Debug, Clone, PartialEq)]
pub struct WaferOverPlatform {
    /// Name of the effector.
    pub effector: String,
    /// Height over the platform plane (m).
    pub height: f64,
}

/// Result of one model.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ModelReport {
    /// Name of the virtualization.
    pub virtualization: String,
    /// Offset of O_p from the base axis along x (µm).
    pub center_shift_x_um: Vec<f64>,
    /// Offset of O_p from the base axis along y (µm).
    pub center_shift_y_um: Vec<f64>,
    /// Largest displacement of a socket within the platform (µm).
    pub largest_displacement_um: Vec<f64>,
    /// Reason why the columns end before the last tilt angle; `null` if they are complete.
    pub failure: Option<String>,
}

/// Reports a comparison of all models.
///
/// # Arguments
/// * `wafers` – those of a robot with arms
#[must_use]
pub fn compare(
    comparison: &Comparison,
    broken: &[BrokenLimit],
    wafers: &[WaferOverPlatform],
) -> CompareReport {
    let lever = |wafer: &WaferOverPlatform| {
        let shift = |&tilt_angle: &f64| {
            lever_shift(wafer.height, Tilt { azimuth: comparison.azimuth, angle: tilt_angle })
        };
        let shifts: Vec<_> = comparison.tilt_angles.iter().map(shift).collect();
        LeverReport {
            effector: wafer.effector.clone(),
            height_mm: mm(wafer.height),
            lever_x_um: shifts.iter().map(|shift| um(shift.x)).collect(),
            lever_y_um: shifts.iter().map(|shift| um(shift.y)).collect(),
        }
    };
    let model = |curve: &jointplay_study::ModelCurve| ModelReport {
        virtualization: curve.name.clone(),
        center_shift_x_um: curve.center_shift.iter().map(|shift| um(shift.x)).collect(),
        center_shift_y_um: curve.center_shift.iter().map(|shift| um(shift.y)).collect(),
        largest_displacement_um: curve.largest_displacement.iter().copied().map(um).collect(),
        failure: curve.failure.as_ref().map(|error| explain(error, DisplayUnits::Metric)),
    };
    CompareReport {
        azimuth_deg: deg(comparison.azimuth),
        height_mm: mm(comparison.height.0),
        tilt_deg: comparison.tilt_angles.iter().copied().map(deg).collect(),
        models: comparison.models.iter().map(model).collect(),
        approximate_gap_um: comparison.approximate_gap.iter().copied().map(um).collect(),
        wafers: wafers.iter().map(lever).collect(),
        limits_broken: crate::limits::limits(broken, DisplayUnits::Metric),
    }
}
