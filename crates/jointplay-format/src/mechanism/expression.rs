//! Numbers written as formulas of parameters: `"a * cos(alpha) / 2"`.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use crate::number::number;
use crate::place::{listed, nearest, suggestion};

/// Deepest nesting of parentheses, powers and signs, so that no text overflows the stack.
const MAX_DEPTH: usize = 100;

/// The unit of angles in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleUnit {
    /// Degrees.
    Degree,
    /// Radians.
    Radian,
}

/// An error of an expression with the bytes that it is about.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{problem}")]
pub(crate) struct ExpressionError {
    /// Bytes of the expression that the error is about.
    pub(crate) span: Range<usize>,
    /// The error.
    pub(crate) problem: ExpressionProblem,
}

/// Errors of an expression.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExpressionProblem {
    /// An unknown name.
    #[error("unknown name `{name}`{}; known here: {}", suggestion(nearest), listed(known))]
    UnknownName {
        /// The name found.
        name: String,
        /// The known name most like it.
        nearest: Option<String>,
        /// All known names.
        known: Vec<String>,
    },
    /// Something else where a part of a formula should be.
    #[error("column {column} of the expression: expected {expected}, found {found}")]
    Syntax {
        /// Column in characters within the expression, counted from 1.
        column: usize,
        /// The parts of a formula allowed there.
        expected: &'static str,
        /// The character found.
        found: String,
    },
    /// A function with too few or too many arguments.
    #[error("`{function}` takes {expected}, but has {found}")]
    ArgumentCount {
        /// The function.
        function: &'static str,
        /// How many it takes.
        expected: &'static str,
        /// How many are given.
        found: usize,
    },
    /// A result that is NaN or infinite.
    #[error("the expression gives a value that is {}, but has to be a finite number", number(*.value))]
    NotFinite {
        /// What it gives.
        value: f64,
    },
    /// Nested too deeply.
    #[error("the expression is nested more than {MAX_DEPTH} deep")]
    TooDeep,
}

impl ExpressionError {
    /// Whether the error is an unknown name that is one of these.
    pub(crate) fn is_about(&self, names: &BTreeSet<String>) -> bool {
        matches!(&self.problem, ExpressionProblem::UnknownName { name, .. } if names.contains(name))
    }

    /// The error with the known names, if it is about an unknown one.
    pub(crate) fn among<'a>(mut self, names: impl Iterator<Item = &'a str> + Clone) -> Self {
        if let ExpressionProblem::UnknownName { name, nearest: likest, known } = &mut self.problem {
            let names = names.chain(["pi"]);
            *likest = nearest(name, names.clone());
            *known = names.map(str::to_owned).collect();
        }
        self
    }
}

/// Values of names, and the unit of angles.
#[derive(Debug, Clone)]
pub(crate) struct Scope {
    pub(crate) angle: AngleUnit,
    pub(crate) values: BTreeMap<String, f64>,
    /// All parameters of the file, also those without a value.
    pub(crate) parameters: BTreeSet<String>,
}

/// A formula, as steps of a machine with a stack: long formulas need no deep recursion.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Expression {
    steps: Vec<Step>,
    length: usize,
}

#[derive(Debug, Clone, PartialEq)]
enum Step {
    Number(f64),
    Name(String, Range<usize>),
    Negate,
    Binary(char),
    Call(Function, usize),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Sqrt,
    Abs,
    Min,
    Max,
    Hypot,
}

const FUNCTIONS: [(&str, Function); 12] = [
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("tan", Function::Tan),
    ("asin", Function::Asin),
    ("acos", Function::Acos),
    ("atan", Function::Atan),
    ("atan2", Function::Atan2),
    ("sqrt", Function::Sqrt),
    ("abs", Function::Abs),
    ("min", Function::Min),
    ("max", Function::Max),
    ("hypot", Function::Hypot),
];

/// Whether a parameter can have this name: expressions cannot refer to other names.
pub(crate) fn is_free_name(name: &str) -> bool {
    let mut characters = name.chars();
    characters.next().is_some_and(starts_name)
        && characters.all(continues_name)
        && name != "pi"
        && FUNCTIONS.iter().all(|(function, _)| *function != name)
}

fn starts_name(character: char) -> bool {
    character.is_alphabetic() || character == '_'
}

