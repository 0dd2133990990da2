//! Numbers, lengths, angles and directions of a file, in SI units.

use std::ops::Range;

use jointplay_core::mechanism::joint::Coordinate;
use nalgebra::{Unit, Vector3};
use toml::Spanned;

use super::expression::{AngleUnit, Expression, ExpressionError, Scope};
use super::file::{Number, Numbers};
use super::problem::{Error, Problem};
use crate::place::nearest;
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

impl AngleUnit {
    /// All of them, with their names in files.
    pub const ALL: [(&str, Self); 2] = [("deg", Self::Degree), ("rad", Self::Radian)];

    /// Radians from an angle in this unit.
    #[must_use]
    pub fn to_radians(self, angle: f64) -> f64 {
        match self {
            Self::Degree => angle.to_radians(),
            Self::Radian => angle,
        }
    }

    /// An angle in this unit from radians.
    #[must_use]
    pub fn from_radians(self, radians: f64) -> f64 {
        match self {
            Self::Degree => crate::units::deg(radians),
            Self::Radian => radians,
        }
    }

    /// Its name, as in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Degree => "deg",
            Self::Radian => "rad",
        }
    }
}

/// The largest length (m) and the largest angle (rad) that a file may name: far from where squares overflow.
const LARGEST: f64 = 1e6;
/// Numbers of mechanism files lie within this, in their own unit, so that no product of them overflows.
const LARGEST_NUMBER: f64 = 1e12;

/// Reads numbers of one file.
pub(super) struct Values<'a> {
    pub(super) text: &'a str,
    pub(super) units: Units,
    pub(super) scope: Scope,
}

