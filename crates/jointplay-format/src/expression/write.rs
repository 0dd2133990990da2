//! From an expression to text.

use jointplay_core::expression::{BinaryOperator, Expression, Operation};

use super::functions::function_name;

/// Rank of an expression: an operand of lower rank needs parentheses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Rank {
    Sum,
    Product,
    Signed,
    Power,
    Atom,
}

/// The text of an expression, in parentheses if its rank is below `least`.
///
/// # Arguments
/// * `name` – the text of a variable
pub(crate) fn text<N>(
    expression: &Expression<N>,
    least: Rank,
    name: impl Fn(&N) -> String,
) -> String {
    const COMPLETE: &str = "each operator has its operands";
    let mut stack: Vec<(String, Rank)> = Vec::new();
    for operation in expression.operations() {
        let written = match operation {
            // A negative number is a sign and a number.
            Operation::Constant(value) => {
                let rank = if value.is_sign_negative() { Rank::Signed } else { Rank::Atom };
                (value.to_string(), rank)
            }
            Operation::Variable(variable) => (name(variable), Rank::Atom),
            Operation::Negate => {
                let operand = stack.pop().expect(COMPLETE);
                (format!("-{}", bracketed(operand, Rank::Signed)), Rank::Signed)
            }
            Operation::Binary(operator) => {
                let (right, left) = (stack.pop().expect(COMPLETE), stack.pop().expect(COMPLETE));
                let (sign, rank, ranks) = match operator {
                    BinaryOperator::Add => ('+', Rank::Sum, [Rank::Sum, Rank::Product]),
                    BinaryOperator::Subtract => ('-', Rank::Sum, [Rank::Sum, Rank::Product]),
                    BinaryOperator::Multiply => ('*', Rank::Product, [Rank::Product, Rank::Signed]),
                    BinaryOperator::Divide => ('/', Rank::Product, [Rank::Product, Rank::Signed]),
                    BinaryOperator::Power => ('^', Rank::Power, [Rank::Atom, Rank::Signed]),
                };
                let (left, right) = (bracketed(left, ranks[0]), bracketed(right, ranks[1]));
                (format!("{left} {sign} {right}"), rank)
            }
            Operation::Call { function, arguments } => {
                let arguments = stack.split_off(stack.len() - arguments);
                let arguments: Vec<String> = arguments.into_iter().map(|(text, _)| text).collect();
                (format!("{}({})", function_name(*function), arguments.join(", ")), Rank::Atom)
            }
        };
        stack.push(written);
    }
    bracketed(stack.pop().expect(COMPLETE), least)
}

fn bracketed((text, rank): (String, Rank), least: Rank) -> String {
    if rank < least { format!("({text})") } else { text }
}
