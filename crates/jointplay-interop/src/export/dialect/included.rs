//! Dialects that are included with the program.

use jointplay_format::place;

/// An included dialect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IncludedDialect {
    /// Name of the dialect.
    pub name: &'static str,
    /// Text of its file.
    pub text: &'static str,
}

/// The included dialects, the neutral one first.
pub const DIALECTS: [IncludedDialect; 2] = [
    IncludedDialect { name: "neutral", text: include_str!("neutral.toml") },
    IncludedDialect { name: "points", text: include_str!("points.toml") },
];

impl IncludedDialect {
    /// The included dialect with a name.
    ///
    /// # Errors
    /// A message with the nearest name and all of them.
    pub fn named(name: &str) -> Result<Self, String> {
        let found = DIALECTS.into_iter().find(|entry| entry.name == name);
        let known = || DIALECTS.map(|entry| entry.name.to_owned());
        found.ok_or_else(|| place::not_known("the dialect", name, &known()))
    }
}
