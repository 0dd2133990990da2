//! A study as read.

use std::collections::BTreeMap;
use std::sync::Arc;

use jointplay_study::plan::Study;

use super::fact::Fact;
use super::names::Column;

/// A study as read.
#[derive(Clone)]
pub struct StudyFile {
    /// Name of the study in the file.
    pub name: String,
    /// The file (TOML).
    pub text: String,
    /// The robot, mechanism or cell, as its own file calls it.
    pub mechanism: String,
    /// The files that were read for the study, by the names that it has for them; with its text they make the same study again, see [`from_files`](super::from_files).
    pub files: BTreeMap<String, Vec<u8>>,
    /// Plan of the computation.
    pub plan: Arc<dyn Study>,
    /// The columns of its table.
    pub columns: Vec<Column>,
    pub(super) facts: Vec<Fact>,
}

impl StudyFile {
    /// Facts that determine the numbers of this study, by key; two studies that agree in all have the same table.
    ///
    /// Numbers have all their bits.
    pub fn facts(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.facts.iter().map(|fact| (fact.key, fact.exact.as_str()))
    }

    /// Differences of a study file from this study, which was started, in words; nothing where both have the same table.
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let of = |study: &Self, key: &str| study.facts.iter().position(|fact| fact.key == key);
        let changed = self.facts.iter().filter_map(|fact| {
            let found = of(other, fact.key).map(|k| &other.facts[k]);
            let is_same = found.is_some_and(|found| found.exact == fact.exact);
            (!is_same).then(|| difference(fact.key, Some(fact), found))
        });
        let added = other.facts.iter().filter(|fact| of(self, fact.key).is_none());
        changed.chain(added.map(|fact| difference(fact.key, None, Some(fact)))).collect()
    }
}

/// A property in which a study file differs from the study that was started.
fn difference(key: &str, started: Option<&Fact>, found: Option<&Fact>) -> String {
    /// Longer values are not shown.
    const LONGEST: usize = 60;
    let shown = |fact: Option<&Fact>| match fact {
        None => Some("none".to_owned()),
        Some(fact) => fact.shown.clone(),
    };
    match (shown(started), shown(found)) {
        (Some(a), Some(b)) if a != b && a.len() + b.len() < 2 * LONGEST => {
            format!("{key}: {a} in the study that was started, {b} in this file")
        }
        _ => format!("{key}: not the same"),
    }
}