fn continues_name(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

impl Expression {
    /// Reads a formula.
    pub(crate) fn parse(text: &str) -> Result<Self, ExpressionError> {
        let mut parser = Parser { text, at: 0, depth: 0, steps: Vec::new() };
        parser.sum()?;
        match parser.peek() {
            None => Ok(Self { steps: parser.steps, length: text.len() }),
            Some(_) => Err(parser.syntax("an operator or the end")),
        }
    }

    /// The names in it, without `pi` and functions.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.steps.iter().filter_map(|step| match step {
            Step::Name(name, _) => Some(name.as_str()),
            _ => None,
        })
    }

    /// Its value: a finite number. [`ExpressionError::among`] adds the known names to an error.
    pub(crate) fn evaluate(&self, scope: &Scope) -> Result<f64, ExpressionError> {
        const COMPLETE: &str = "the parser gives each operator its operands";
        let mut stack: Vec<f64> = Vec::new();
        for step in &self.steps {
            let value = match step {
                Step::Number(value) => *value,
                Step::Name(name, span) => *scope.values.get(name).ok_or_else(|| {
                    let name = name.clone();
                    let problem =
                        ExpressionProblem::UnknownName { name, nearest: None, known: Vec::new() };
                    ExpressionError { span: span.clone(), problem }
                })?,
                Step::Negate => -stack.pop().expect(COMPLETE),
                Step::Binary(operator) => {
                    let (right, left) =
                        (stack.pop().expect(COMPLETE), stack.pop().expect(COMPLETE));
                    match operator {
                        '+' => left + right,
                        '-' => left - right,
                        '*' => left * right,
                        '/' => left / right,
                        _ => left.powf(right),
                    }
                }
                Step::Call(function, count) => {
                    let arguments = stack.split_off(stack.len() - count);
                    function.value(&arguments, scope.angle)
                }
            };
            stack.push(value);
        }
        let value = stack.pop().expect(COMPLETE);
        if value.is_finite() {
            Ok(value)
        } else {
            let problem = ExpressionProblem::NotFinite { value };
            Err(ExpressionError { span: 0..self.length, problem })
        }
    }
}

impl Function {
    /// Number of arguments, and its text for messages.
    fn arity(self) -> (std::ops::RangeInclusive<usize>, &'static str) {
        match self {
            Self::Atan2 | Self::Hypot => (2..=2, "2 arguments"),
            Self::Min | Self::Max => (1..=usize::MAX, "1 argument or more"),
            _ => (1..=1, "1 argument"),
        }
    }

    fn value(self, arguments: &[f64], angle: AngleUnit) -> f64 {
        let x = arguments[0];
        let sin_cos = || match angle {
            AngleUnit::Degree => sin_cos_degrees(x),
            AngleUnit::Radian => x.sin_cos(),
        };
        let turn = |radians: f64| match angle {
            AngleUnit::Degree => radians.to_degrees(),
            AngleUnit::Radian => radians,
        };
        match self {
            Self::Sin => sin_cos().0,
            Self::Cos => sin_cos().1,
            Self::Tan => {
                let (sine, cosine) = sin_cos();
                sine / cosine
            }
            Self::Asin => turn(x.asin()),
            Self::Acos => turn(x.acos()),
            Self::Atan => turn(x.atan()),
            Self::Atan2 => turn(x.atan2(arguments[1])),
            Self::Sqrt => x.sqrt(),
            Self::Abs => x.abs(),
            // Unlike `f64::min`, the result is NaN if an argument is.
            Self::Min => arguments.iter().copied().reduce(f64_least).unwrap_or(x),
            Self::Max => -arguments.iter().map(|x| -x).reduce(f64_least).unwrap_or(-x),
            Self::Hypot => x.hypot(arguments[1]),
        }
    }
}

fn f64_least(a: f64, b: f64) -> f64 {
    if a.is_nan() || a < b { a } else { b }
}

/// Sine and cosine, exact at every right angle: `cos(90)` is 0 and not 6e-17.
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

/// ```text
///    sum     = product { ("+" | "-") product }
///    product = signed { ("*" | "/") signed }
///    signed  = "-" signed | power
///    power   = atom [ "^" signed ]
///    atom    = number | name | function "(" sum { "," sum } ")" | "(" sum ")"
/// ```
struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
    steps: Vec<Step>,
}

