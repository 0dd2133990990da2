//! Report on the play that a tilt requires.

use jointplay_core::gpr::{BrokenLimit, EvaluatedBounds, Gpr, TiltPlay};
use jointplay_core::virtualization::Virtualization;
use jointplay_format::display_units::DisplayUnits;

use crate::ball_clearance::BallClearanceReport;
use crate::limits::LimitReport;
use crate::virtual_joints::VirtualJointGroups;
use jointplay_format::units::{deg, mm};

/// Result of `sensitivity`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SensitivityReport {
    /// Rods of the configuration (mm).
    pub q_mm: [f64; 3],
    /// Azimuth of its tilt (deg).
    pub azimuth_deg: f64,
    /// Its tilt (deg).
    pub tilt_deg: f64,
    /// Name of the virtualization.
    pub virtualization: String,
    /// Solver used.
    pub solver: String,
    /// ρ of the metric (mm).
    pub characteristic_length_mm: f64,
    /// Singular values of ∂X/∂P at the configuration, in the metric, non-zero ones first.
    pub singular_values: Vec<f64>,
    /// Number of non-zero ones.
    pub rank: usize,
    /// Right singular vectors of the non-zero ones; order q, P_1, P_2, P_3.
    pub right_singular_vectors: Vec<Vec<f64>>,
    /// Virtual joints at the configuration.
    pub virtual_joints: VirtualJointGroups,
    /// ‖ΔX‖ from level at the same axis height, in the metric, without linearization (mm).
    pub displacement_mm: f64,
    /// ‖ΔP‖ of the motion from level (mm).
    pub motion_mm: f64,
    /// First-order bounds of ‖ΔX‖, by the configuration of the derivatives.
    pub bounds: [BoundsReport; 3],
    /// Share of each rod in ΔX; `null` without a motion.
    pub rod_shares: Option<Vec<f64>>,
    /// Share of each side 12, 23, 31 in ΔX; `null` without a motion.
    pub side_shares: Option<Vec<f64>>,
    /// Limits that the configuration violates; empty unless limits were ignored.
    pub limits_broken: Vec<LimitReport>,
    /// Clearance of the balls that it needs.
    pub ball_clearance: BallClearanceReport,
}

/// First-order bounds of ‖ΔX‖.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct BoundsReport {
    /// `start`, `midpoint` or `end` of the motion.
    pub derivatives_at: &'static str,
    /// σ_min ‖V₃ᵀΔP‖ (mm).
    pub lower_mm: f64,
    /// σ_max ‖V₃ᵀΔP‖ (mm).
    pub upper_mm: f64,
    /// σ_min ‖V₃ᵀΔP‖, computed from eigenvalues (mm).
    pub eigenvalue_lower_mm: f64,
    /// σ_max ‖V₃ᵀΔP‖, computed from eigenvalues (mm).
    pub eigenvalue_upper_mm: f64,
    /// σ_max ‖ΔP‖ (mm).
    pub coarse_upper_mm: f64,
    /// ‖∂X/∂P ΔP‖ (mm).
    pub linear_mm: f64,
    /// Whether `displacement_mm` lies between the bounds.
    pub held: bool,
}

/// Reports the play that a motion from level requires.
#[must_use]
pub fn sensitivity<V: Virtualization + ?Sized>(
    gpr: &Gpr,
    play: &TiltPlay,
    virtualization: &V,
    broken: &[BrokenLimit],
) -> SensitivityReport {
    let (end, tilt) = (&play.end, play.end.tilt());
    let there = &play.at_end.sensitivity;
    let vectors = there.right_vectors();
    SensitivityReport {
        q_mm: end.rods.map(mm),
        azimuth_deg: deg(tilt.azimuth),
        tilt_deg: deg(tilt.angle),
        virtualization: virtualization.name().to_owned(),
        solver: end.solution.solver.to_string(),
        characteristic_length_mm: mm(end.solution.characteristic_length),
        singular_values: there.singular_values().iter().copied().collect(),
        rank: there.rank,
        right_singular_vectors: vectors
            .column_iter()
            .map(|v| v.iter().copied().collect())
            .collect(),
        virtual_joints: VirtualJointGroups::new(
            virtualization.joints(),
            &end.solution.virtual_joints,
        ),
        displacement_mm: mm(play.displacement),
        motion_mm: mm(play.motion),
        bounds: [
            bounds("start", &play.at_start),
            bounds("midpoint", &play.at_midpoint),
            bounds("end", &play.at_end),
        ],
        rod_shares: play.limb_shares.clone(),
        side_shares: play.side_shares.clone(),
        limits_broken: crate::limits::limits(broken, DisplayUnits::Metric),
        ball_clearance: crate::ball_clearance::ball_clearance(
            &gpr.needed_clearance(&play.end, virtualization),
        ),
    }
}

fn bounds(derivatives_at: &'static str, bounded: &EvaluatedBounds) -> BoundsReport {
    let found = &bounded.bounds;
    BoundsReport {
        derivatives_at,
        lower_mm: mm(found.lower),
        upper_mm: mm(found.upper),
        eigenvalue_lower_mm: mm(found.eigenvalue_lower),
        eigenvalue_upper_mm: mm(found.eigenvalue_upper),
        coarse_upper_mm: mm(found.coarse_upper),
        linear_mm: mm(found.linear),
        held: bounded.held,
    }
}
