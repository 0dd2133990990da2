//! Expressions in the text of a value: `"a * cos(alpha) / 2"`.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use jointplay_core::expression::Expression;

use super::functions::AngleUnit;
use super::parser::{Parser, VariableName};
use super::problem::{ExpressionError, ExpressionProblem};
use super::token::tokens;

/// Values of names.
#[derive(Debug, Clone)]
pub(crate) struct Scope {
    pub(crate) values: BTreeMap<String, f64>,
    /// All parameters of the file, also those without a value.
    pub(crate) parameters: BTreeSet<String>,
}

/// An expression in the text of a value.
///
/// # Example
/// ```
/// use jointplay_format::expression::{AngleUnit, Formula};
///
/// let height = Formula::parse("10 * (slot - 1)", AngleUnit::Degree)?;
/// assert_eq!(height.evaluate_with(&|name| (name == "slot").then_some(3.0))?, 20.0);
/// # Ok::<(), jointplay_format::expression::ExpressionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    expression: Expression<VariableName>,
    /// Length of the text (bytes).
    length: usize,
}

/// A name in an expression.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable<'f> {
    /// The name.
    pub name: &'f str,
    /// Its bytes in the text of the expression.
    pub span: Range<usize>,
}

impl Formula {
    /// Parses a text, with the unit of the angles of its functions.
    ///
    /// # Errors
    /// [`ExpressionError`]
    pub fn parse(text: &str, angle: AngleUnit) -> Result<Self, ExpressionError> {
        let end = (text.trim_end().chars().count() + 1, text.trim_end().len());
        let expression = Parser::new(&tokens(text), end, angle).whole()?;
        Ok(Self { expression, length: text.len() })
    }

