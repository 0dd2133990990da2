//! Values of commands: `hy * tan(1)`, `2.5 mm`.

use jointplay_core::mechanism::joint::Coordinate;

use super::names::Names;
use super::problem::Error;
use crate::expression::{AngleUnit, ExpressionProblem, Formula};
use crate::mechanism::{LengthUnit, Units};
use crate::units::shift;

/// A value of a command: an expression of the parameters of a file, in the units of the file or in the unit that follows it.
///
/// # Example
/// ```
/// use jointplay_core::mechanism::joint::Coordinate;
/// use jointplay_format::command::{CommandValue, Names};
/// use jointplay_format::mechanism::parse;
///
/// let file = parse(jointplay_format::catalogue::find("four-bar").unwrap().text).unwrap();
/// let names = Names::of(&file).with_variable("t").unwrap();
/// let curve = CommandValue::parse("30 * cos(t)", &names).unwrap();
/// let angle = curve.evaluate(Coordinate::Turn, &names, 60.0).unwrap();
/// assert!((angle - 15_f64.to_radians()).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CommandValue {
    text: String,
    formula: Formula,
    unit: Option<Unit>,
}

/// Unit after an expression, or in the heading of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Unit {
    Length(LengthUnit),
    /// A thousandth of an inch.
    Mil,
    Angle(AngleUnit),
    Milliradian,
    Microradian,
}

impl Unit {
    /// Units that are not units of files.
    const OTHERS: [Self; 3] = [Self::Mil, Self::Milliradian, Self::Microradian];

    pub(super) fn find(name: &str) -> Option<Self> {
        let length = LengthUnit::ALL.into_iter().find(|(known, _)| *known == name);
        let angle = || AngleUnit::ALL.into_iter().find(|(known, _)| *known == name);
        let other = || Self::OTHERS.into_iter().find(|unit| unit.name() == name);
        length
            .map(|(_, unit)| Self::Length(unit))
            .or_else(|| angle().map(|(_, unit)| Self::Angle(unit)))
            .or_else(other)
    }

    fn name(self) -> &'static str {
        match self {
            Self::Length(unit) => unit.name(),
            Self::Mil => "mil",
            Self::Angle(unit) => unit.name(),
            Self::Milliradian => "mrad",
            Self::Microradian => "urad",
        }
    }

    /// The unit of a quantity in a file.
    pub(super) fn of(quantity: Coordinate, units: Units) -> Self {
        match quantity {
            Coordinate::Slide => Self::Length(units.length),
            Coordinate::Turn => Self::Angle(units.angle),
        }
    }

    /// Whether it is a unit of the quantity.
    pub(super) fn measures(self, quantity: Coordinate) -> bool {
        match self {
            Self::Length(_) | Self::Mil => quantity == Coordinate::Slide,
            Self::Angle(_) | Self::Milliradian | Self::Microradian => quantity == Coordinate::Turn,
        }
    }

    /// A value in SI units (m or rad).
    pub(super) fn to_si(self, value: f64) -> f64 {
        match self {
            Self::Length(unit) => unit.to_meters(value),
            Self::Mil => shift(LengthUnit::Inch.to_meters(value), -3),
            Self::Angle(unit) => unit.to_radians(value),
            Self::Milliradian => shift(value, -3),
            Self::Microradian => shift(value, -6),
        }
    }
}

/// The expression of a text, and the unit after it: a name of a unit where an operator or the end is expected.
fn split_unit(text: &str) -> (&str, Option<Unit>) {
    let trimmed = text.trim_end();
    let start = trimmed
        .rfind(|c: char| !c.is_ascii_alphabetic())
        .map_or(0, |at| at + trimmed[at..].chars().next().map_or(0, char::len_utf8));
    let Some(unit) = Unit::find(&trimmed[start..]) else { return (text, None) };
    let before = trimmed[..start].trim_end();
    // With the unit, a name such as `w2mm` would be cut; an expression that is complete without it cannot continue with a name.
    let adjacent = before.len() == start;
    let ends_name = Formula::parse(trimmed, AngleUnit::Degree).is_ok();
    let complete = Formula::parse(before, AngleUnit::Degree).is_ok();
    if complete && !(adjacent && ends_name) { (before, Some(unit)) } else { (text, None) }
}

impl CommandValue {
    /// Parses a value; all its names have to be known.
    ///
    /// # Errors
    /// [`Error::Expression`].
    pub fn parse(text: &str, names: &Names<'_>) -> Result<Self, Error> {
        let text = text.trim();
        let (expression, unit) = split_unit(text);
        let invalid = |error| Error::Expression { text: text.to_owned(), error };
        let formula = Formula::parse(expression, names.units().angle).map_err(invalid)?;
        let known = |name: &str| names.value(name, 0.0).or(Some(1.0).filter(|_| name == "pi"));
        if let Some(unknown) = formula.variables().find(|one| known(one.name).is_none()) {
            let name = unknown.name.to_owned();
            let span = unknown.span.clone();
            let problem = ExpressionProblem::UnknownName { name, nearest: None, known: Vec::new() };
            let error = crate::expression::ExpressionError { span, problem };
            return Err(invalid(error.among(names.all())));
        }
        Ok(Self { text: text.to_owned(), formula, unit })
    }

