//! Dialects that are included with the program.

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
