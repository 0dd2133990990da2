//! Numbers and quantities of a program, with their allowed values.

use std::fmt;

use jointplay_core::decimal::shift;
use jointplay_core::expression::Expression;

use super::location::{Name, SourceLocation};

/// A number in a program: a constant, or an expression of parameters, counters and arguments.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// Location of its first token.
    pub place: SourceLocation,
    /// The expression.
    pub expression: Expression<Name>,
}

impl Number {
    /// A constant without location.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Self { place: SourceLocation::default(), expression: Expression::constant(value) }
    }

    /// The number of a slot or of passes, without location.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "whole numbers of programs are far below 2⁵³")]
    pub fn whole(value: usize) -> Self {
        Self::constant(value as f64)
    }
}

/// Unit of a number in the text of a program: expressions are evaluated in it, and their values converted to SI units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Millimetres.
    Millimeter,
    /// Degrees.
    Degree,
    /// Seconds.
    Second,
    /// Percent.
    Percent,
}

impl Unit {
    /// All units.
    pub const ALL: [Self; 4] = [Self::Millimeter, Self::Degree, Self::Second, Self::Percent];

    /// Symbol of the unit.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Millimeter => "mm",
            Self::Degree => "deg",
            Self::Second => "s",
            Self::Percent => "%",
        }
    }

    /// The SI value of a number in this unit.
    #[must_use]
    pub fn to_si(self, value: f64) -> f64 {
        match self {
            Self::Millimeter => shift(value, -3),
            Self::Degree => value.to_radians(),
            Self::Second => value,
            Self::Percent => shift(value, -2),
        }
    }

    /// The number in this unit of an SI value: among all numbers that convert to it, one with few decimals if there is one.
    #[must_use]
    pub fn from_si(self, si: f64) -> f64 {
        match self {
            Self::Millimeter => shift(si, 3),
            Self::Degree => {
                let degrees = si.to_degrees();
                let rounded =
                    |digits: usize| format!("{degrees:.digits$e}").parse().unwrap_or(degrees);
                (0..17).map(rounded).find(|it| it.to_radians() == si).unwrap_or(degrees)
            }
            Self::Second => si,
            Self::Percent => shift(si, 2),
        }
    }
}

/// A number with its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// The number, in the unit.
    pub number: Number,
    /// The unit.
    pub unit: Unit,
}

impl Quantity {
    /// The quantity of an SI value, without location.
    #[must_use]
    pub fn from_si(si: f64, unit: Unit) -> Self {
        Self { number: Number::constant(unit.from_si(si)), unit }
    }
}

/// Allowed values of a number in a program, in the unit of the text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AllowedValues {
    /// Whether the value has to be a whole number.
    pub is_whole: bool,
    /// Least value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// The unit; `None` for a number without unit.
    pub unit: Option<Unit>,
}

impl AllowedValues {
    /// Numbers of slots, far beyond the slots of any station.
    pub const SLOT_NUMBER: Self = Self { is_whole: true, min: 1.0, max: 1e5, unit: None };
    /// Numbers of passes; the bounds on the expansion limit it further.
    pub const PASSES: Self = Self { is_whole: true, min: 0.0, max: 1e15, unit: None };
    /// Targets of rotary axes, and azimuths.
    pub const ANGLE: Self = Self::of(Unit::Degree, -1e6, 1e6);
    /// Targets of linear axes, and displacements.
    pub const LENGTH: Self = Self::of(Unit::Millimeter, -1e6, 1e6);
    /// Dwells: a day at most.
    pub const TIME: Self = Self::of(Unit::Second, 0.0, 86_400.0);
    /// Shares of the limits.
    pub const SPEED: Self = Self::of(Unit::Percent, 0.01, 100.0);
    /// Radii of blending.
    pub const BLEND_RADIUS: Self = Self::of(Unit::Millimeter, 0.0, 1000.0);
    /// Tilts; rods cannot support a vertical platform.
    pub const TILT: Self = Self::of(Unit::Degree, -89.0, 89.0);

    const fn of(unit: Unit, min: f64, max: f64) -> Self {
        Self { is_whole: false, min, max, unit: Some(unit) }
    }

    /// Whether a value is allowed.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value) && (!self.is_whole || value.fract() == 0.0)
    }
}

impl fmt::Display for AllowedValues {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let whole = if self.is_whole { "a whole number " } else { "" };
        let unit = self.unit.map_or_else(String::new, |unit| format!(" {}", unit.symbol()));
        write!(formatter, "{whole}from {} to {}{unit}", self.min, self.max)
    }
}