    /// The names in it, also `pi`, without functions.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.variables().map(|variable| variable.name)
    }

    /// The names in it with their places, also `pi`, without functions.
    pub fn variables(&self) -> impl Iterator<Item = Variable<'_>> {
        let variables = self.expression.variables();
        variables.map(|one| Variable { name: &one.text, span: one.span.clone() })
    }

    /// Its value: a finite number. [`ExpressionError::among`] adds the known names to an error.
    pub(crate) fn evaluate(&self, scope: &Scope) -> Result<f64, ExpressionError> {
        self.evaluate_with(&|name| scope.values.get(name).copied())
    }

    /// Its value: a finite number.
    ///
    /// # Arguments
    /// * `value_of` – value of a name; `pi` is known without it
    ///
    /// # Errors
    /// [`ExpressionProblem::UnknownName`] and [`ExpressionProblem::NotFinite`]
    pub fn evaluate_with(
        &self,
        value_of: &dyn Fn(&str) -> Option<f64>,
    ) -> Result<f64, ExpressionError> {
        let value_of = |variable: &VariableName| match value_of(&variable.text) {
            Some(value) => Ok(value),
            None if variable.text == "pi" => Ok(std::f64::consts::PI),
            None => {
                let name = variable.text.clone();
                let problem =
                    ExpressionProblem::UnknownName { name, nearest: None, known: Vec::new() };
                Err(ExpressionError { span: variable.span.clone(), problem })
            }
        };
        let value = self.expression.evaluate(value_of)?;
        if value.is_finite() {
            Ok(value)
        } else {
            let problem = ExpressionProblem::NotFinite { value };
            Err(ExpressionError { span: 0..self.length, problem })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use proptest::prelude::*;

    fn value(text: &str, angle: AngleUnit) -> Result<f64, ExpressionError> {
        let values = [("a".to_owned(), 0.22), ("alpha".to_owned(), 90.0), ("ψ".to_owned(), 7.0)];
        let scope = Scope { values: values.into(), parameters: BTreeSet::new() };
        let names = scope.values.keys().map(String::as_str);
        Formula::parse(text, angle)?.evaluate(&scope).map_err(|error| error.among(names))
    }

    #[track_caller]
    fn check(text: &str, expected: f64) {
        let found = value(text, AngleUnit::Degree).unwrap();
        assert!((found - expected).abs() < 1e-14, "{text}: {found}");
    }

    #[test]
    fn formulas_have_their_usual_value() {
        check("1 + 2 * 3", 7.0);
        check("(1 + 2) * 3", 9.0);
        check("8 / 4 / 2 - 1 - 1", -1.0);
        check("-2 ^ 2", -4.0);
        check("2 ^ 3 ^ 2", 512.0);
        check("2 ^ -1", 0.5);
        check("2 * -3", -6.0);
        check("--a", 0.22);
        check(" a/2 ", 0.11);
        check("ψ", 7.0);
        check("1.5e-1 + .5 + 2. + 1E2", 102.65);
        check("pi", std::f64::consts::PI);
        check("sqrt(2)^2 + abs(-3) + min(3, 1, 2) + max(1, 5) + hypot(3, 4)", 16.0);
        check("floor(2.7) + ceil(2.2) + round(-0.4) + mod(-1, 4) * +2", 2.0 + 3.0 + 6.0);
        check("asin(1) + acos(-1) + atan(1) + atan2(-1, 0)", 90.0 + 180.0 + 45.0 - 90.0);
    }

    #[test]
    fn angles_are_in_the_unit_of_the_file() {
        assert_eq!(value("cos(alpha)", AngleUnit::Degree).unwrap(), 0.0);
        assert_eq!(value("sin(-alpha)", AngleUnit::Degree).unwrap(), -1.0);
        assert_eq!(value("sin(180) + cos(-270) + tan(720)", AngleUnit::Degree).unwrap(), 0.0);
        assert_eq!(value("cos(a)", AngleUnit::Radian).unwrap(), 0.22_f64.cos());
    }

    #[track_caller]
    fn refuse(text: &str, span: Range<usize>, message: &str) {
        let error = value(text, AngleUnit::Degree).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
        assert_eq!(error.span, span, "{text}");
    }

    #[test]
    fn bad_formulas_are_refused_with_their_place() {
        refuse("2 * alpa", 4..8, "unknown name `alpa` (did you mean `alpha`?); known here: a");
        refuse("sinn(3)", 0..4, "did you mean `sin`?");
        refuse("", 0..0, "column 1 of the expression: expected a number, a name");
        refuse("1 + * 2", 4..5, "column 5 of the expression");
        refuse("1 +", 3..3, "found the end");
        refuse("ψ 3", 3..4, "column 3 of the expression: expected an operator or the end");
        refuse("(1 + 2", 6..6, "expected an operator or `)`, found the end");
        refuse("2e", 1..2, "expected an operator");
        refuse("1.2.3", 3..5, "expected an operator or the end, found `.3`");
        refuse(".", 0..1, "a number");
        refuse("cos", 0..3, "`cos` is a function: write its arguments in parentheses");
        refuse("atan2(1)", 0..8, "`atan2` takes 2 arguments, but has 1");
        refuse("1 / 0", 0..5, "that is infinite");
        refuse("sqrt(-1)", 0..8, "that is not a number");
        refuse("tan(90)", 0..7, "finite");
        refuse("min(sqrt(-1), 1)", 0..16, "that is not a number");
    }

    #[test]
    fn nothing_overflows_the_stack() {
        for nest in ["(", "-", "2^", "sin(", "-("] {
            let text = nest.repeat(100_000);
            let error = value(&text, AngleUnit::Degree).unwrap_err();
            assert_eq!(error.problem, ExpressionProblem::TooDeep);
        }
        let long = format!("0{}", " + 1".repeat(100_000));
        assert_eq!(value(&long, AngleUnit::Degree).unwrap(), 100_000.0);
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "[-0-9a-c.e+*/^(), \u{e9}]{0,24}|\\PC{0,24}|((sin|min|pi|a)[(),^]?){0,6}") {
            if let Err(error) = value(&text, AngleUnit::Radian) {
                prop_assert!(text.get(error.span.clone()).is_some());
                let _ = error.to_string();
            }
        }
    }
}
