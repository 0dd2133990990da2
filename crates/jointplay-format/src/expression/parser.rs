//! From tokens to an expression.

use std::ops::Range;

use jointplay_core::expression::{BinaryOperator, Expression, Operation};

use super::functions::{AngleUnit, argument_count, function, function_name, function_names};
use super::problem::{ExpressionError, ExpressionProblem, MAX_DEPTH};
use super::token::{Token, TokenKind};
use crate::place::nearest;

/// A variable of an expression as written.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct VariableName {
    pub(crate) text: String,
    /// Column of its first character, counted from 1.
    pub(crate) column: usize,
    /// Its bytes.
    pub(crate) span: Range<usize>,
}

/// Parses expressions at the start of a sequence of tokens.
///
/// ```text
///    sum     = product { ("+" | "-") product }
///    product = signed { ("*" | "/") signed }
///    signed  = ("-" | "+") signed | power
///    power   = atom [ "^" signed ]
///    atom    = number | name | function "(" sum { "," sum } ")" | "(" sum ")"
/// ```
pub(crate) struct Parser<'t> {
    tokens: &'t [Token<'t>],
    at: usize,
    /// Column and byte of the end of the text.
    end: (usize, usize),
    angle: AngleUnit,
    depth: usize,
    operations: Vec<Operation<VariableName>>,
}

