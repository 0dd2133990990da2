//! YAML with the places of its values; without aliases, so that a short text stays short.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use jointplay_core::mechanism::{Kinematics, Mechanism};
use jointplay_core::spatial::Pose;
use jointplay_format::mechanism::MAX_BYTES;
use jointplay_format::place::nearest;
use nalgebra::DVector;
use serde::de::DeserializeOwned;
use serde_saphyr::{Location, Spanned};

use crate::import::problem::{Error, Problem};
use crate::import::xml::{LONGEST_NAME, MOST_QUOTED};

/// Most nodes of a file, a loop has about ten.
const MOST_NODES: usize = 100_000;
/// Greatest depth of nested lists and tables.
const DEEPEST: usize = 16;

/// The text of a file, for its values and the places of errors.
#[derive(Clone, Copy)]
pub(crate) struct Yaml<'a> {
    pub(super) text: &'a str,
}

impl Yaml<'_> {
    /// Whether the text has a key at its top level.
    pub(super) fn has_key(self, key: &str) -> bool {
        let lines = self.text.trim_start_matches('\u{feff}').lines();
        let rests = lines.filter_map(|line| line.strip_prefix(key));
        rests.into_iter().any(|rest| rest.trim_start().starts_with(':'))
    }

    pub(super) fn parse<T: DeserializeOwned>(self) -> Result<T, Error> {
        if self.text.len() > MAX_BYTES {
            let problem = Problem::TooLong { found: self.text.len(), allowed: MAX_BYTES };
            return Err(Error::at(self.text, 0..0, problem));
        }
        let options = serde_saphyr::options! {
            budget: serde_saphyr::budget! {
                max_nodes: MOST_NODES,
                max_depth: DEEPEST,
                flow_nesting_limit: DEEPEST,
                max_aliases: 0,
                max_documents: 1,
            },
        };
        serde_saphyr::from_str_with_options(self.text, options).map_err(|error| {
            let span = error.location().map_or(0..0, |location| self.span(location));
            let message = error.without_snippet().to_string();
            // The message is shown with its place, which it must not repeat.
            let plain = message.rsplit_once(" at line ").map_or(message.as_str(), |(text, _)| text);
            Error::at(self.text, span, Problem::Yaml(plain.replace('\n', " ")))
        })
    }

    fn span(self, location: Location) -> Range<usize> {
        let span = location.span();
        let index = |number: Option<u64>| number.and_then(|number| usize::try_from(number).ok());
        let start = index(span.byte_offset()).unwrap_or(0).min(self.text.len());
        let length = index(span.byte_len()).unwrap_or(0);
        start..start.saturating_add(length).min(self.text.len())
    }

    /// An error at a value.
    pub(super) fn error<T>(self, value: &Spanned<T>, problem: impl Into<Problem>) -> Error {
        Error::at(self.text, self.span(value.referenced), problem.into())
    }

    /// An error of a value that cannot be used.
    pub(super) fn unusable<T: ToString>(
        self,
        value: &Spanned<T>,
        what: &str,
        expected: &'static str,
    ) -> Error {
        let found = value.value.to_string().chars().take(MOST_QUOTED).collect();
        self.error(value, Problem::Value { what: what.to_owned(), found, expected })
    }

    /// An error about the file as a whole.
    pub(super) fn error_at_start(self, problem: impl Into<Problem>) -> Error {
        Error::at(self.text, 0..self.text.lines().next().map_or(0, str::len), problem.into())
    }

    /// The index of a name.
    pub(super) fn find<'n>(
        self,
        what: &'static str,
        name: &Spanned<String>,
        known: impl Iterator<Item = &'n str> + Clone,
    ) -> Result<usize, Error> {
        known.clone().position(|one| one == name.value).ok_or_else(|| {
            let problem = Problem::Unknown {
                what,
                found: name.value.chars().take(MOST_QUOTED).collect(),
                nearest: nearest(&name.value, known.clone()),
                known: known.map(str::to_owned).collect(),
            };
            self.error(name, problem)
        })
    }

    /// Refuses a chain that has loops: other joints may close them.
    pub(super) fn check_open(self, chain: &Mechanism) -> Result<(), Error> {
        match chain.loops() {
            0 => Ok(()),
            found => Err(self.error_at_start(Problem::HasLoops { found })),
        }
    }
}

/// Names of joints that close loops, next to those of a chain.
pub(super) struct ClosingNames {
    taken: BTreeSet<String>,
    /// Number that the last joint of a name has.
    numbers: BTreeMap<String, usize>,
}

impl ClosingNames {
    pub(super) fn new(chain: &Mechanism) -> Self {
        let taken = chain.joints().iter().map(|joint| joint.name.clone()).collect();
        Self { taken, numbers: BTreeMap::new() }
    }

    /// `FIRST to SECOND`, with a number where this name is taken.
    pub(super) fn name(&mut self, first: &str, second: &str) -> String {
        let name = format!("{first} to {second}");
        let name: String =
            name.chars().filter(|letter| !letter.is_control()).take(LONGEST_NAME).collect();
        let mut free = name.clone();
        while !self.taken.insert(free.clone()) {
            let number = self.numbers.entry(name.clone()).or_insert(1);
            *number += 1;
            free = format!("{name} ({number})");
        }
        free
    }
}

/// Pose of each link of an open chain in the base frame, with all coordinates at zero (m).
pub(super) fn poses_at_zero(chain: &Mechanism) -> Vec<Pose> {
    let zero = DVector::zeros(chain.joint_freedoms() + chain.virtual_joints().len());
    let poses = Kinematics::new(chain).link_poses(&zero);
    poses.expect("zeros are finite, and as many as there are coordinates")
}
