//! Properties that decide the numbers of a study, for comparison and for messages.

use jointplay_study::plan::Variation;

use crate::number::number;

/// A property that decides the numbers of a study.
#[derive(Debug, Clone)]
pub(super) struct Fact {
    /// Its key, with the unit of `shown`.
    pub(super) key: &'static str,
    /// Its value, with all bits of its numbers.
    pub(super) exact: String,
    /// Its value in messages, in the unit of the key; `None` for one that is too long to be compared by eye.
    pub(super) shown: Option<String>,
}

impl Fact {
    /// A property that messages show as it is.
    pub(super) fn text(key: &'static str, value: impl Into<String>) -> Self {
        let exact = value.into();
        Self { key, shown: Some(exact.clone()), exact }
    }

    /// A property that is compared, and not shown.
    pub(super) fn not_shown(key: &'static str, exact: String) -> Self {
        Self { key, exact, shown: None }
    }

    /// A varied quantity.
    ///
    /// # Arguments
    /// * `in_file` – a value in the unit of the key, from one in SI units
    pub(super) fn varied(key: &'static str, values: &Variation, in_file: fn(f64) -> f64) -> Self {
        Self { key, exact: exact(values), shown: Some(shown(values, in_file)) }
    }
}

/// A varied quantity with all bits of its numbers.
pub(super) fn exact(values: &Variation) -> String {
    in_words(values, |value| value.to_string())
}

/// A varied quantity for a message.
///
/// # Arguments
/// * `in_file` – a value in the unit of the message
pub(super) fn shown(values: &Variation, in_file: impl Fn(f64) -> f64) -> String {
    in_words(values, |value| number(in_file(value)))
}

fn in_words(values: &Variation, text: impl Fn(f64) -> String) -> String {
    match values {
        Variation::Values(values) => {
            let values: Vec<String> = values.iter().map(|&value| text(value)).collect();
            match &values[..] {
                [one] => one.clone(),
                many => format!("[{}]", many.join(", ")),
            }
        }
        Variation::Uniform { from, to } => format!("uniform [{}, {}]", text(*from), text(*to)),
        Variation::Normal { mean, deviation } => {
            format!("normal [{}, {}]", text(*mean), text(*deviation))
        }
    }
}
