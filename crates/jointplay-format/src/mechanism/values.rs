//! Numbers, lengths, angles and directions of a file, in SI units.

use jointplay_core::mechanism::VirtualMotion;
use jointplay_core::mechanism::joint::Coordinate;
use nalgebra::{Unit, Vector3};
use toml::de::DeValue;

use super::problem::Problem;
use super::tree::{AllowedRange, Entry, Reader, Table};
use crate::expression::{AngleUnit, Scope};
use crate::file_problem::FileProblem;
use crate::number::number;
use crate::units::shift;

/// The unit of lengths in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    /// Metres.
    Meter,
    /// Millimetres.
    Millimeter,
    /// Micrometres.
    Micrometer,
    /// Inches.
    Inch,
}

/// The units of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Units {
    /// Of lengths.
    pub length: LengthUnit,
    /// Of angles.
    pub angle: AngleUnit,
}

impl Units {
    /// Metres and radians.
    pub const SI: Self = Self { length: LengthUnit::Meter, angle: AngleUnit::Radian };

    /// Millimetres and degrees, as in robot files.
    pub const MM: Self = Self { length: LengthUnit::Millimeter, angle: AngleUnit::Degree };

    /// A displacement along or about a virtual joint in these units, from m or rad.
    #[must_use]
    pub fn of_motion(self, motion: VirtualMotion, value: f64) -> f64 {
        match motion {
            VirtualMotion::Slide(_) => self.length.from_meters(value),
            VirtualMotion::Turn { .. } => self.angle.from_radians(value),
        }
    }
}

impl LengthUnit {
    /// All of them, with their names in files.
    pub const ALL: [(&str, Self); 4] = [
        ("m", Self::Meter),
        ("mm", Self::Millimeter),
        ("um", Self::Micrometer),
        ("in", Self::Inch),
    ];

    /// Metres from a length in this unit.
    #[must_use]
    pub fn to_meters(self, length: f64) -> f64 {
        match self {
            Self::Meter => length,
            Self::Millimeter => shift(length, -3),
            Self::Micrometer => shift(length, -6),
            Self::Inch => length * 0.0254,
        }
    }

    /// A length in this unit from metres.
    #[must_use]
    pub fn from_meters(self, meters: f64) -> f64 {
        match self {
            Self::Meter => meters,
            Self::Millimeter => shift(meters, 3),
            Self::Micrometer => shift(meters, 6),
            Self::Inch => meters / 0.0254,
        }
    }

    /// Decimals that resolve about a millionth of a millimetre.
    #[must_use]
    pub fn decimals(self) -> usize {
        match self {
            Self::Meter => 9,
            Self::Millimeter => 6,
            Self::Micrometer => 3,
            Self::Inch => 8,
        }
    }

    /// Its name, as in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Meter => "m",
            Self::Millimeter => "mm",
            Self::Micrometer => "um",
            Self::Inch => "in",
        }
    }
}

/// The largest coordinate of a point (m), and the largest of a joint (m, rad), that a file may name: far from where squares overflow.
pub const LARGEST_COORDINATE: f64 = 1e6;

/// Evaluates the numbers of one file.
pub(super) struct Values<'r, 'a> {
    pub(super) reader: &'r Reader<'a>,
    pub(super) units: Units,
    pub(super) scope: Scope,
}

impl Values<'_, '_> {
    /// A finite number or expression, in the units of the file.
    pub(super) fn number(&self, entry: &Entry) -> Option<f64> {
        match entry.value.get_ref() {
            DeValue::String(source) => {
                let formula = entry.formula(self.reader, source, self.units.angle)?;
                let value = entry.evaluate(self.reader, source, &formula, &self.scope)?;
                entry.within(self.reader, value, AllowedRange::Any)
            }
            DeValue::Integer(_) | DeValue::Float(_) => entry.number(self.reader, AllowedRange::Any),
            _ => {
                entry.type_error(self.reader, "a number or an expression");
                None
            }
        }
    }

    /// A positive number that is optional, in the units of the file.
    pub(super) fn positive(&self, table: &Table, key: &'static str) -> Option<f64> {
        let entry = table.entry(key)?;
        let value = self.number(&entry)?;
        if value > 0.0 {
            return Some(value);
        }
        let (key, needed) = (key.to_owned(), "positive".to_owned());
        entry.report(self.reader, FileProblem::OutOfRange { key, value, needed });
        None
    }

    /// Metres from a length of the file.
    pub(super) fn length(&self, value: f64) -> f64 {
        self.units.length.to_meters(value)
    }

    /// Radians from an angle of the file.
    pub(super) fn angle(&self, value: f64) -> f64 {
        self.units.angle.to_radians(value)
    }

    /// Metres or radians from a coordinate of the file; a value beyond the range of mechanisms is reported.
    pub(super) fn coordinate(
        &self,
        entry: &Entry,
        coordinate: Coordinate,
        value: f64,
    ) -> Option<f64> {
        let si = match coordinate {
            Coordinate::Slide => self.length(value),
            Coordinate::Turn => self.angle(value),
        };
        if si.abs() <= LARGEST_COORDINATE {
            return Some(si);
        }
        let (most, unit) = match coordinate {
            Coordinate::Slide => {
                (self.units.length.from_meters(LARGEST_COORDINATE), self.units.length.name())
            }
            Coordinate::Turn => {
                (self.units.angle.from_radians(LARGEST_COORDINATE), self.units.angle.name())
            }
        };
        let needed = format!("within ±{} {unit}", number(most));
        let key = entry.key.to_owned();
        entry.report(self.reader, FileProblem::OutOfRange { key, value, needed });
        None
    }

    /// Three numbers in the units of the file, with their entries.
    fn vector<'s, 'b>(&self, entry: &Entry<'s, 'b>) -> Option<[(Entry<'s, 'b>, f64); 3]> {
        let list = entry.list(self.reader)?;
        let numbers: Vec<_> =
            list.iter().map(|entry| Some((*entry, self.number(entry)?))).collect();
        if numbers.len() != 3 {
            let (key, found) = (entry.key.to_owned(), numbers.len());
            let needed = "3: x, y, z".to_owned();
            entry.report(self.reader, FileProblem::Count { key, found, needed });
        }
        numbers.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()
    }

    /// A point (m).
    pub(super) fn point(&self, entry: &Entry) -> Option<Vector3<f64>> {
        let [x, y, z] = self
            .vector(entry)?
            .map(|(entry, value)| self.coordinate(&entry, Coordinate::Slide, value));
        Some(Vector3::new(x?, y?, z?))
    }

    /// A direction, from numbers of any length but zero.
    pub(super) fn direction(&self, entry: &Entry) -> Option<Unit<Vector3<f64>>> {
        let vector = Vector3::from(self.vector(entry)?.map(|(_, value)| value));
        let largest = vector.amax();
        if largest == 0.0 {
            entry.report(self.reader, Problem::NoDirection { key: entry.key.to_owned() });
            return None;
        }
        // Divided first, for squares of very large or small numbers are no numbers.
        Some(Unit::new_normalize(vector / largest))
    }
}
