//! Minimum distances of pairs of bodies.

use jointplay_cell::check::PairDistance;
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
pub(crate) fn distance(pair: &PairDistance) -> DistanceReport {
    DistanceReport {
        bodies: pair.names.clone(),
        distance_mm: mm(pair.distance),
        within_mm: mm(pair.within),
        time_s: pair.time,
    }
}
