//! Values of counters and arguments during the expansion of a program.

use super::SourceLocation;
use super::resolved::{ResolvedNumber, ResolvedRoutine, Variable};
use crate::robot::EffectorId;

/// Argument of a routine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ArgumentValue {
    Number(f64),
    Station(usize),
    Effector(EffectorId),
    /// An argument that the routine does not use.
    Unused,
}

/// The main instructions or a routine during their execution.
pub(super) struct Frame<'r> {
    /// The routine with the location of its call; `None` for the main instructions.
    pub(super) routine: Option<(&'r ResolvedRoutine, SourceLocation)>,
    pub(super) arguments: Vec<ArgumentValue>,
    /// Names and passes of the REPEATs around the instruction, outermost first.
    pub(super) counters: Vec<(Option<&'r str>, u64)>,
}

impl Frame<'_> {
    /// The main instructions.
    pub(super) fn main() -> Self {
        Self { routine: None, arguments: Vec::new(), counters: Vec::new() }
    }

    /// Value of a number; NaN or infinite where its expression is not defined.
    #[expect(clippy::cast_precision_loss, reason = "numbers of passes are far below 2⁵³")]
    pub(super) fn value(&self, number: &ResolvedNumber) -> f64 {
        let value_of = |variable: &Variable| {
            Ok::<f64, std::convert::Infallible>(match *variable {
                Variable::Constant(value) => value,
                Variable::Counter(repeat) => self.counters[repeat].1 as f64,
                // Arguments that are used as numbers are numbers.
                Variable::Argument(index) => match self.arguments[index] {
                    ArgumentValue::Number(value) => value,
                    _ => f64::NAN,
                },
            })
        };
        let Ok(value) = number.expression.evaluate(value_of);
        value
    }

    /// Counters and numeric arguments, for messages.
    #[expect(clippy::cast_precision_loss, reason = "numbers of passes are far below 2⁵³")]
    pub(super) fn variables(&self) -> Vec<(String, f64)> {
        let names = self.routine.map_or(&[][..], |(routine, _)| &routine.parameters);
        let arguments = names.iter().zip(&self.arguments).filter_map(|(name, value)| match value {
            ArgumentValue::Number(value) => Some((name.clone(), *value)),
            _ => None,
        });
        let counters = self.counters.iter();
        let counters =
            counters.filter_map(|(name, pass)| Some(((*name)?.to_owned(), *pass as f64)));
        arguments.chain(counters).collect()
    }
}
