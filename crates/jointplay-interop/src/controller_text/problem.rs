//! Errors of files of dialects and host languages.

use jointplay_format::file_problem::FileProblem;
use jointplay_format::number::number;
use jointplay_format::place::suggestion;

use super::command_problem::CommandProblem;

/// Errors of dialect files, and of a motion that a dialect cannot express.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// An error that any TOML file can have.
    #[error(transparent)]
    Common(#[from] FileProblem),
    /// An error of a command of a host language.
    #[error(transparent)]
    Command(#[from] CommandProblem),
    /// An invalid file extension.
    #[error("`extension` is {found:?}, but has to be letters and digits")]
    Extension {
        /// The extension found.
        found: String,
    },
    /// An unknown name in braces.
    #[error(
        "`{{{found}}}` is not a name of this template{}; known here: {known}",
        suggestion(nearest)
    )]
    Name {
        /// The name found.
        found: String,
        /// The most similar known name.
        nearest: Option<String>,
        /// All known names.
        known: String,
    },
    /// A name whose key is missing.
    #[error("`{{{name}}}` needs {key} in the dialect")]
    UndefinedName {
        /// The name.
        name: &'static str,
        /// The key that defines it.
        key: &'static str,
    },
    /// A template that omits the text of comments or lines.
    #[error("`{key}` has no {needed}: all {lost}, with the warnings of violations, would be lost")]
    TextLost {
        /// The key of the template.
        key: &'static str,
        /// Fields of which one is necessary.
        needed: &'static str,
        /// Texts that would be lost.
        lost: &'static str,
    },
    /// A format that is invalid, or does not fit its value.
    #[error("`{found}` is not a format of {kind}; allowed in this order: {allowed}")]
    Format {
        /// The format found.
        found: String,
        /// Kind of the value.
        kind: &'static str,
        /// Parts of a format of such a value.
        allowed: &'static str,
    },
    /// A text within an expression.
    #[error("`{name}` is a text, and expressions have numbers only")]
    TextInExpression {
        /// Name of the text.
        name: String,
    },
    /// An expression without a finite value, such as a division by zero.
    #[error("`{expression}` is {} for {arguments}, but has to be finite: it divides by zero or is not defined there", number(*.value))]
    NoValue {
        /// The expression.
        expression: String,
        /// Its value.
        value: f64,
        /// Values of its names.
        arguments: String,
    },
    /// An expression that has to be whole, and is not.
    #[error("`{expression}` is {} for {arguments}, but its format is that of a whole number; use f as its type, or round(…), floor(…) or ceil(…)", number(*.value))]
    NotWhole {
        /// The expression.
        expression: String,
        /// Its value.
        value: f64,
        /// Values of its names.
        arguments: String,
    },
    /// More fields than a template may have.
    #[error("a template has at most {allowed} fields")]
    TooManyFields {
        /// Largest number of fields.
        allowed: usize,
    },
    /// A filled template that is too long.
    #[error(
        "the text of this template is longer than {allowed} bytes with the values of its fields"
    )]
    TextTooLong {
        /// Largest length (bytes).
        allowed: usize,
    },
    /// An opening brace without a closing one.
    #[error("a field that begins with {{ ends without }}; write {{{{ for the brace itself")]
    Open,
    /// A closing brace without an opening one.
    #[error("a }} has no opening brace; write }}}} for the brace itself")]
    Close,
    /// A dialect that describes motions in no manner, or in both.
    #[error("a dialect describes motions by either `axes`, `line` and `still`, or `point`")]
    Motions,
    /// Codes of different types.
    #[error("the codes in `[{table}]` have to be all texts, or all whole numbers")]
    MixedCodes {
        /// The table.
        table: &'static str,
    },
    /// A station or an effector of the program without a code.
    #[error(
        "`[{table}]` has no code for {name:?}{}; codes exist for: {known}",
        suggestion(nearest)
    )]
    NoCode {
        /// The table.
        table: &'static str,
        /// The name without a code.
        name: String,
        /// The most similar name with a code.
        nearest: Option<String>,
        /// All names with a code.
        known: String,
    },
}
