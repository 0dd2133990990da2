//! The result of an addition.

/// A changed text, and the name of the new entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EntryAdded {
    /// The text.
    pub text: String,
    /// The name.
    pub name: String,
}
