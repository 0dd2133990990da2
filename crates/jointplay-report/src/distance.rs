//! Minimum distances of pairs of bodies.

use jointplay_cell::check::MinimumDistance;
use jointplay_cell::workcell::Cell;
use jointplay_format::units::mm;
use serde::Serialize;

/// Minimum distance of two bodies.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct DistanceReport {
    /// Names of both bodies.
    pub bodies: [String; 2],
    /// Minimum distance; negative for a penetration depth.
    pub distance_mm: f64,
    /// Uncertainty between samples: the distance is at least `distance_mm` minus this.
    pub within_mm: f64,
    /// Time of the minimum.
    pub time_s: f64,
}

/// The minimum distance of a pair in mm.
pub(crate) fn distance(cell: &Cell, pair: &MinimumDistance) -> DistanceReport {
    DistanceReport {
        bodies: pair.entities.map(|one| cell.entity_label(one)),
        distance_mm: mm(pair.distance),
        within_mm: mm(pair.tolerance),
        time_s: pair.time,
    }
}
