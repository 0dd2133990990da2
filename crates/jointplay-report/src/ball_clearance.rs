//! Report on the clearance of the balls of the three-rod robot that a pose needs.

use jointplay_core::gpr::BallClearance;
use jointplay_format::units::um;

/// Clearance that a pose needs, for rigid parts.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct BallClearanceReport {
    /// Displacement of each ball from the centre of its socket, under the virtualization (µm).
    pub displacements_um: [f64; 3],
    /// Radial clearance that the pose needs wherever the platform settles, at least (µm).
    pub lower_bound_um: f64,
    /// Radial clearance at which the pose is possible (µm).
    pub upper_bound_um: f64,
    /// Radial clearance in the robot file; `null` without one (µm).
    pub available_um: Option<f64>,
    /// Whether it is sufficient; `null` where it is unknown, or between the bounds.
    pub is_sufficient: Option<bool>,
}

/// Reports the clearance that a pose needs.
#[must_use]
pub fn ball_clearance(needed: &BallClearance) -> BallClearanceReport {
    BallClearanceReport {
        displacements_um: needed.displacements.map(um),
        lower_bound_um: um(needed.lower_bound),
        upper_bound_um: um(needed.upper_bound()),
        available_um: needed.available.map(um),
        is_sufficient: needed.is_sufficient(),
    }
}
