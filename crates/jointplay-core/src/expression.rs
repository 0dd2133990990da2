//! Arithmetic expressions of named numbers, as in mechanism files and programs.
//!
//! The text of an expression is parsed and written by `jointplay-format`.

use std::ops::RangeInclusive;

/// An arithmetic expression; `N` identifies a variable.
///
/// Its operations are in postfix order and evaluated with a stack, so that long expressions need no recursion.
///
/// # Example
/// ```
/// use jointplay_core::expression::{BinaryOperator, Expression, Operation};
///
/// // 2 * n
/// let postfix = vec![
///     Operation::Constant(2.0),
///     Operation::Variable("n"),
///     Operation::Binary(BinaryOperator::Multiply),
/// ];
/// let double = Expression::from_postfix(postfix).expect("each operator has its operands");
/// assert_eq!(double.evaluate(|_| Ok::<_, ()>(7.0)), Ok(14.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Expression<N> {
    operations: Vec<Operation<N>>,
}

/// Operation of an expression: it replaces its operands on the stack by its value.
#[derive(Debug, Clone, PartialEq)]
pub enum Operation<N> {
    /// A number.
    Constant(f64),
    /// The value of a variable.
    Variable(N),
    /// The negative of the operand.
    Negate,
    /// Two operands, the left one below.
    Binary(BinaryOperator),
    /// A function.
    Call {
        /// The function.
        function: Function,
        /// Number of arguments, the first one lowest.
        arguments: usize,
    },
}

/// Operator between two operands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BinaryOperator {
    /// Sum.
    Add,
    /// Difference.
    Subtract,
    /// Product.
    Multiply,
    /// Quotient.
    Divide,
    /// Power.
    Power,
}

/// Function of an expression; functions of angles exist for radians and for degrees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// Sine of radians.
    Sin,
    /// Cosine of radians.
    Cos,
    /// Tangent of radians.
    Tan,
    /// Inverse sine in radians.
    Asin,
    /// Inverse cosine in radians.
    Acos,
    /// Inverse tangent in radians.
    Atan,
    /// Angle of the point (x, y) in radians; the arguments are y and x.
    Atan2,
    /// Sine of degrees, exact at right angles.
    SinDegrees,
    /// Cosine of degrees, exact at right angles.
    CosDegrees,
    /// Tangent of degrees, exact at multiples of 180°.
    TanDegrees,
    /// Inverse sine in degrees.
    AsinDegrees,
    /// Inverse cosine in degrees.
    AcosDegrees,
    /// Inverse tangent in degrees.
    AtanDegrees,
    /// Angle of the point (x, y) in degrees; the arguments are y and x.
    Atan2Degrees,
    /// Square root.
    Sqrt,
    /// Absolute value.
    Abs,
    /// Least argument.
    Min,
    /// Largest argument.
    Max,
    /// Length of the hypotenuse.
    Hypot,
    /// Largest whole number that is not above the argument.
    Floor,
    /// Least whole number that is not below the argument.
    Ceil,
    /// Nearest whole number; halves are rounded away from 0.
    Round,
    /// Remainder of the first argument divided by the second, at least 0 and below the magnitude of the second.
    Mod,
}

