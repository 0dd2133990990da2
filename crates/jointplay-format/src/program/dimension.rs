//! Units of expressions, by those of the parameters in them.

use std::collections::BTreeMap;

use jointplay_cell::program::{Name, Number, Program, ProgramVisitor, Unit};
use jointplay_core::expression::{BinaryOperator, Expression, Function, Operation};

use super::lexer::line_at;
use super::problem::{Error, Problem};
use crate::place::Place;

/// Exponents of millimetres, degrees and seconds; percent are plain numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Dimension([i32; 3]);

const ANGLE: Dimension = Dimension([0, 1, 0]);

impl From<Unit> for Dimension {
    fn from(unit: Unit) -> Self {
        match unit {
            Unit::Millimeter => Self([1, 0, 0]),
            Unit::Degree => ANGLE,
            Unit::Second => Self([0, 0, 1]),
            Unit::Percent => Self::default(),
        }
    }
}

impl Dimension {
    fn is_number(self) -> bool {
        self == Self::default()
    }

    fn combined(self, other: Self, combine: fn(i32, i32) -> i32) -> Self {
        Self(std::array::from_fn(|k| combine(self.0[k], other.0[k])))
    }

    /// The unit of both; plain numbers are in that of the other.
    fn common(self, other: Self) -> Result<Self, Problem> {
        if self == other || other.is_number() {
            return Ok(self);
        }
        if self.is_number() {
            return Ok(other);
        }
        Err(Problem::Units { left: self.name(), right: other.name() })
    }

    /// Its name, as `mm^2 / s`.
    fn name(self) -> String {
        let part = |sign: i32| {
            let symbols = self.0.iter().zip(["mm", "deg", "s"]);
            let parts = symbols.filter(|(exponent, _)| *exponent * sign > 0);
            let part = |(exponent, symbol): (&i32, &str)| match exponent * sign {
                1 => symbol.to_owned(),
                exponent => format!("{symbol}^{exponent}"),
            };
            parts.map(part).collect::<Vec<_>>().join(" ")
        };
        match (part(1), part(-1)) {
            (over, under) if under.is_empty() => over,
            (over, under) if over.is_empty() => format!("1 / {under}"),
            (over, under) => format!("{over} / {under}"),
        }
    }
}

/// Errors of expressions whose parameters have other units than the text requires.
pub(super) fn unit_errors(text: &str, program: &Program) -> Vec<Error> {
    let units = program.parameters.iter().map(|parameter| {
        let unit = parameter.unit.map_or_else(Dimension::default, Dimension::from);
        (parameter.name.text.as_str(), unit)
    });
    let mut check = UnitCheck { text, units: units.collect(), errors: Vec::new() };
    for parameter in &program.parameters {
        check.number(&parameter.value, parameter.unit);
    }
    check.block(&program.body);
    program.routines.iter().for_each(|routine| check.block(&routine.body));
    check.errors.sort_by_key(|error| (error.place.line, error.place.column));
    check.errors
}

struct UnitCheck<'p> {
    text: &'p str,
    units: BTreeMap<&'p str, Dimension>,
    errors: Vec<Error>,
}

impl ProgramVisitor for UnitCheck<'_> {
    /// Checks that a number is in a unit.
    fn number(&mut self, number: &Number, unit: Option<Unit>) {
        let needed = unit.map_or_else(Dimension::default, Dimension::from);
        let found = self.dimension(&number.expression).and_then(|found| {
            if found == needed || found.is_number() {
                return Ok(found);
            }
            let allowed = match unit {
                Some(unit) => format!("in {}", unit.symbol()),
                None => "a number without unit".to_owned(),
            };
            Err(Problem::ExpressionUnit { found: found.name(), allowed })
        });
        self.report(number, found);
    }

    fn comparison(&mut self, left: &Number, right: &Number, unit: Option<Unit>) {
        let both = self.dimension(&left.expression).and_then(|dimension| {
            let both = dimension.common(self.dimension(&right.expression)?)?;
            unit.map_or(Ok(both), |unit| both.common(unit.into()))
        });
        self.report(left, both);
    }

    // Their units are those of the parameters of the routine, which have none.
    fn arguments(&mut self, _routine: &Name, _arguments: &[Number]) {}
}

