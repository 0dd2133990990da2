//! Identifiers and texts in Modelica.

use std::collections::BTreeSet;

/// Classes that a package would hide.
const TAKEN: [&str; 8] =
    ["Real", "Integer", "Boolean", "String", "Clock", "Complex", "Modelica", "ModelicaServices"];

/// The name of a class in Modelica for a name: its words joined, each with a capital letter.
///
/// # Example
/// ```
/// use jointplay_interop::export::mechanism::modelica_class;
/// assert_eq!(modelica_class("3-rps"), "M3Rps");
/// ```
#[must_use]
pub fn modelica_class(name: &str) -> String {
    let mut class = String::new();
    for word in name.split(|c: char| !c.is_ascii_alphanumeric()) {
        let mut letters = word.chars();
        class.extend(letters.next().map(|first| first.to_ascii_uppercase()));
        class.extend(letters);
    }
    let is_name = class.starts_with(|c: char| c.is_ascii_alphabetic());
    if is_name && !TAKEN.contains(&class.as_str()) { class } else { format!("M{class}") }
}

/// Identifiers of the components of a model.
#[derive(Default)]
pub(super) struct Identifiers {
    taken: BTreeSet<String>,
    /// Whether a name has characters that its identifier has not.
    pub(super) are_changed: bool,
}

impl Identifiers {
    /// An identifier that no other component has, from a kind of component and a name.
    pub(super) fn fresh(&mut self, kind: &str, name: &str) -> String {
        let allowed = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let plain: String = name.chars().map(allowed).collect();
        self.are_changed |= plain != name;
        let first = format!("{kind}_{plain}");
        let numbered = (2..).map(|number| format!("{first}_{number}"));
        let mut names = std::iter::once(first.clone()).chain(numbered);
        let free = names.find(|one| !self.taken.contains(one)).expect("names are finitely many");
        self.taken.insert(free.clone());
        free
    }
}

/// A text between quotation marks.
pub(super) fn quoted(text: &str) -> String {
    let escape = |c: char| match c {
        '"' => "\\\"".to_owned(),
        '\\' => "\\\\".to_owned(),
        '\n' | '\r' => " ".to_owned(),
        c => c.to_string(),
    };
    format!("\"{}\"", text.chars().map(escape).collect::<String>())
}
