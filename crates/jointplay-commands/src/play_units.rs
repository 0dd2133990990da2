//! Units in which text shows lengths of mechanisms and displacements of virtual joints.

use jointplay::format::display_units::DisplayUnits;
use jointplay::format::mechanism::LengthUnit;
use jointplay::format::units::{m_from_mm, m_from_um};

/// A length of a report in another unit.
pub(crate) fn in_unit(unit: LengthUnit, length_mm: f64) -> f64 {
    unit.from_meters(m_from_mm(length_mm))
}

/// The text of a length of a report, to some 10 nm.
pub(crate) fn play_length(units: DisplayUnits, length_mm: f64) -> String {
    units.length(m_from_mm(length_mm), 5)
}

/// A displacement of a report in `um` or another unit, with the unit of the text.
pub(crate) fn in_display_units(
    units: DisplayUnits,
    value: f64,
    unit: &'static str,
) -> (f64, &'static str) {
    match unit {
        "um" => (units.small_from_meters(m_from_um(value)), units.small_unit()),
        _ => (value, unit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displacements_follow_the_unit_of_the_file() {
        let metric = DisplayUnits::of(LengthUnit::Meter);
        assert_eq!(play_length(metric, 2.0), "2.00000 mm");
        assert_eq!(in_display_units(metric, 3.0, "um"), (3.0, "µm"));
        let inch = DisplayUnits::of(LengthUnit::Inch);
        assert_eq!(play_length(inch, 25.4), "1.0000000 in");
        assert_eq!(in_display_units(inch, 50.8, "um"), (2.0, "mil"));
        assert_eq!(in_display_units(inch, 3.0, "mrad"), (3.0, "mrad"));
    }
}