    /// The text that was parsed.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether a name occurs in it.
    #[must_use]
    pub fn uses(&self, name: &str) -> bool {
        self.formula.names().any(|known| known == name)
    }

    /// Whether it depends on the variable of `names`.
    #[must_use]
    pub fn varies(&self, names: &Names<'_>) -> bool {
        names.variable().is_some_and(|variable| self.uses(variable))
    }

    /// Its value in SI units (m or rad).
    ///
    /// # Arguments
    /// * `quantity` – length or angle
    /// * `at` – value of the variable
    ///
    /// # Errors
    /// [`Error::Expression`] for a value that is not finite, [`Error::OtherQuantity`].
    pub fn evaluate(&self, quantity: Coordinate, names: &Names<'_>, at: f64) -> Result<f64, Error> {
        let value = self.number(names, at)?;
        let unit = self.unit.unwrap_or_else(|| Unit::of(quantity, names.units()));
        if unit.measures(quantity) {
            return Ok(unit.to_si(value));
        }
        let (needed, other) = match quantity {
            Coordinate::Slide => ("a length", "angles"),
            Coordinate::Turn => ("an angle", "lengths"),
        };
        Err(Error::OtherQuantity { text: self.text.clone(), unit: unit.name(), needed, other })
    }

    /// Its value without regard to units.
    ///
    /// # Errors
    /// [`Error::Expression`] for a value that is not finite.
    pub fn number(&self, names: &Names<'_>, at: f64) -> Result<f64, Error> {
        let value = self.formula.evaluate_with(&|name| names.value(name, at));
        value.map_err(|error| Error::Expression { text: self.text.clone(), error })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{MechanismFile, parse};

    fn file() -> MechanismFile {
        let text = crate::catalogue::find("four-bar").unwrap().text;
        let mut file = parse(text).unwrap();
        file.parameters =
            vec![("w".to_owned(), 40.0), ("w2mm".to_owned(), 7.0), ("m".to_owned(), 3.0)];
        file
    }

    fn value(text: &str, quantity: Coordinate) -> Result<f64, Error> {
        let file = file();
        let names = Names::of(&file).with_variable("t")?;
        CommandValue::parse(text, &names)?.evaluate(quantity, &names, 60.0)
    }

    #[track_caller]
    fn check(text: &str, quantity: Coordinate, expected: f64) {
        let found = value(text, quantity).unwrap();
        assert!((found - expected).abs() <= 1e-15 * expected.abs(), "{text}: {found}");
    }

    #[test]
    fn a_unit_follows_an_expression_and_outranks_that_of_the_file() {
        let length = file().units.length.to_meters(1.0);
        check("w / 2 * cos(t)", Coordinate::Slide, 10.0 * length);
        check("2.5 mm", Coordinate::Slide, 2.5e-3);
        check("2.5mm", Coordinate::Slide, 2.5e-3);
        check("(1 + 1) in", Coordinate::Slide, 0.0508);
        check("w um", Coordinate::Slide, 40e-6);
        check("1/2 mil", Coordinate::Slide, 12.7e-6);
        check("3 mrad", Coordinate::Turn, 3e-3);
        check("250urad", Coordinate::Turn, 250e-6);
        check("0.5 rad", Coordinate::Turn, 0.5);
        check("t deg", Coordinate::Turn, 60_f64.to_radians());
        // Names of the file that look like units are names, where an expression needs one.
        check("w2mm", Coordinate::Slide, 7.0 * length);
        check("2 * m", Coordinate::Slide, 6.0 * length);
        check("m", Coordinate::Slide, 3.0 * length);
        check("m m", Coordinate::Slide, 3.0);
    }

    #[track_caller]
    fn refuse(text: &str, quantity: Coordinate, message: &str) {
        let error = value(text, quantity).unwrap_err().to_string();
        assert!(error.contains(message), "{text}: {error}");
    }

    #[test]
    fn values_without_a_finite_number_or_with_the_unit_of_another_quantity_are_refused() {
        refuse("1 / (t - 60)", Coordinate::Slide, "the expression gives a value that is infinite");
        refuse("ww * 2", Coordinate::Slide, "unknown name `ww` (did you mean `w`?)");
        refuse("1 deg", Coordinate::Slide, "the value is a length, but deg is a unit of angles");
        refuse("1 mil", Coordinate::Turn, "mil is a unit of lengths");
        refuse("1 mm", Coordinate::Turn, "the value is an angle, but mm is a unit of lengths");
        refuse("", Coordinate::Turn, "expected a number");
        refuse("mm", Coordinate::Turn, "unknown name `mm`");
        refuse("3 km", Coordinate::Turn, "expected an operator or the end");
        let file = file();
        let error = Names::of(&file).with_variable("w").unwrap_err().to_string();
        assert!(error.contains("`w` is a parameter of the file"), "{error}");
        assert!(Names::of(&file).with_variable("2t").is_err());
    }
}
