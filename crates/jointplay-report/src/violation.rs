//! Violations in words, in mm and degrees.

use jointplay_cell::check::{Kind, Unit, Violation};
use jointplay_cell::workcell::Cell;

use jointplay_format::units::{deg, mm};

/// A value of a violation in the unit that people read, with that unit.
pub(crate) fn told(one: &Violation, value: f64) -> (&'static str, f64) {
    match (one.unit, one.kind) {
        (Unit::None, _) => ("", value),
        (Unit::Acceleration, _) => ("m/s²", value),
        (Unit::Length, Kind::Velocity) => ("mm/s", mm(value)),
        (Unit::Length, Kind::Acceleration) => ("mm/s²", mm(value)),
        (Unit::Length, Kind::Jerk) => ("mm/s³", mm(value)),
        (Unit::Length, _) => ("mm", mm(value)),
        (Unit::Angle, Kind::Velocity) => ("°/s", deg(value)),
        (Unit::Angle, Kind::Acceleration) => ("°/s²", deg(value)),
        (Unit::Angle, Kind::Jerk) => ("°/s³", deg(value)),
        (Unit::Angle, _) => ("°", deg(value)),
    }
}

/// What is wrong, in mm and degrees, without its time and line.
#[must_use]
pub fn explain_violation(cell: &Cell, one: &Violation) -> String {
    let name =
        |k: usize| one.entities.get(k).map_or_else(String::new, |&one| cell.entity_name(one));
    let number = |value: f64| {
        let (unit, value) = told(one, value);
        let gap = if unit.starts_with('°') { "" } else { " " };
        format!("{}{gap}{unit}", short(value))
    };
    let (mut worst, mut limit) = (number(one.worst), number(one.limit));
    if worst == limit {
        // Two numbers that differ read as two.
        let (unit, [value, allowed]) = (told(one, 0.0).0, [one.worst, one.limit]);
        let with = |digits: usize| {
            let text = |value: f64| format!("{:.digits$} {unit}", told(one, value).1);
            (text(value), text(allowed))
        };
        let found = (6..12).map(with).find(|(worst, limit)| worst != limit);
        (worst, limit) = found.unwrap_or_else(|| with(12));
    }
    match one.kind {
        Kind::Position => format!("axis {} comes to {worst}, its limit is {limit}", name(0)),
        Kind::Velocity => format!("axis {} runs at {worst}, its limit is {limit}", name(0)),
        Kind::Acceleration => {
            format!("axis {} accelerates by {worst}, its limit is {limit}", name(0))
        }
        Kind::Jerk => format!("axis {} jerks by {worst}, its limit is {limit}", name(0)),
        Kind::Tilt => format!("the platform leans by {worst}, its limit is {limit}"),
        Kind::Play => {
            format!("the virtual joints move by {worst}, the play budget is {limit}")
        }
        Kind::Slip if one.worst.is_infinite() => {
            format!("the wafer on {} lifts off what it rests on", name(0))
        }
        Kind::Slip => format!(
            "the wafer on {} slips: {worst} of friction are needed to hold and turn it, there are {limit}",
            name(0)
        ),
        Kind::Collision if one.worst < 0.0 => {
            format!("{} and {} collide, {} deep", name(0), name(1), number(-one.worst))
        }
        Kind::Collision => format!("{} and {} touch", name(0), name(1)),
        Kind::Clearance => {
            format!("{} comes within {worst} of {}, asked for are {limit}", name(0), name(1))
        }
        Kind::SlotClearance => {
            format!("{} comes within {worst} of {}, the slots ask for {limit}", name(0), name(1))
        }
        Kind::KeepOut if one.worst < 0.0 => {
            format!("{} is in keep-out zone {}, {} deep", name(0), name(1), number(-one.worst))
        }
        Kind::KeepOut => format!("{} touches keep-out zone {}", name(0), name(1)),
        Kind::SafeZone => format!(
            "the wafer centre of {} is {worst} outside safe zone {} while the robot turns",
            name(0),
            name(1)
        ),
        _ => one.detail.clone(),
    }
}

/// Six significant digits at most, and no zeros behind them.
fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    #[expect(clippy::cast_possible_truncation, reason = "exponents of doubles are small")]
    let digits = 5 - value.abs().log10().floor() as i32;
    let decimals = usize::try_from(digits.clamp(0, 9)).unwrap_or(0);
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

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (1.0, "1"),
            (0.000_123_456_789, "0.000123457"),
            (1234.5678, "1234.57"),
            (0.0, "0"),
            (-12.5, "-12.5"),
        ] {
            assert_eq!(short(value), text);
        }
    }
}
