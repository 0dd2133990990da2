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
        let message = format!("{limit} is at {value} {unit}, its limits are {min} to {max} {unit}");
        LimitReport { limit, found, min, max, unit, message }
    };
    found.iter().map(report).collect()
}
