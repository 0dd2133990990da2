//! Tilts and points.

use nalgebra::Vector3;

use super::tree::{AllowedRange, Entry, Reader, Table};

/// Values of `yaw_deg` (rad) and `tilt`; `None` if there is no valid tilt.
pub(super) fn yaw_and_tilt(table: &Table) -> (f64, Option<jointplay_core::spatial::Tilt>) {
    let yaw = table.number_or("yaw_deg", AllowedRange::Within(-360.0, 360.0), 0.0).to_radians();
    let tilt = table.table("tilt", "a tilt").map(|tilt| {
        let toward = tilt.number("yaw_deg", AllowedRange::Within(-360.0, 360.0));
        let pitch = tilt.number("pitch_deg", AllowedRange::Within(-89.0, 89.0));
        tilt.finish();
        jointplay_core::spatial::Tilt {
            yaw: toward.unwrap_or(0.0).to_radians(),
            pitch: pitch.unwrap_or(0.0).to_radians(),
        }
    });
    (yaw, tilt)
}

/// The points of a list (m).
pub(super) fn points(entry: &Entry, reader: &Reader) -> Option<Vec<Vector3<f64>>> {
    // All points are read before the first error returns, so that every error is reported.
    let points: Vec<_> = entry.list(reader)?.iter().map(|point| point.point(reader)).collect();
    points.into_iter().collect()
}
