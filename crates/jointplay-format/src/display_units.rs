//! Units of lengths in messages: mm and µm, or inches and mils.

use crate::mechanism::LengthUnit;
use crate::number::{fixed, number, rounded};
use crate::units::{mm, um};

/// Units in which messages show lengths.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum DisplayUnits {
    /// Millimetres, and micrometres for small lengths.
    #[default]
    Metric,
    /// Inches, and mils for small lengths.
    Imperial,
}

/// Metres in a mil, a thousandth of an inch.
const MIL: f64 = 25.4e-6;
/// Significant digits of a length that metric messages show with all its digits.
const DIGITS: usize = 9;
/// Decimals of inches in addition to those of the same length in mm.
const MORE_OF_INCHES: usize = 2;
/// Decimals of mils in addition to those of the same length in µm.
const MORE_OF_MILS: usize = 1;

impl DisplayUnits {
    /// The units for a file with this unit of lengths.
    #[must_use]
    pub fn of(length: LengthUnit) -> Self {
        if length == LengthUnit::Inch { Self::Imperial } else { Self::Metric }
    }

    /// The units with this name of their length: `mm` or `in`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        [Self::Metric, Self::Imperial].into_iter().find(|units| units.unit() == name)
    }

    /// Symbol of the unit of lengths.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Metric => "mm",
            Self::Imperial => "in",
        }
    }

    /// Symbol of the unit of small lengths.
    #[must_use]
    pub fn small_unit(self) -> &'static str {
        match self {
            Self::Metric => "µm",
            Self::Imperial => "mil",
        }
    }

    /// A length in the unit of lengths, from metres.
    #[must_use]
    pub fn from_meters(self, meters: f64) -> f64 {
        match self {
            Self::Metric => mm(meters),
            Self::Imperial => LengthUnit::Inch.from_meters(meters),
        }
    }

    /// A length in the unit of small lengths, from metres.
    #[must_use]
    pub fn small_from_meters(self, meters: f64) -> f64 {
        match self {
            Self::Metric => um(meters),
            Self::Imperial => meters / MIL,
        }
    }

    /// Decimals that show a length as finely as this number of decimals of mm.
    #[must_use]
    pub fn decimals(self, of_mm: usize) -> usize {
        match self {
            Self::Metric => of_mm,
            Self::Imperial => of_mm + MORE_OF_INCHES,
        }
    }

    /// Decimals that show a small length as finely as this number of decimals of µm.
    #[must_use]
    pub fn small_decimals(self, of_um: usize) -> usize {
        match self {
            Self::Metric => of_um,
            Self::Imperial => of_um + MORE_OF_MILS,
        }
    }

    /// The number of a length without its unit, as finely as this number of decimals of mm.
    #[must_use]
    pub fn bare(self, meters: f64, of_mm: usize) -> String {
        fixed(self.from_meters(meters), self.decimals(of_mm))
    }

    /// The text of a length, as finely as this number of decimals of mm.
    #[must_use]
    pub fn length(self, meters: f64, of_mm: usize) -> String {
        format!("{} {}", self.bare(meters, of_mm), self.unit())
    }

    /// The text of a small length, as finely as this number of decimals of µm.
    #[must_use]
    pub fn small(self, meters: f64, of_um: usize) -> String {
        let value = fixed(self.small_from_meters(meters), self.small_decimals(of_um));
        format!("{value} {}", self.small_unit())
    }

    /// The text of a length with this number of significant digits.
    #[must_use]
    pub fn significant(self, meters: f64, digits: usize) -> String {
        format!("{} {}", rounded(self.from_meters(meters), digits), self.unit())
    }

    /// The number of a length without its unit: in mm with all digits, in inches with nine.
    #[must_use]
    pub fn number(self, meters: f64) -> String {
        match self {
            Self::Metric => number(mm(meters)),
            Self::Imperial => rounded(self.from_meters(meters), DIGITS),
        }
    }

    /// The text of a length with all digits in mm, or nine in inches.
    #[must_use]
    pub fn exact(self, meters: f64) -> String {
        format!("{} {}", self.number(meters), self.unit())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_as_fine_in_inches_as_in_millimetres() {
        let texts = |units: DisplayUnits| {
            let [length, small] = [units.length(0.0254, 3), units.small(50.8e-6, 1)];
            [length, small, units.exact(0.093_218), units.significant(0.012_345_678, 4)]
        };
        assert_eq!(texts(DisplayUnits::Metric), ["25.400 mm", "50.8 µm", "93.218 mm", "12.35 mm"]);
        assert_eq!(
            texts(DisplayUnits::Imperial),
            ["1.00000 in", "2.00 mil", "3.67 in", "0.4861 in"]
        );
    }

    #[test]
    fn units_have_the_names_of_files() {
        for (name, length) in LengthUnit::ALL {
            let units = DisplayUnits::of(length);
            assert_eq!(units == DisplayUnits::Imperial, name == "in");
        }
        assert_eq!(DisplayUnits::named("in"), Some(DisplayUnits::Imperial));
        assert_eq!(DisplayUnits::named("mm"), Some(DisplayUnits::Metric));
        assert_eq!(DisplayUnits::named("cm"), None);
    }
}
