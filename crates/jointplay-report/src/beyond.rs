//! Coordinates of a mechanism beyond their limits.

use jointplay_core::mechanism::BeyondLimits;

use crate::limits::LimitReport;
use jointplay_format::coordinates::Coordinates;
use jointplay_format::explain::beyond;
use jointplay_format::number::rounded;

/// Reports coordinates beyond their limits or clearance, in the units of the file.
#[must_use]
pub fn beyond_limits(coordinates: &Coordinates, found: &[BeyondLimits]) -> Vec<LimitReport> {
    let report = |one: &BeyondLimits| {
        let in_file = |value| coordinates.from_si(one.coordinate, value);
        let [min, max] = one.limits.map(in_file);
        let (found, unit) = (in_file(one.value), coordinates.unit(one.coordinate));
        let limit = coordinates.all()[one.coordinate].name.clone();
        let value = beyond(found, min, max);
        // As in the file, without the round-off of units.
        let [least, most] = [min, max].map(|end| rounded(end, 12));
        let range = match [min, max].map(f64::is_finite) {
            [true, false] => format!("its least value is {least} {unit}"),
            [false, true] => format!("its greatest value is {most} {unit}"),
            _ => format!("its limits are {least} to {most} {unit}"),
        };
        let message = format!("{limit} is at {value} {unit}, {range}");
        let [min, max] = [min, max].map(|end| end.is_finite().then_some(end));
        LimitReport { limit, found, min, max, unit, message }
    };
    found.iter().map(report).collect()
}