impl<N> Expression<N> {
    /// A number.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Self { operations: vec![Operation::Constant(value)] }
    }

    /// A variable.
    #[must_use]
    pub fn variable(variable: N) -> Self {
        Self { operations: vec![Operation::Variable(variable)] }
    }

    /// An expression from its operations in postfix order; `None` where an operation has not its operands, or where more than one value remains.
    #[must_use]
    pub fn from_postfix(operations: Vec<Operation<N>>) -> Option<Self> {
        let mut depth = 0_usize;
        for operation in &operations {
            let operands = operation.operands();
            if let Operation::Call { function, arguments } = operation
                && !function.arity().contains(arguments)
            {
                return None;
            }
            depth = depth.checked_sub(operands)? + 1;
        }
        (depth == 1).then_some(Self { operations })
    }

    /// The operations in postfix order.
    #[must_use]
    pub fn operations(&self) -> &[Operation<N>] {
        &self.operations
    }

    /// The number, where the expression is nothing else.
    #[must_use]
    pub fn as_constant(&self) -> Option<f64> {
        match self.operations[..] {
            [Operation::Constant(value)] => Some(value),
            _ => None,
        }
    }

    /// The variable, where the expression is nothing else.
    #[must_use]
    pub fn as_variable(&self) -> Option<&N> {
        match &self.operations[..] {
            [Operation::Variable(variable)] => Some(variable),
            _ => None,
        }
    }

    /// The variables in the order of the operations, each as often as it occurs.
    pub fn variables(&self) -> impl Iterator<Item = &N> {
        self.operations.iter().filter_map(|operation| match operation {
            Operation::Variable(variable) => Some(variable),
            _ => None,
        })
    }

    /// The expression with other identifiers of its variables.
    ///
    /// # Errors
    /// The first error of `map`.
    pub fn try_map<M, E>(
        &self,
        mut map: impl FnMut(&N) -> Result<M, E>,
    ) -> Result<Expression<M>, E> {
        let mapped = |operation: &Operation<N>| {
            Ok(match operation {
                Operation::Constant(value) => Operation::Constant(*value),
                Operation::Variable(variable) => Operation::Variable(map(variable)?),
                Operation::Negate => Operation::Negate,
                Operation::Binary(operator) => Operation::Binary(*operator),
                &Operation::Call { function, arguments } => Operation::Call { function, arguments },
            })
        };
        let operations = self.operations.iter().map(mapped).collect::<Result<_, E>>()?;
        Ok(Expression { operations })
    }

    /// Its value; infinite or NaN where an operation is not defined or overflows.
    ///
    /// # Errors
    /// The first error of `value_of`, the value of a variable.
    pub fn evaluate<E>(&self, mut value_of: impl FnMut(&N) -> Result<f64, E>) -> Result<f64, E> {
        let mut stack: Vec<f64> = Vec::with_capacity(self.operations.len());
        for operation in &self.operations {
            let operands = stack.len() - operation.operands();
            let value = {
                let operands = &stack[operands..];
                match operation {
                    Operation::Constant(value) => *value,
                    Operation::Variable(variable) => value_of(variable)?,
                    Operation::Negate => -operands[0],
                    Operation::Binary(operator) => operator.value(operands[0], operands[1]),
                    Operation::Call { function, .. } => function.value(operands),
                }
            };
            stack.truncate(operands);
            stack.push(value);
        }
        // An expression leaves one value.
        Ok(stack[0])
    }
}

impl<N> Operation<N> {
    /// Number of operands.
    #[must_use]
    pub fn operands(&self) -> usize {
        match self {
            Self::Constant(_) | Self::Variable(_) => 0,
            Self::Negate => 1,
            Self::Binary(_) => 2,
            Self::Call { arguments, .. } => *arguments,
        }
    }
}

impl BinaryOperator {
    fn value(self, left: f64, right: f64) -> f64 {
        match self {
            Self::Add => left + right,
            Self::Subtract => left - right,
            Self::Multiply => left * right,
            Self::Divide => left / right,
            Self::Power => left.powf(right),
        }
    }
}

impl Function {
    /// Allowed numbers of arguments.
    #[must_use]
    pub fn arity(self) -> RangeInclusive<usize> {
        match self {
            Self::Atan2 | Self::Atan2Degrees | Self::Hypot | Self::Mod => 2..=2,
            Self::Min | Self::Max => 1..=usize::MAX,
            _ => 1..=1,
        }
    }