impl UnitCheck<'_> {
    fn report(&mut self, number: &Number, found: Result<Dimension, Problem>) {
        let Err(problem) = found else { return };
        let (line, column) = (number.place.line, number.place.column);
        let tokens = line_at(self.text, line);
        let text = tokens.as_ref().map_or_else(String::new, |line| line.text.to_owned());
        let token = tokens.and_then(|line| line.tokens.into_iter().find(|it| it.column == column));
        let width = token.map_or(0, |token| token.width());
        let place = Place { line, column, width, text };
        self.errors.push(Error { place, problem: Box::new(problem) });
    }

    /// Dimension of an expression.
    fn dimension(&self, expression: &Expression<Name>) -> Result<Dimension, Problem> {
        const COMPLETE: &str = "each operator has its operands";
        // A constant keeps its value, for powers.
        let mut stack: Vec<(Dimension, Option<f64>)> = Vec::new();
        for operation in expression.operations() {
            let operands = stack.split_off(stack.len() - operation.operands());
            let result = match operation {
                Operation::Constant(value) => (Dimension::default(), Some(*value)),
                Operation::Variable(name) => {
                    (self.units.get(name.text.as_str()).copied().unwrap_or_default(), None)
                }
                Operation::Negate => (operands[0].0, None),
                Operation::Binary(operator) => {
                    let [(left, _), (right, exponent)] = operands[..] else {
                        unreachable!("{COMPLETE}")
                    };
                    (binary(*operator, left, right, exponent)?, None)
                }
                Operation::Call { function, .. } => {
                    let arguments: Vec<Dimension> = operands.iter().map(|it| it.0).collect();
                    (call(*function, &arguments)?, None)
                }
            };
            stack.push(result);
        }
        Ok(stack.pop().expect(COMPLETE).0)
    }
}

fn binary(
    operator: BinaryOperator,
    left: Dimension,
    right: Dimension,
    exponent: Option<f64>,
) -> Result<Dimension, Problem> {
    match operator {
        BinaryOperator::Add | BinaryOperator::Subtract => left.common(right),
        BinaryOperator::Multiply => Ok(left.combined(right, i32::saturating_add)),
        BinaryOperator::Divide => Ok(left.combined(right, i32::saturating_sub)),
        BinaryOperator::Power if left.is_number() => plain(right).map(|_| left),
        BinaryOperator::Power => {
            let whole = (-9..=9).find(|whole| exponent == Some(f64::from(*whole)));
            let whole = whole.ok_or_else(|| Problem::Units {
                left: left.name(),
                right: "this exponent".to_owned(),
            })?;
            Ok(Dimension(left.0.map(|exponent| exponent.saturating_mul(whole))))
        }
    }
}

fn call(function: Function, arguments: &[Dimension]) -> Result<Dimension, Problem> {
    let first = arguments[0];
    let common =
        || arguments.iter().try_fold(Dimension::default(), |one, other| one.common(*other));
    match function {
        Function::Sin
        | Function::Cos
        | Function::Tan
        | Function::SinDegrees
        | Function::CosDegrees
        | Function::TanDegrees => first.common(ANGLE).map(|_| Dimension::default()),
        Function::Asin
        | Function::Acos
        | Function::Atan
        | Function::AsinDegrees
        | Function::AcosDegrees
        | Function::AtanDegrees => plain(first).map(|_| ANGLE),
        Function::Atan2 | Function::Atan2Degrees => common().map(|_| ANGLE),
        Function::Sqrt if first.0.iter().all(|exponent| exponent % 2 == 0) => {
            Ok(Dimension(first.0.map(|exponent| exponent / 2)))
        }
        Function::Sqrt => {
            Err(Problem::Units { left: first.name(), right: "a square root".to_owned() })
        }
        Function::Min | Function::Max | Function::Hypot | Function::Mod => common(),
        Function::Abs | Function::Floor | Function::Ceil | Function::Round => Ok(first),
    }
}

/// A number without unit.
fn plain(dimension: Dimension) -> Result<Dimension, Problem> {
    if dimension.is_number() {
        return Ok(dimension);
    }
    let allowed = "a number without unit".to_owned();
    Err(Problem::ExpressionUnit { found: dimension.name(), allowed })
}
