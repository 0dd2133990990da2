//! Tilts and points.

use jointplay_core::spatial::Tilt;
use nalgebra::Vector3;

use super::problem::Fault;
use super::tree::{AllowedRange, Entry, Reader, Table};
use crate::number::number;
use crate::units::deg;

/// Largest tilt of a frame, far beyond that of any robot (deg).
const STEEPEST_DEG: f64 = 89.0;

const STEEPEST: AllowedRange = AllowedRange::Within(-STEEPEST_DEG, STEEPEST_DEG);

/// Values of `yaw_deg` (rad) and `tilt`; `None` if there is no valid tilt.
pub(super) fn yaw_and_tilt(table: &Table) -> (f64, Option<Tilt>) {
    let yaw = table.number_or("yaw_deg", AllowedRange::Within(-360.0, 360.0), 0.0).to_radians();
    (yaw, table.table("tilt", "a tilt").map(|table| tilt(&table).unwrap_or(Tilt::LEVEL)))
}

/// A tilt by `yaw_deg` and `pitch_deg`, or by the rotation vector `x_deg` and `y_deg`; `None` with errors.
fn tilt(table: &Table) -> Option<Tilt> {
    let reader = table.reader;
    let by_vector = ["x_deg", "y_deg"].map(|key| table.entry(key));
    let by_angles = ["yaw_deg", "pitch_deg"].map(|key| table.entry(key));
    let is_vector = by_vector.iter().any(Option::is_some);
    if is_vector && by_angles.iter().any(Option::is_some) {
        table.report(Fault::Unfit(
            "a tilt has either `yaw_deg` and `pitch_deg`, or `x_deg` and `y_deg`: remove two of them"
                .to_owned(),
        ));
        return None;
    }
    let tilt = if is_vector {
        let component = |entry: Option<Entry>| match entry {
            Some(entry) => entry.number(reader, STEEPEST),
            None => Some(0.0),
        };
        let [x, y] = by_vector.map(component);
        let tilt = Tilt::from_about_x_and_y(x?.to_radians(), y?.to_radians());
        if tilt.pitch > STEEPEST_DEG.to_radians() {
            let pitch = number(deg(tilt.pitch));
            let steepest = number(STEEPEST_DEG);
            table.report(Fault::Unfit(format!(
                "`x_deg` and `y_deg` amount to a tilt by {pitch}°, but at most {steepest}° are allowed"
            )));
            return None;
        }
        Some(tilt)
    } else {
        let toward = table.number("yaw_deg", AllowedRange::Within(-360.0, 360.0));
        let pitch = table.number("pitch_deg", STEEPEST);
        toward
            .zip(pitch)
            .map(|(yaw, pitch)| Tilt { yaw: yaw.to_radians(), pitch: pitch.to_radians() })
    };
    table.finish();
    tilt
}

/// The points of a list (m).
pub(super) fn points(entry: &Entry, reader: &Reader) -> Option<Vec<Vector3<f64>>> {
    // All points are read before the first error returns, so that every error is reported.
    let points: Vec<_> = entry.list(reader)?.iter().map(|point| point.point(reader)).collect();
    points.into_iter().collect()
}