    fn value(self, arguments: &[f64]) -> f64 {
        let x = arguments[0];
        match self {
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => {
                let (sine, cosine) = x.sin_cos();
                sine / cosine
            }
            Self::Asin => x.asin(),
            Self::Acos => x.acos(),
            Self::Atan => x.atan(),
            Self::Atan2 => x.atan2(arguments[1]),
            Self::SinDegrees => sin_cos_degrees(x).0,
            Self::CosDegrees => sin_cos_degrees(x).1,
            Self::TanDegrees => {
                let (sine, cosine) = sin_cos_degrees(x);
                sine / cosine
            }
            Self::AsinDegrees => x.asin().to_degrees(),
            Self::AcosDegrees => x.acos().to_degrees(),
            Self::AtanDegrees => x.atan().to_degrees(),
            Self::Atan2Degrees => x.atan2(arguments[1]).to_degrees(),
            Self::Sqrt => x.sqrt(),
            Self::Abs => x.abs(),
            // Unlike `f64::min`, the result is NaN if an argument is.
            Self::Min => arguments.iter().copied().reduce(least).unwrap_or(x),
            Self::Max => -arguments.iter().map(|x| -x).reduce(least).unwrap_or(-x),
            Self::Hypot => x.hypot(arguments[1]),
            Self::Floor => x.floor(),
            Self::Ceil => x.ceil(),
            Self::Round => x.round(),
            Self::Mod => x.rem_euclid(arguments[1]),
        }
    }
}

fn least(a: f64, b: f64) -> f64 {
    if a.is_nan() || a < b { a } else { b }
}

/// Sine and cosine, exact at every right angle: the cosine of 90° is 0 and not 6e-17.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let within = degrees % 360.0;
    let quarter = (within / 90.0).round();
    let (sine, cosine) = (within - 90.0 * quarter).to_radians().sin_cos();
    // `as` turns NaN into 0; sine and cosine are NaN then, and stay so.
    match (quarter as i64).rem_euclid(4) {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn call(function: Function, arguments: &[f64]) -> f64 {
        let constants = arguments.iter().map(|value| Operation::Constant(*value));
        let call = Operation::Call { function, arguments: arguments.len() };
        let postfix: Vec<Operation<()>> = constants.chain([call]).collect();
        let expression = Expression::from_postfix(postfix).expect("has its arguments");
        expression.evaluate(|()| Err(())).expect("has no variables")
    }

    #[test]
    fn incomplete_operations_are_no_expression() {
        use Operation::{Binary, Call, Constant, Negate, Variable};
        let add = || Binary(BinaryOperator::Add);
        let refused: [Vec<Operation<u8>>; 6] = [
            vec![],
            vec![Negate],
            vec![Constant(1.0), add()],
            vec![Constant(1.0), Variable(0)],
            vec![add(), Constant(1.0), Constant(1.0)],
            vec![Constant(1.0), Call { function: Function::Hypot, arguments: 1 }],
        ];
        for operations in refused {
            assert_eq!(Expression::from_postfix(operations), None);
        }
    }

    #[test]
    fn functions_of_degrees_are_exact_at_right_angles_and_agree_with_radians() {
        assert_eq!(call(Function::CosDegrees, &[90.0]), 0.0);
        assert_eq!(call(Function::SinDegrees, &[-90.0]), -1.0);
        assert_eq!(call(Function::TanDegrees, &[720.0]), 0.0);
        for step in -80..80 {
            let degrees = f64::from(step) * 11.3;
            let (sine, cosine) = sin_cos_degrees(degrees);
            assert!((sine - degrees.to_radians().sin()).abs() < 1e-14);
            assert!((cosine - degrees.to_radians().cos()).abs() < 1e-14);
        }
    }

    #[test]
    fn rounding_and_remainders_are_whole_for_whole_arguments() {
        assert_eq!(call(Function::Floor, &[-0.5]), -1.0);
        assert_eq!(call(Function::Ceil, &[0.2]), 1.0);
        assert_eq!(call(Function::Round, &[2.5]), 3.0);
        assert_eq!(call(Function::Mod, &[7.0, 3.0]), 1.0);
        assert_eq!(call(Function::Mod, &[-7.0, 3.0]), 2.0);
        assert!(call(Function::Mod, &[7.0, 0.0]).is_nan());
        assert!(call(Function::Min, &[f64::NAN, 1.0]).is_nan());
    }
}
