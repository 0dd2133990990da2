//! A study as read.

use std::collections::BTreeMap;
use std::sync::Arc;

use jointplay_study::plan::Study;

use super::names::Column;

/// A study as read.
#[derive(Clone)]
pub struct StudyFile {
    /// What the file calls it.
    pub name: String,
    /// The file (TOML).
    pub text: String,
    /// The robot, mechanism or cell, as its own file calls it.
    pub mechanism: String,
    /// The files that were read for the study, by the names that it has for them; with its text they make the same study again, see [`from_files`](super::from_files).
    pub files: BTreeMap<String, Vec<u8>>,
    /// What is computed.
    pub plan: Arc<dyn Study>,
    /// The columns of its table.
    pub columns: Vec<Column>,
    pub(super) facts: Vec<(&'static str, String)>,
}

impl StudyFile {
    /// What decides the numbers of this study, by key; two studies that agree in all have the same table.
    #[must_use]
    pub fn facts(&self) -> &[(&'static str, String)] {
        &self.facts
    }

    /// In what another study differs from this one, in words; nothing where both have the same table.
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<String> {
        /// Longer values are not shown.
        const LONGEST: usize = 60;
        let here = |key: &str| other.facts.iter().find(|(name, _)| *name == key);
        let there = self.facts.iter().filter_map(|(key, a)| {
            let b = here(key).map_or("none", |(_, b)| b.as_str());
            (a != b).then(|| {
                if a.len() + b.len() < 2 * LONGEST {
                    format!("{key}: {a} there, {b} here")
                } else {
                    format!("{key}: not the same")
                }
            })
        });
        there.collect()
    }
}