impl Parser<'_> {
    /// The next character that is no space.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// Passes this character if it is next.
    fn accept(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        self.at += if found { wanted.len_utf8() } else { 0 };
        found
    }

    fn syntax(&mut self, expected: &'static str) -> ExpressionError {
        let next = self.peek();
        let found = next.map_or_else(|| "the end".to_owned(), |next| format!("{next:?}"));
        let column = self.text[..self.at].chars().count() + 1;
        let problem = ExpressionProblem::Syntax { column, expected, found };
        ExpressionError { span: self.at..self.at + next.map_or(0, char::len_utf8), problem }
    }

    fn sum(&mut self) -> Result<(), ExpressionError> {
        self.chain(['+', '-'], Self::product)
    }

    fn product(&mut self) -> Result<(), ExpressionError> {
        self.chain(['*', '/'], Self::signed)
    }

    /// Operands between operators of one rank, evaluated from left to right.
    fn chain(
        &mut self,
        operators: [char; 2],
        operand: fn(&mut Self) -> Result<(), ExpressionError>,
    ) -> Result<(), ExpressionError> {
        operand(self)?;
        while let Some(operator) = operators.into_iter().find(|&operator| self.accept(operator)) {
            operand(self)?;
            self.steps.push(Step::Binary(operator));
        }
        Ok(())
    }

    /// All nesting passes here, so here its depth is counted.
    fn signed(&mut self) -> Result<(), ExpressionError> {
        if self.depth == MAX_DEPTH {
            let problem = ExpressionProblem::TooDeep;
            return Err(ExpressionError { span: 0..self.text.len(), problem });
        }
        self.depth += 1;
        if self.accept('-') {
            self.signed()?;
            self.steps.push(Step::Negate);
        } else {
            self.atom()?;
            if self.accept('^') {
                self.signed()?;
                self.steps.push(Step::Binary('^'));
            }
        }
        self.depth -= 1;
        Ok(())
    }

    fn atom(&mut self) -> Result<(), ExpressionError> {
        match self.peek() {
            Some('(') => {
                self.accept('(');
                self.sum()?;
                self.close()
            }
            Some(next) if next.is_ascii_digit() || next == '.' => self.number(),
            Some(next) if starts_name(next) => self.name(),
            _ => Err(self.syntax("a number, a name or a parenthesis")),
        }
    }

    fn close(&mut self) -> Result<(), ExpressionError> {
        if self.accept(')') { Ok(()) } else { Err(self.syntax("an operator or `)`")) }
    }

    fn number(&mut self) -> Result<(), ExpressionError> {
        let rest = &self.text[self.at..];
        let digits = |from: usize| {
            from + rest[from..].bytes().take_while(|byte| byte.is_ascii_digit()).count()
        };
        let mut end = digits(0);
        if rest[end..].starts_with('.') {
            end = digits(end + 1);
        }
        if rest[end..].starts_with(['e', 'E']) {
            let sign = usize::from(rest[end + 1..].starts_with(['+', '-']));
            let exponent = digits(end + 1 + sign);
            // Without digits, the letter starts a name, which is refused there.
            end = if exponent > end + 1 + sign { exponent } else { end };
        }
        let value = rest[..end].parse().map_err(|_| self.syntax("a number"))?;
        self.steps.push(Step::Number(value));
        self.at += end;
        Ok(())
    }

    fn name(&mut self) -> Result<(), ExpressionError> {
        let start = self.at;
        let rest = &self.text[start..];
        let name = &rest[..rest.find(|next| !continues_name(next)).unwrap_or(rest.len())];
        self.at += name.len();
        let span = start..self.at;
        let function = FUNCTIONS.iter().find(|(function, _)| *function == name);
        if !self.accept('(') {
            match (name, function) {
                ("pi", _) => self.steps.push(Step::Number(std::f64::consts::PI)),
                (_, Some(_)) => return Err(self.syntax("`(` and the arguments of the function")),
                _ => self.steps.push(Step::Name(name.to_owned(), span)),
            }
            return Ok(());
        }
        let Some(&(name, function)) = function else {
            let known = FUNCTIONS.iter().map(|(function, _)| *function);
            let problem = ExpressionProblem::UnknownName {
                name: name.to_owned(),
                nearest: nearest(name, known.clone()),
                known: known.map(str::to_owned).collect(),
            };
            return Err(ExpressionError { span, problem });
        };
        self.sum()?;
        let mut count = 1;
        while self.accept(',') {
            self.sum()?;
            count += 1;
        }
        self.close()?;
        let (allowed, expected) = function.arity();
        if !allowed.contains(&count) {
            let problem =
                ExpressionProblem::ArgumentCount { function: name, expected, found: count };
            return Err(ExpressionError { span: start..self.at, problem });
        }
        self.steps.push(Step::Call(function, count));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn value(text: &str, angle: AngleUnit) -> Result<f64, ExpressionError> {
        let values = [("a".to_owned(), 0.22), ("alpha".to_owned(), 90.0), ("ψ".to_owned(), 7.0)];
        let scope = Scope { angle, values: values.into(), parameters: BTreeSet::new() };
        let names = scope.values.keys().map(String::as_str);
        Expression::parse(text)?.evaluate(&scope).map_err(|error| error.among(names))
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
        check("asin(1) + acos(-1) + atan(1) + atan2(-1, 0)", 90.0 + 180.0 + 45.0 - 90.0);
    }

    #[test]
    fn angles_are_in_the_unit_of_the_file() {
        assert_eq!(value("cos(alpha)", AngleUnit::Degree).unwrap(), 0.0);
        assert_eq!(value("sin(-alpha)", AngleUnit::Degree).unwrap(), -1.0);
        assert_eq!(value("sin(180) + cos(-270) + tan(720)", AngleUnit::Degree).unwrap(), 0.0);
        assert_eq!(value("cos(a)", AngleUnit::Radian).unwrap(), 0.22_f64.cos());
        for step in -80..80 {
            let degrees = f64::from(step) * 11.3;
            let (sine, cosine) = sin_cos_degrees(degrees);
            assert!((sine - degrees.to_radians().sin()).abs() < 1e-14);
            assert!((cosine - degrees.to_radians().cos()).abs() < 1e-14);
        }
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
        refuse("1.2.3", 3..4, "expected an operator");
        refuse(".", 0..1, "a number");
        refuse("cos", 3..3, "arguments of the function");
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
