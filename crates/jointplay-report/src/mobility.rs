//! Report on the mobility of the three-rod robot.

use jointplay_core::gpr::{BrokenLimit, PlatformPose};
use jointplay_core::mobility::{FiniteMobility, InstantaneousMobility};
use jointplay_format::display_units::DisplayUnits;
use nalgebra::DMatrix;

use crate::limits::LimitReport;
use jointplay_format::units::mm;

/// Kutzbach, instantaneous and finite mobility of the robot or of a mechanism.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct FreedomsReport {
    /// Kutzbach mobility.
    pub kutzbach_mobility: i64,
    /// Instantaneous mobility.
    pub instantaneous_mobility: usize,
    /// Finite mobility; `null` if undecided.
    pub finite_mobility: Option<usize>,
    /// Bounds between which the finite mobility lies.
    pub finite_mobility_bounds: [usize; 2],
    /// Independent constraints.
    pub rank: usize,
    /// Redundant constraints.
    pub redundancy: usize,
}

impl FreedomsReport {
    pub(crate) fn new(kutzbach_mobility: i64, finite: &FiniteMobility) -> Self {
        Self {
            kutzbach_mobility,
            instantaneous_mobility: finite.instantaneous.mobility,
            finite_mobility: finite.mobility,
            finite_mobility_bounds: [finite.lower_bound, finite.upper_bound],
            rank: finite.instantaneous.rank,
            redundancy: finite.instantaneous.redundancy,
        }
    }
}

/// Result of `mobility`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct MobilityReport {
    /// Rods of the configuration (mm).
    pub q_mm: [f64; 3],
    /// Mobilities, rank and redundancy.
    #[serde(flatten)]
    pub freedoms: FreedomsReport,
    /// Singular values of the scaled constraint Jacobian, largest first.
    pub singular_values: Vec<f64>,
    /// Values at or below it count as zero.
    pub threshold: f64,
    /// Length in which the Jacobian is scaled (mm).
    pub characteristic_length_mm: f64,
    /// Orthonormal basis of the instantaneous motions, one per entry, in units of the characteristic length; order q, P_1, P_2, P_3.
    pub null_space: Vec<Vec<f64>>,
    /// Orthonormal self-stresses, one per entry; order of the constraints: rods 1 to 3 (x, y, z each), sides 12, 23, 31.
    pub self_stress: Vec<Vec<f64>>,
    /// Mobility of the requested virtualization.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schema(value_type = AugmentedReport))]
    pub augmented: Option<AugmentedReport>,
    /// Limits that the rods violate; empty unless limits were ignored.
    pub limits_broken: Vec<LimitReport>,
}

/// Mobility with the virtual joints free.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct AugmentedReport {
    /// Name of the virtualization.
    #[cfg_attr(feature = "schema", schema(required = false))]
    pub virtualization: String,
    /// Independent constraints.
    #[cfg_attr(feature = "schema", schema(required = false))]
    pub augmented_rank: usize,
    /// Freedoms.
    #[cfg_attr(feature = "schema", schema(required = false))]
    pub augmented_mobility: usize,
    /// Singular values of the scaled Jacobian [∂Φ/∂P ∂Φ/∂X], largest first.
    #[cfg_attr(feature = "schema", schema(required = false))]
    pub augmented_singular_values: Vec<f64>,
}

/// Reports the mobility.
///
/// # Arguments
/// * `augmented` – name of a virtualization with its mobility, if requested
#[must_use]
pub fn mobility(
    pose: &PlatformPose,
    kutzbach_mobility: i64,
    finite: &FiniteMobility,
    augmented: Option<(&str, &InstantaneousMobility)>,
    broken: &[BrokenLimit],
) -> MobilityReport {
    let first = &finite.instantaneous;
    MobilityReport {
        q_mm: pose.rods.map(mm),
        freedoms: FreedomsReport::new(kutzbach_mobility, finite),
        singular_values: first.singular_values.iter().copied().collect(),
        threshold: first.threshold,
        characteristic_length_mm: mm(first.characteristic_length),
        null_space: columns(&first.null_space),
        self_stress: columns(&first.self_stress),
        augmented: augmented.map(|(name, found)| AugmentedReport {
            virtualization: name.to_owned(),
            augmented_rank: found.rank,
            augmented_mobility: found.mobility,
            augmented_singular_values: found.singular_values.iter().copied().collect(),
        }),
        limits_broken: crate::limits::limits(broken, DisplayUnits::Metric),
    }
}

pub(crate) fn columns(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.column_iter().map(|column| column.iter().copied().collect()).collect()
}
