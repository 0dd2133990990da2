//! What can be wrong in the text of a program.

use crate::place::{listed, suggestion};

/// Why a text is no program, and where.
pub type Error = crate::place::Error<Problem>;

/// What can be wrong in the text of a program; numbers are in the units of the text.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// More text than a program needs.
    #[error("the text has {found} bytes, but at most {allowed} are allowed")]
    TooLong {
        /// How many there are.
        found: usize,
        /// How many may be.
        allowed: usize,
    },
    /// Blocks within blocks within blocks.
    #[error("blocks stand within each other more than {allowed} deep; put some into a ROUTINE")]
    TooDeep {
        /// How deep they may.
        allowed: usize,
    },
    /// A line that starts with no command.
    #[error("`{found}` is no command{}; commands: {}", suggestion(nearest), known.join(", "))]
    Command {
        /// What was found.
        found: String,
        /// The command most like it.
        nearest: Option<String>,
        /// All commands.
        known: Vec<String>,
    },
    /// Something else than the grammar has here.
    #[error("expected {}, found {found}{}", alternatives(expected), suggestion(nearest))]
    Expected {
        /// What could stand here.
        expected: Vec<String>,
        /// What does.
        found: String,
        /// The word of the language most like it, of those that could.
        nearest: Option<String>,
    },
    /// A word of the language where a name has to be.
    #[error(
        "expected {}, found the word {word} of the language; as a name, write \"{word}\" with its quotes",
        alternatives(expected)
    )]
    Reserved {
        /// What could stand here.
        expected: Vec<String>,
        /// The word.
        word: String,
    },
    /// A name with one quote.
    #[error("the name {found} has no closing quote")]
    Unclosed {
        /// What was found.
        found: String,
    },
    /// A name that is empty or would upset a terminal.
    #[error("a name is empty or has control characters in it: {found}")]
    Name {
        /// What was found.
        found: String,
    },
    /// A number that says of what it is not.
    #[error("{number} needs a unit: {}", alternatives(allowed))]
    NoUnit {
        /// As written.
        number: String,
        /// Units that it could have.
        allowed: Vec<String>,
    },
    /// A unit that does not fit.
    #[error("{number} {found}: the unit has to be {}", alternatives(allowed))]
    Unit {
        /// As written.
        number: String,
        /// The unit as written.
        found: String,
        /// Units that it could have.
        allowed: Vec<String>,
    },
    /// A number out of its range.
    #[error("{what} is {found}, but has to be {allowed}")]
    Range {
        /// What it is of.
        what: &'static str,
        /// As written.
        found: String,
        /// What may stand here.
        allowed: String,
    },
    /// The same thing a second time in one line.
    #[error("`{name}` is there twice")]
    Twice {
        /// What.
        name: String,
    },
    /// A block without its END.
    #[error("this {opened} has no END")]
    NoEnd {
        /// What was opened: REPEAT or ROUTINE.
        opened: &'static str,
    },
    /// An END without a block.
    #[error("END closes nothing here: no REPEAT or ROUTINE is open")]
    StrayEnd,
    /// A routine within a block.
    #[error(
        "a ROUTINE cannot stand within the {outer} of line {line}; is the END of that missing?"
    )]
    InnerRoutine {
        /// The block around it: REPEAT or ROUTINE.
        outer: &'static str,
        /// Where that starts.
        line: usize,
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
