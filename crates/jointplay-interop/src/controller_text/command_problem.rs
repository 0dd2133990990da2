//! Errors of commands in files of host languages.

use jointplay_format::place::suggestion;

/// Error of a command of a host language.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CommandProblem {
    /// An unknown field of a pattern.
    #[error("`{{{found}}}` is not a field of patterns{}; fields: {known}", suggestion(nearest))]
    Field {
        /// The name found.
        found: String,
        /// The most similar field.
        nearest: Option<String>,
        /// All fields.
        known: String,
    },
    /// A field that a pattern has twice.
    #[error(
        "`{{{name}}}` is twice in this pattern; a second one has a name of its own, such as {{station_2}}"
    )]
    Twice {
        /// The name.
        name: &'static str,
    },
    /// A field that needs a table of codes.
    #[error("`{{{name}}}` needs the table `[{table}]`")]
    NoCodes {
        /// The field.
        name: &'static str,
        /// The table.
        table: &'static str,
    },
    /// A field without text before the next one.
    #[error(
        "`{{{name}}}` follows another field at once: text has to separate them, unless the first one is a code or a name"
    )]
    NotSeparated {
        /// The second field.
        name: &'static str,
    },
    /// A pattern without text.
    #[error("a pattern needs at least one word besides its fields")]
    NoWord,
    /// An opening or closing brace without the other one.
    #[error("a brace has no counterpart; write {{{{ or }}}} for the brace itself")]
    Brace,
    /// A command that states no program and no action, or both.
    #[error("a command has either a `program` or an `action`")]
    NoEffect,
    /// An action for a station whose pattern names no station.
    #[error("the action \"map\" needs {{station}} or {{station_code}} in the pattern")]
    NoStation,
    /// A program that does not parse.
    #[error("with values in its fields, `program` is {text:?}, which is not a program: {why}")]
    Program {
        /// The program with values.
        text: String,
        /// Why it does not parse.
        why: String,
    },
    /// A language without commands.
    #[error("a host language needs at least one [[command]]")]
    NoCommand,
}
