//! Messages of violations, in units of display and degrees.

use jointplay_cell::check::{Violation, ViolationKind, ViolationQuantity};
use jointplay_cell::workcell::Cell;

use jointplay_format::display_units::DisplayUnits;
use jointplay_format::number::number as plain;
use jointplay_format::units::{deg, um};

/// Unit of messages, and a value of a violation in this unit.
pub(crate) fn in_display_unit(
    one: &Violation,
    value: f64,
    units: DisplayUnits,
) -> (&'static str, f64) {
    let length = || units.from_meters(value);
    let of_length = |metric: &'static str, imperial: &'static str| match units {
        DisplayUnits::Metric => metric,
        DisplayUnits::Imperial => imperial,
    };
    match (one.quantity, one.kind) {
        (ViolationQuantity::None, _) => ("", value),
        (ViolationQuantity::SpecificForce, _) => ("m/s²", value),
        (ViolationQuantity::Time, _) => ("s", value),
        (ViolationQuantity::Length, ViolationKind::Velocity) => {
            (of_length("mm/s", "in/s"), length())
        }
        (ViolationQuantity::Length, ViolationKind::Acceleration) => {
            (of_length("mm/s²", "in/s²"), length())
        }
        (ViolationQuantity::Length, ViolationKind::Jerk) => (of_length("mm/s³", "in/s³"), length()),
        (ViolationQuantity::Length, _) => (units.unit(), length()),
        (ViolationQuantity::Angle, ViolationKind::Velocity) => ("°/s", deg(value)),
        (ViolationQuantity::Angle, ViolationKind::Acceleration) => ("°/s²", deg(value)),
        (ViolationQuantity::Angle, ViolationKind::Jerk) => ("°/s³", deg(value)),
        (ViolationQuantity::Angle, _) => ("°", deg(value)),
    }
}

/// The message of a violation, without its time and line.
#[must_use]
pub fn explain_violation(cell: &Cell, one: &Violation, units: DisplayUnits) -> String {
    let name =
        |k: usize| one.entities.get(k).map_or_else(String::new, |&one| cell.entity_name(one));
    let label =
        |k: usize| one.entities.get(k).map_or_else(String::new, |&one| cell.entity_label(one));
    let number = |value: f64| quantity(one, value, DECIMALS, units);
    let (worst, limit) = distinct(one, units);
    match one.kind {
        ViolationKind::Position => {
            format!("axis {} reaches {worst}, its limit is {limit}", name(0))
        }
        ViolationKind::Velocity => {
            format!("axis {} moves at {worst}, its limit is {limit}", name(0))
        }
        ViolationKind::Acceleration => {
            format!("axis {} accelerates at {worst}, its limit is {limit}", name(0))
        }
        ViolationKind::Jerk => {
            format!("axis {} has a jerk of {worst}, its limit is {limit}", name(0))
        }
        ViolationKind::Tilt => format!("the platform tilts by {worst}, its limit is {limit}"),
        ViolationKind::Play => {
            format!("the virtual joints are displaced by {worst}, the play budget is {limit}")
        }
        ViolationKind::Slip if one.worst.is_infinite() => {
            format!("the wafer on {} lifts off its supports", name(0))
        }
        ViolationKind::Slip => format!(
            "the wafer on {} slips: it requires friction of {worst}, available are {limit}",
            name(0)
        ),
        ViolationKind::Collision if one.worst < 0.0 => {
            format!(
                "{} and {} collide with a penetration depth of {}",
                label(0),
                label(1),
                number(-one.worst)
            )
        }
        ViolationKind::Collision => format!("{} and {} touch", label(0), label(1)),
        ViolationKind::Clearance => {
            format!(
                "{} comes within {worst} of {}; the required clearance is {limit}",
                label(0),
                label(1)
            )
        }
        ViolationKind::SlotClearance => {
            let margin = one.limit - cell.slot_clearance;
            let of_it = if margin > LEAST_MARGIN {
                let margin = number(margin);
                format!(
                    ", {margin} of it for the uncertainty of the station (coverage factor {})",
                    plain(cell.coverage_factor)
                )
            } else {
                String::new()
            };
            format!(
                "{} comes within {worst} of {}; the required slot clearance is {limit}{of_it}",
                label(0),
                label(1)
            )
        }
        ViolationKind::PlaneBudget => format!(
            "the plane of the wafer on {} may deviate by {:.1} µrad from that of {}, with the uncertainty of the station (coverage factor {}); {:.1} µrad are allowed (`plane_urad`)",
            name(0),
            um(one.worst),
            name(1),
            plain(cell.coverage_factor),
            um(one.limit)
        ),
        ViolationKind::KeepOut if one.worst < 0.0 => {
            format!(
                "{} is in keep-out zone {} with a penetration depth of {}",
                label(0),
                name(1),
                number(-one.worst)
            )
        }
        ViolationKind::KeepOut => format!("{} touches keep-out zone {}", label(0), name(1)),
        ViolationKind::LongDwell => format!(
            "{} dwells in {} for {worst}, allowed are {limit}: pick it {} earlier",
            label(0),
            label(1),
            number(one.excess())
        ),
        ViolationKind::ShortDwell => format!(
            "{} leaves {} after {worst}, required are {limit}: wait {} longer before this instruction",
            label(0),
            label(1),
            number(one.excess())
        ),
        ViolationKind::LeftInStation => format!(
            "{} is left in {} at the end of the program, where a wafer may dwell for {limit}: pick it before the program ends",
            label(0),
            label(1)
        ),
        ViolationKind::SafeZone => format!(
            "the wafer centre of {} is {worst} outside safe zone {} while the robot rotates",
            name(0),
            name(1)
        ),
        _ => one.detail.clone(),
    }
}

