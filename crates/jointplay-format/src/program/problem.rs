//! Errors in the text of a program.

use crate::expression::ExpressionProblem;
use crate::place::{listed, suggestion};

/// An error in the text of a program, with its place.
pub type Error = crate::place::Error<Problem>;

/// Errors in the text of a program; numbers are in the units of the text.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// A text that is too long.
    #[error("the text has {found} bytes, but at most {allowed} are allowed")]
    TooLong {
        /// Length found (bytes).
        found: usize,
        /// Length allowed (bytes).
        allowed: usize,
    },
    /// Blocks that are nested too deeply.
    #[error("blocks are nested more than {allowed} deep; move some into a ROUTINE")]
    TooDeep {
        /// Depth allowed.
        allowed: usize,
    },
    /// A line that starts with no command.
    #[error("`{found}` is no command{}; commands: {}", suggestion(nearest), known.join(", "))]
    Command {
        /// The word found.
        found: String,
        /// The most similar command.
        nearest: Option<String>,
        /// All commands.
        known: Vec<String>,
    },
    /// A token that the grammar does not allow here.
    #[error("expected {}, found {found}{}", alternatives(expected), suggestion(nearest))]
    Expected {
        /// Alternatives allowed here.
        expected: Vec<String>,
        /// The token found.
        found: String,
        /// The most similar keyword among the alternatives.
        nearest: Option<String>,
    },
    /// A keyword in place of a name.
    #[error(
        "expected {}, found the word {word} of the language; as a name, write \"{word}\" with its quotes",
        alternatives(expected)
    )]
    Reserved {
        /// Alternatives allowed here.
        expected: Vec<String>,
        /// The keyword.
        word: String,
    },
    /// A token that the grammar does not allow here, in a command whose form is shown.
    #[error("expected {}, found {found}; write `{form}`", alternatives(expected))]
    Form {
        /// Alternatives allowed here.
        expected: Vec<String>,
        /// The token found.
        found: String,
        /// The command with its form, in the names of the line.
        form: String,
    },
    /// A name without a closing quote.
    #[error("the name {found} has no closing quote")]
    Unclosed {
        /// The text found.
        found: String,
    },
    /// A name that is empty or contains control characters.
    #[error("a name must not be empty or contain control characters: {found}")]
    Name {
        /// The text found.
        found: String,
    },
    /// A number without a unit.
    #[error("{number} needs a unit: {}", alternatives(allowed))]
    NoUnit {
        /// The number as written.
        number: String,
        /// Allowed units.
        allowed: Vec<String>,
    },
    /// A unit that is not allowed here.
    #[error("{number} {found}: the unit has to be {}", alternatives(allowed))]
    Unit {
        /// The number as written.
        number: String,
        /// The unit as written.
        found: String,
        /// Allowed units.
        allowed: Vec<String>,
    },
    /// A number out of its range.
    #[error("{what} is {found}, but has to be {allowed}")]
    Range {
        /// The quantity.
        what: &'static str,
        /// The number as written.
        found: String,
        /// Allowed values.
        allowed: String,
    },
    /// A name that occurs twice in one line.
    #[error("`{name}` occurs twice in this line")]
    Twice {
        /// The name.
        name: String,
    },
    /// A block without its END.
    #[error("this {opened} has no END")]
    NoEnd {
        /// Keyword of the block: REPEAT, IF or ROUTINE.
        opened: &'static str,
    },
    /// An END without a block.
    #[error("END without a block: no REPEAT, IF or ROUTINE is open")]
    UnmatchedEnd,
    /// An ELSE without an IF.
    #[error("ELSE without a block: no IF is open")]
    UnmatchedElse,
    /// An ELSE after that of the same IF.
    #[error("this IF has an ELSE already; a condition needs ELSE IF before it")]
    ElseAfterElse,
    /// A routine or parameter within a block.
    #[error(
        "a {inner} cannot be inside the {outer} of line {line}; is the END of that block missing?"
    )]
    InnerDeclaration {
        /// ROUTINE or PARAMETER.
        inner: &'static str,
        /// Keyword of the block around it: REPEAT, IF or ROUTINE.
        outer: &'static str,
        /// First line of the block around it.
        line: usize,
    },
    /// An expression without a value.
    #[error(transparent)]
    Expression(#[from] ExpressionProblem),
    /// An expression before a unit without parentheses.
    #[error("an expression before a unit needs parentheses, as in `(2 * lift) mm`")]
    NoParentheses,
    /// A bound of a parameter in another unit.
    #[error("the bound {found} needs the unit of the parameter: {allowed}")]
    BoundUnit {
        /// The bound as written.
        found: String,
        /// Unit of the parameter.
        allowed: String,
    },
    /// A bound of a parameter that is not a number.
    #[error("a bound of a parameter has to be a number, found {found}")]
    BoundNumber {
        /// The bound as written.
        found: String,
    },
    /// An expression whose parameters have another unit than the expression.
    #[error("the expression is in {found}, but has to be {allowed}")]
    ExpressionUnit {
        /// Unit of the parameters of the expression.
        found: String,
        /// Unit as written, in words.
        allowed: String,
    },
    /// Parameters whose units do not fit together.
    #[error("{left} and {right} have no common unit")]
    Units {
        /// Unit of the left operand.
        left: String,
        /// Unit of the right operand.
        right: String,
    },
}

/// `a`, `a or b`, `a, b or c`.
fn alternatives(choices: &[String]) -> String {
    match choices {
        [] => "nothing".to_owned(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} or {last}", listed(first)),
    }
}