impl<'t> Parser<'t> {
    /// A parser of tokens.
    ///
    /// # Arguments
    /// * `end` – column and byte of the end of the text
    pub(crate) fn new(tokens: &'t [Token<'t>], end: (usize, usize), angle: AngleUnit) -> Self {
        Self { tokens, at: 0, end, angle, depth: 0, operations: Vec::new() }
    }

    /// A sum: the longest expression.
    pub(crate) fn sum(mut self) -> Result<Parsed, ExpressionError> {
        self.read_sum()?;
        self.parsed()
    }

    /// A sum that is the whole text.
    pub(super) fn whole(mut self) -> Result<Expression<VariableName>, ExpressionError> {
        self.read_sum()?;
        if self.peek().is_some() {
            return Err(self.syntax("an operator or the end"));
        }
        self.parsed().map(|parsed| parsed.expression)
    }

    /// A number, name, function or parenthesis with its signs and powers: an expression before a unit.
    pub(crate) fn signed(mut self) -> Result<Parsed, ExpressionError> {
        self.read_signed()?;
        self.parsed()
    }

    fn parsed(self) -> Result<Parsed, ExpressionError> {
        let tokens = self.at;
        let expression = Expression::from_postfix(self.operations);
        Ok(Parsed { expression: expression.expect("each operator has its operands"), tokens })
    }

    fn peek(&self) -> Option<&'t Token<'t>> {
        self.tokens.get(self.at)
    }

    fn is_next(&self, sign: &str) -> bool {
        self.peek().is_some_and(|token| token.kind == TokenKind::Sign && token.text == sign)
    }

    /// Passes this sign if it is next.
    fn accept(&mut self, sign: &str) -> bool {
        let found = self.is_next(sign);
        self.at += usize::from(found);
        found
    }

    fn syntax(&self, expected: &'static str) -> ExpressionError {
        let (column, span, found) = match self.peek() {
            Some(token) => {
                (token.column, token.span.clone(), format!("`{}`", token.text.escape_debug()))
            }
            None => (self.end.0, self.end.1..self.end.1, "the end".to_owned()),
        };
        ExpressionError { span, problem: ExpressionProblem::Syntax { column, expected, found } }
    }

    fn read_sum(&mut self) -> Result<(), ExpressionError> {
        const SUMS: [(&str, BinaryOperator); 2] =
            [("+", BinaryOperator::Add), ("-", BinaryOperator::Subtract)];
        self.chain(SUMS, Self::read_product)
    }

    fn read_product(&mut self) -> Result<(), ExpressionError> {
        const PRODUCTS: [(&str, BinaryOperator); 2] =
            [("*", BinaryOperator::Multiply), ("/", BinaryOperator::Divide)];
        self.chain(PRODUCTS, Self::read_signed)
    }

    /// Operands between operators of one rank, evaluated from left to right.
    fn chain(
        &mut self,
        operators: [(&str, BinaryOperator); 2],
        operand: fn(&mut Self) -> Result<(), ExpressionError>,
    ) -> Result<(), ExpressionError> {
        operand(self)?;
        while let Some((_, operator)) = operators.into_iter().find(|(sign, _)| self.accept(sign)) {
            operand(self)?;
            self.operations.push(Operation::Binary(operator));
        }
        Ok(())
    }

    /// All nesting passes here, so here its depth is counted.
    fn read_signed(&mut self) -> Result<(), ExpressionError> {
        if self.depth == MAX_DEPTH {
            let span = self.tokens.first().map_or(0, |first| first.span.start)..self.end.1;
            return Err(ExpressionError { span, problem: ExpressionProblem::TooDeep });
        }
        self.depth += 1;
        if self.accept("-") {
            let start = self.operations.len();
            self.read_signed()?;
            // A negative number is a constant.
            match &mut self.operations[start..] {
                [Operation::Constant(value)] => *value = -*value,
                _ => self.operations.push(Operation::Negate),
            }
        } else if self.accept("+") {
            self.read_signed()?;
        } else {
            self.read_atom()?;
            if self.accept("^") {
                self.read_signed()?;
                self.operations.push(Operation::Binary(BinaryOperator::Power));
            }
        }
        self.depth -= 1;
        Ok(())
    }

    fn read_atom(&mut self) -> Result<(), ExpressionError> {
        if self.accept("(") {
            self.read_sum()?;
            return self.close();
        }
        match self.peek() {
            Some(Token { kind: TokenKind::Number(value), span, .. }) => {
                if value.is_infinite() {
                    let problem = ExpressionProblem::NotFinite { value: *value };
                    return Err(ExpressionError { span: span.clone(), problem });
                }
                self.operations.push(Operation::Constant(*value));
                self.at += 1;
                Ok(())
            }
            Some(Token { kind: TokenKind::Name(name), column, span, .. }) => {
                self.at += 1;
                let (text, span) = (name.clone().into_owned(), span.clone());
                let variable = VariableName { text, column: *column, span };
                if self.accept("(") {
                    return self.read_call(&variable);
                }
                self.operations.push(Operation::Variable(variable));
                Ok(())
            }
            _ => Err(self.syntax("a number, a name or a parenthesis")),
        }
    }

    fn close(&mut self) -> Result<(), ExpressionError> {
        if self.accept(")") { Ok(()) } else { Err(self.syntax("an operator or `)`")) }
    }

    /// The arguments of a function, and their closing parenthesis.
    fn read_call(&mut self, called: &VariableName) -> Result<(), ExpressionError> {
        let Some(function) = function(&called.text, self.angle) else {
            let problem = ExpressionProblem::UnknownName {
                name: called.text.clone(),
                nearest: nearest(&called.text, function_names()),
                known: function_names().map(str::to_owned).collect(),
            };
            return Err(ExpressionError { span: called.span.clone(), problem });
        };
        self.read_sum()?;
        let mut arguments = 1;
        while self.accept(",") {
            self.read_sum()?;
            arguments += 1;
        }
        self.close()?;
        if !function.arity().contains(&arguments) {
            let problem = ExpressionProblem::ArgumentCount {
                function: function_name(function),
                expected: argument_count(function),
                found: arguments,
            };
            let end = self.tokens[self.at - 1].span.end;
            return Err(ExpressionError { span: called.span.start..end, problem });
        }
        self.operations.push(Operation::Call { function, arguments });
        Ok(())
    }
}

/// An expression at the start of a sequence of tokens.
pub(crate) struct Parsed {
    pub(crate) expression: Expression<VariableName>,
    /// Number of its tokens.
    pub(crate) tokens: usize,
}
