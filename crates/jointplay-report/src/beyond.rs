//! Coordinates of a mechanism beyond their limits.

use jointplay_core::mechanism::BeyondLimits;

use crate::limits::LimitReport;
use jointplay_format::coordinates::Coordinates;
use jointplay_format::explain::beyond;

/// Reports coordinates beyond their limits or clearance, in the units of the file.
#[must_use]
pub fn beyond_limits(coordinates: &Coordinates, found: &[BeyondLimits]) -> Vec<LimitReport> {
    let report = |one: &BeyondLimits| {
        let in_file = |value| coordinates.from_si(one.coordinate, value);
        let [min, max] = one.limits.map(in_file);
        let (found, unit) = (in_file(one.value), coordinates.unit(one.coordinate));
        let limit = coordinates.all()[one.coordinate].name.clone();
        let value = beyond(found, min, max);
        let range = match [min, max].map(f64::is_finite) {
            [true, false] => format!("its least value is {min} {unit}"),
            [false, true] => format!("its greatest value is {max} {unit}"),
            _ => format!("its limits are {min} to {max} {unit}"),
        };
        let message = format!("{limit} is at {value} {unit}, {range}");
        let [min, max] = [min, max].map(|end| end.is_finite().then_some(end));
        LimitReport { limit, found, min, max, unit, message }
    };
    found.iter().map(report).collect()
}
