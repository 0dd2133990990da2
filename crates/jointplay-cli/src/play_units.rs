//! Units in which text shows lengths of mechanisms and displacements of virtual joints.

use jointplay::format::mechanism::LengthUnit;
use jointplay::format::number::fixed;
use jointplay::format::units::m_from_mm;

/// A length of a report in another unit.
pub(crate) fn in_unit(unit: LengthUnit, length_mm: f64) -> f64 {
    unit.from_meters(m_from_mm(length_mm))
}

/// Units of displacements: mm and µm, or inches and mils for a file in inches.
#[derive(Clone, Copy)]
pub(crate) struct PlayUnits {
    is_inch: bool,
}

impl PlayUnits {
    /// The units for a file with this unit of lengths.
    pub(crate) fn of(length: LengthUnit) -> Self {
        Self { is_inch: length == LengthUnit::Inch }
    }

    /// The text of a length of a report, to some 10 nm.
    pub(crate) fn length(self, length_mm: f64) -> String {
        if self.is_inch {
            let inches = in_unit(LengthUnit::Inch, length_mm);
            format!("{} {}", fixed(inches, 6), LengthUnit::Inch.name())
        } else {
            format!("{} mm", fixed(length_mm, 5))
        }
    }

    /// A displacement of a report in `um` or another unit, with the unit of the text.
    pub(crate) fn displacement(self, value: f64, unit: &'static str) -> (f64, &'static str) {
        match (unit, self.is_inch) {
            ("um", false) => (value, "µm"),
            // A mil is 25.4 µm.
            ("um", true) => (value / 25.4, "mil"),
            _ => (value, unit),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displacements_follow_the_unit_of_the_file() {
        let metric = PlayUnits::of(LengthUnit::Meter);
        assert_eq!(metric.length(2.0), "2.00000 mm");
        assert_eq!(metric.displacement(3.0, "um"), (3.0, "µm"));
        let inch = PlayUnits::of(LengthUnit::Inch);
        assert_eq!(inch.length(25.4), "1.000000 in");
        assert_eq!(inch.displacement(50.8, "um"), (2.0, "mil"));
        assert_eq!(inch.displacement(3.0, "mrad"), (3.0, "mrad"));
    }
}
