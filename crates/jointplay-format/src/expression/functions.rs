//! Names of functions, and the unit of their angles.

use jointplay_core::expression::Function;

/// The unit of angles in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleUnit {
    /// Degrees.
    Degree,
    /// Radians.
    Radian,
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

/// A function with its name.
struct NamedFunction {
    name: &'static str,
    /// The function where angles are in radians.
    radians: Function,
    /// The function where angles are in degrees.
    degrees: Function,
}

/// A function without angles.
const fn plain(name: &'static str, function: Function) -> NamedFunction {
    NamedFunction { name, radians: function, degrees: function }
}

/// A function of an angle, or one whose value is an angle.
const fn angular(name: &'static str, radians: Function, degrees: Function) -> NamedFunction {
    NamedFunction { name, radians, degrees }
}

const FUNCTIONS: [NamedFunction; 16] = [
    angular("sin", Function::Sin, Function::SinDegrees),
    angular("cos", Function::Cos, Function::CosDegrees),
    angular("tan", Function::Tan, Function::TanDegrees),
    angular("asin", Function::Asin, Function::AsinDegrees),
    angular("acos", Function::Acos, Function::AcosDegrees),
    angular("atan", Function::Atan, Function::AtanDegrees),
    angular("atan2", Function::Atan2, Function::Atan2Degrees),
    plain("sqrt", Function::Sqrt),
    plain("abs", Function::Abs),
    plain("min", Function::Min),
    plain("max", Function::Max),
    plain("hypot", Function::Hypot),
    plain("floor", Function::Floor),
    plain("ceil", Function::Ceil),
    plain("round", Function::Round),
    plain("mod", Function::Mod),
];

/// The function with a name.
pub(super) fn function(name: &str, angle: AngleUnit) -> Option<Function> {
    let found = FUNCTIONS.iter().find(|function| function.name == name)?;
    Some(match angle {
        AngleUnit::Degree => found.degrees,
        AngleUnit::Radian => found.radians,
    })
}

/// Names of all functions.
pub(super) fn function_names() -> impl Iterator<Item = &'static str> + Clone {
    FUNCTIONS.iter().map(|function| function.name)
}

/// Name of a function.
pub(crate) fn function_name(function: Function) -> &'static str {
    let is_it = |one: &&NamedFunction| one.radians == function || one.degrees == function;
    FUNCTIONS.iter().find(is_it).map_or("", |one| one.name)
}

/// The number of arguments of a function, in words.
pub(super) fn argument_count(function: Function) -> &'static str {
    match (*function.arity().start(), *function.arity().end()) {
        (1, 1) => "1 argument",
        (2, 2) => "2 arguments",
        _ => "1 argument or more",
    }
}
