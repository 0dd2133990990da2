//! Minimum distances of pairs of bodies.

use jointplay_cell::check::MinimumDistance;
use jointplay_cell::workcell::Cell;
use jointplay_format::units::mm;
use serde::Serialize;

/// How near two bodies come.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct DistanceReport {
    /// Names of both.
    pub bodies: [String; 2],
    /// Least distance; below zero a depth.
    pub distance_mm: f64,
    /// How much less it may be between samples.
    pub within_mm: f64,
    /// When.
    pub time_s: f64,
}

/// The minimum distance of a pair in mm.
pub(crate) fn distance(cell: &Cell, pair: &MinimumDistance) -> DistanceReport {
    DistanceReport {
        bodies: pair.entities.map(|one| cell.entity_name(one)),
        distance_mm: mm(pair.distance),
        within_mm: mm(pair.tolerance),
        time_s: pair.time,
    }
}
