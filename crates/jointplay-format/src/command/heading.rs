//! Headings of columns with values of coordinates: `leg 1`, `leg 1_mm`.

use jointplay_core::mechanism::Mechanism;

use super::value::Unit;
use crate::coordinates::{self, Coordinates};

/// A coordinate with the unit of its column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heading {
    coordinate: usize,
    unit: Unit,
}

impl Heading {
    /// The joint coordinate of a heading: its name, in the unit of the file, or its name, `_` and a unit.
    ///
    /// # Errors
    /// [`coordinates::Error`]
    pub fn find(
        coordinates: &Coordinates,
        mechanism: &Mechanism,
        heading: &str,
    ) -> Result<Self, coordinates::Error> {
        let quantity = |coordinate: usize| coordinates.all()[coordinate].quantity;
        let with_unit = heading.rsplit_once('_').and_then(|(name, unit)| {
            let coordinate = coordinates.find(mechanism, name).ok()?;
            let unit = Unit::find(unit).filter(|unit| unit.measures(quantity(coordinate)))?;
            Some(Self { coordinate, unit })
        });
        coordinates.find(mechanism, heading).map_or_else(
            |error| with_unit.ok_or(error),
            |coordinate| {
                let unit = Unit::of(quantity(coordinate), coordinates.units());
                Ok(Self { coordinate, unit })
            },
        )
    }

    /// Index of the coordinate.
    #[must_use]
    pub fn coordinate(self) -> usize {
        self.coordinate
    }

    /// A value of the column in SI units (m or rad).
    #[must_use]
    pub fn to_si(self, value: f64) -> f64 {
        self.unit.to_si(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_is_a_name_with_or_without_a_unit_of_its_quantity() {
        let file = crate::mechanism::parse(crate::catalogue::find("four-bar").unwrap().text);
        let file = file.unwrap();
        let coordinates = Coordinates::of(&file);
        let find = |heading: &str| Heading::find(&coordinates, &file.mechanism, heading);
        assert!((find("A").unwrap().to_si(180.0) - std::f64::consts::PI).abs() < 1e-15);
        assert_eq!(find("A_rad").unwrap().to_si(1.0), 1.0);
        assert_eq!(find("B_deg").unwrap().coordinate(), find("B").unwrap().coordinate());
        assert!(find("A_mm").is_err());
        assert!(find("A_").is_err());
    }
}
