//! The result of an addition.

use crate::line_ends;

/// A changed text, and the name of the new entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EntryAdded {
    /// The text.
    pub text: String,
    /// The name.
    pub name: String,
}

impl EntryAdded {
    /// The same, with the line ends of the text before the addition.
    pub(super) fn in_text(self, before: &str) -> Self {
        Self { text: line_ends::as_before(self.text, before), ..self }
    }
}
