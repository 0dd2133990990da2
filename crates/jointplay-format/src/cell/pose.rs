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

/// Values of `heading_deg` (rad) and `tilt`; `None` if there is no valid tilt.
pub(super) fn heading_and_tilt(table: &Table) -> (f64, Option<Tilt>) {
    let heading =
        table.number_or("heading_deg", AllowedRange::Within(-360.0, 360.0), 0.0).to_radians();
    (heading, table.table("tilt", "a tilt").map(|table| tilt(&table).unwrap_or(Tilt::LEVEL)))
}

/// A tilt by `azimuth_deg` and `angle_deg`, or by the rotation vector `x_deg` and `y_deg`; `None` with errors.
fn tilt(table: &Table) -> Option<Tilt> {
    let reader = table.reader;
    let by_vector = ["x_deg", "y_deg"].map(|key| table.entry(key));
    let by_angles = ["azimuth_deg", "angle_deg"].map(|key| table.entry(key));
    let is_vector = by_vector.iter().any(Option::is_some);
    if is_vector && by_angles.iter().any(Option::is_some) {
        table.report(Fault::Unfit(
            "a tilt has either `azimuth_deg` and `angle_deg`, or `x_deg` and `y_deg`: remove two of them"
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
        if tilt.angle > STEEPEST_DEG.to_radians() {
            let angle = number(deg(tilt.angle));
            let steepest = number(STEEPEST_DEG);
            table.report(Fault::Unfit(format!(
                "`x_deg` and `y_deg` amount to a tilt by {angle}°, but at most {steepest}° are allowed"
            )));
            return None;
        }
        Some(tilt)
    } else {
        let azimuth = table.number("azimuth_deg", AllowedRange::Within(-360.0, 360.0));
        let angle = table.number("angle_deg", STEEPEST);
        azimuth.zip(angle).map(|(azimuth, angle)| Tilt {
            azimuth: azimuth.to_radians(),
            angle: angle.to_radians(),
        })
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
