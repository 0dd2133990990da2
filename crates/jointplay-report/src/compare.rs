//! Report on all models of the same tilts.

use jointplay_core::gpr::BrokenLimit;
use jointplay_study::Comparison;

use crate::limits::LimitReport;
use jointplay_format::explain::explain;
use jointplay_format::units::{deg, mm, um};

/// Result of `compare`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct CompareReport {
    /// Azimuth of all tilts (deg).
    pub yaw_deg: f64,
    /// Axis height of all tilts (mm).
    pub height_mm: f64,
    /// The tilts (deg).
    pub pitch_deg: Vec<f64>,
    /// One entry per virtualization, each in the order of `pitch_deg`.
    pub models: Vec<ModelReport>,
    /// Largest distance between a socket of the approximate model and its ball (µm); its centre never shifts.
    pub approximate_gap_um: Vec<f64>,
    /// Limits that the tilts violate; empty unless limits were ignored.
    pub limits_broken: Vec<LimitReport>,
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
    /// Reason why the columns end before the last pitch; `null` if they are complete.
    pub failure: Option<String>,
}

/// Reports a comparison of all models.
#[must_use]
pub fn compare(comparison: &Comparison, broken: &[BrokenLimit]) -> CompareReport {
    let model = |curve: &jointplay_study::ModelCurve| ModelReport {
        virtualization: curve.name.clone(),
        center_shift_x_um: curve.center_shift.iter().map(|shift| um(shift.x)).collect(),
        center_shift_y_um: curve.center_shift.iter().map(|shift| um(shift.y)).collect(),
        largest_displacement_um: curve.largest_displacement.iter().copied().map(um).collect(),
        failure: curve.failure.as_ref().map(|error| explain(error)),
    };
    CompareReport {
        yaw_deg: deg(comparison.yaw),
        height_mm: mm(comparison.height.0),
        pitch_deg: comparison.pitches.iter().copied().map(deg).collect(),
        models: comparison.models.iter().map(model).collect(),
        approximate_gap_um: comparison.approximate_gap.iter().copied().map(um).collect(),
        limits_broken: crate::limits::limits(broken),
    }
}