impl Values<'_> {
    pub(super) fn wrong(&self, span: Range<usize>, problem: impl Into<Problem>) -> Error {
        Error::at(self.text, span, problem.into())
    }

    /// A finite number, in the units of the file.
    pub(super) fn number(
        &self,
        key: &'static str,
        number: &Number,
        span: Range<usize>,
    ) -> Result<f64, Error> {
        match number {
            Number::Value(value) if value.is_finite() => self.moderate(key, *value, span),
            Number::Value(value) => {
                let problem = Problem::NotFinite { key: key.to_owned(), value: *value };
                Err(self.wrong(span, problem))
            }
            Number::Expression(source) => Expression::parse(source)
                .and_then(|expression| expression.evaluate(&self.scope))
                .map_err(|error| expression_error(self.text, &span, source, error))
                .and_then(|value| self.moderate(key, value, span.clone())),
        }
    }

    /// A number that is not too large to be computed with.
    fn moderate(&self, key: &'static str, value: f64, span: Range<usize>) -> Result<f64, Error> {
        if value.abs() <= LARGEST_NUMBER {
            return Ok(value);
        }
        Err(self.wrong(span, Problem::TooLarge { key, value, most: LARGEST_NUMBER }))
    }

    /// A number brought to SI units by `to_si`.
    pub(super) fn scalar(
        &self,
        key: &'static str,
        number: &Spanned<Number>,
        to_si: impl Fn(f64) -> f64,
    ) -> Result<f64, Error> {
        self.number(key, number.get_ref(), number.span()).map(to_si)
    }

    /// A positive number, if there is one.
    pub(super) fn positive(
        &self,
        key: &'static str,
        number: Option<&Spanned<Number>>,
        to_si: impl Fn(f64) -> f64,
    ) -> Result<Option<f64>, Error> {
        let Some(number) = number else { return Ok(None) };
        let value = self.scalar(key, number, |value| value)?;
        if value > 0.0 {
            Ok(Some(to_si(value)))
        } else {
            Err(self.wrong(number.span(), Problem::NotPositive { key, value }))
        }
    }

    /// Metres from a length of the file.
    pub(super) fn length(&self, value: f64) -> f64 {
        self.units.length.to_meters(value)
    }

    /// Radians from an angle of the file.
    pub(super) fn angle(&self, value: f64) -> f64 {
        self.units.angle.to_radians(value)
    }

    /// Metres or radians from a joint coordinate of the file.
    pub(super) fn coordinate(&self, coordinate: Coordinate, value: f64) -> f64 {
        match coordinate {
            Coordinate::Slide => self.length(value),
            Coordinate::Turn => self.angle(value),
        }
    }

    /// Metres or radians from a coordinate of the file, refused where no mechanism has it.
    pub(super) fn within(
        &self,
        key: &'static str,
        coordinate: Coordinate,
        value: f64,
        span: Range<usize>,
    ) -> Result<f64, Error> {
        let si = self.coordinate(coordinate, value);
        if si.abs() <= LARGEST {
            return Ok(si);
        }
        let (most, unit) = match coordinate {
            Coordinate::Slide => (self.units.length.from_meters(LARGEST), self.units.length.name()),
            Coordinate::Turn => (self.units.angle.from_radians(LARGEST), self.units.angle.name()),
        };
        Err(self.wrong(span, Problem::Beyond { key, value, most, unit }))
    }

    fn vector(&self, key: &'static str, numbers: &Numbers) -> Result<Vector3<f64>, Error> {
        let [x, y, z] = numbers.get_ref().as_slice() else {
            let problem =
                Problem::Count { key, found: numbers.get_ref().len(), needed: "3: x, y, z".into() };
            return Err(self.wrong(numbers.span(), problem));
        };
        let number = |entry: &Spanned<Number>| self.scalar(key, entry, |value| value);
        Ok(Vector3::new(number(x)?, number(y)?, number(z)?))
    }

    /// A point (m).
    pub(super) fn point(
        &self,
        key: &'static str,
        numbers: &Numbers,
    ) -> Result<Vector3<f64>, Error> {
        let vector = self.vector(key, numbers)?;
        for (&value, entry) in vector.iter().zip(numbers.get_ref()) {
            self.within(key, Coordinate::Slide, value, entry.span())?;
        }
        Ok(vector.map(|value| self.length(value)))
    }

    /// A direction, from numbers of any length but zero.
    pub(super) fn direction(
        &self,
        key: &'static str,
        numbers: &Numbers,
    ) -> Result<Unit<Vector3<f64>>, Error> {
        let vector = self.vector(key, numbers)?;
        let largest = vector.amax();
        if largest == 0.0 {
            return Err(self.wrong(numbers.span(), Problem::NoDirection { key }));
        }
        // Divided first, for squares of very large or small numbers are no numbers.
        Ok(Unit::new_normalize(vector / largest))
    }
}

/// One of these words, by its name.
pub(super) fn choice<T: Copy>(
    text: &str,
    what: &'static str,
    word: &Spanned<String>,
    known: &[(&str, T)],
) -> Result<T, Error> {
    let found = known.iter().find(|(name, _)| name == word.get_ref());
    found.map(|(_, meaning)| *meaning).ok_or_else(|| {
        let names = known.iter().map(|(name, _)| *name);
        Error::at(text, word.span(), unknown(what, word.get_ref(), names))
    })
}

/// That a name is none of the known ones.
pub(super) fn unknown<'a>(
    what: &'static str,
    found: &str,
    known: impl Iterator<Item = &'a str> + Clone,
) -> Problem {
    Problem::Unknown {
        what,
        found: found.to_owned(),
        nearest: nearest(found, known.clone()),
        known: known.map(str::to_owned).collect(),
    }
}

/// An error of an expression, placed in the file.
pub(super) fn expression_error(
    text: &str,
    span: &Range<usize>,
    source: &str,
    error: ExpressionError,
) -> Error {
    let quoted = text.get(span.clone()).unwrap_or_default();
    // Where the string is written without escapes, the very part of it that is wrong can be shown.
    let is_plain = quoted.get(1..quoted.len().max(2) - 1) == Some(source);
    let start = span.start + 1;
    let within = start + error.span.start..start + error.span.end;
    let place = if is_plain { within } else { span.clone() };
    Error::at(text, place, error.problem.into())
}