/// Smallest part of a slot clearance that is listed as uncertainty (m).
const LEAST_MARGIN: f64 = 1e-9;
/// Decimals of a value in a message, before more are needed to distinguish it from its limit.
const DECIMALS: usize = 3;
/// Largest number of decimals.
const MOST_DECIMALS: usize = 12;
/// Shorter lengths are in the unit of small lengths in a message (m).
const SHORTEST: f64 = 1e-4;

/// The worst value and the limit of a violation, with enough decimals to differ.
fn distinct(one: &Violation, units: DisplayUnits) -> (String, String) {
    let with = |decimals| [one.worst, one.limit].map(|value| quantity(one, value, decimals, units));
    let found = (DECIMALS..MOST_DECIMALS).map(with).find(|[worst, limit]| worst != limit);
    let [worst, limit] = found.unwrap_or_else(|| with(MOST_DECIMALS));
    (worst, limit)
}

/// A value of a violation with its unit.
fn quantity(one: &Violation, si: f64, decimals: usize, units: DisplayUnits) -> String {
    let (mut unit, mut value) = in_display_unit(one, si, units);
    let mut decimals = decimals;
    if unit == units.unit() && si != 0.0 && si.abs() < SHORTEST {
        (unit, value) = (units.small_unit(), units.small_from_meters(si));
        decimals = units.small_decimals(decimals);
    } else if one.quantity == ViolationQuantity::Length {
        decimals = units.decimals(decimals);
    }
    let gap = if unit.starts_with('°') { "" } else { " " };
    format!("{}{gap}{unit}", short(value, decimals)).trim_end().to_owned()
}

/// A number with some decimals, but at least two significant digits, and without zeros at its end.
fn short(value: f64, decimals: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    #[expect(clippy::cast_possible_truncation, reason = "exponents of doubles are small")]
    let two_digits = 1 - value.abs().log10().floor() as i32;
    let decimals = decimals.max(usize::try_from(two_digits).unwrap_or(0)).min(MOST_DECIMALS);
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jointplay_cell::program::{Phase, SourceLocation};

    #[test]
    fn numbers_have_three_decimals_or_two_significant_digits() {
        for (value, text) in [
            (1.0, "1"),
            (0.000_123_456_789, "0.00012"),
            (1234.5678, "1234.568"),
            (0.0, "0"),
            (-12.5, "-12.5"),
            (1e-30, "0"),
        ] {
            assert_eq!(short(value, DECIMALS), text);
        }
    }

    #[test]
    fn short_lengths_are_in_micrometres_and_values_differ_from_their_limits() {
        let violation = |worst, limit| Violation {
            kind: ViolationKind::Clearance,
            entities: Vec::new(),
            instruction: 0,
            place: SourceLocation::default(),
            step: 0,
            phase: Phase::Move,
            start: 0.0,
            end: 0.0,
            worst_time: 0.0,
            worst,
            limit,
            quantity: ViolationQuantity::Length,
            detail: String::new(),
        };
        let shown = |worst, limit| distinct(&violation(worst, limit), DisplayUnits::Metric);
        let expected = |worst: &str, limit: &str| (worst.to_owned(), limit.to_owned());
        assert_eq!(shown(7.5464e-8, 1e-3), expected("0.075 µm", "1 mm"));
        assert_eq!(shown(0.999_999_9e-3, 1e-3), expected("0.9999999 mm", "1 mm"));
        let inches = |worst, limit| distinct(&violation(worst, limit), DisplayUnits::Imperial);
        assert_eq!(inches(50.8e-6, 2.54e-3), expected("2 mil", "0.1 in"));
        assert_eq!(inches(2.539_999e-3, 2.54e-3), expected("0.09999996 in", "0.1 in"));
    }
}
