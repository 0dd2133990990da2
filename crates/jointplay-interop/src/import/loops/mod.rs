//! Files that close the loops of an open chain: our own in TOML, and YAML of other programs.
//!
//! | top-level key | written by | loop |
//! | --- | --- | --- |
//! | `closures` | exporters of SolidWorks, scikit-robot | a hinge of two links, at a point and along an axis in the base frame |
//! | `closed_loop` | the robot collections of Pinocchio | two frames that coincide, in position or in position and orientation |

mod closures;
mod frame_pairs;
mod yaml;

use std::collections::BTreeSet;

use jointplay_core::mechanism::Mechanism;
use jointplay_format::mechanism as native;

use super::problem::Error;
use yaml::Yaml;

/// Top-level key of hinges.
const CLOSURES: &str = "closures";
/// Top-level key of frames that coincide.
const FRAME_PAIRS: &str = "closed_loop";

/// Whether a text closes loops in the YAML of another program, by its top-level keys.
#[must_use]
pub fn is_loops_of_another_program(text: &str) -> bool {
    let yaml = Yaml { text };
    [CLOSURES, FRAME_PAIRS].into_iter().any(|key| yaml.has_key(key))
}

/// A file of loops, parsed.
pub(super) enum LoopFile<'a> {
    Toml(&'a str),
    Closures(closures::Closures, Yaml<'a>),
    FramePairs(frame_pairs::FramePairs, Yaml<'a>),
}

/// Error of a file of loops.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoopsError {
    /// Errors of a TOML file.
    #[error(transparent)]
    Toml(#[from] native::Errors),
    /// Error of a YAML file.
    #[error(transparent)]
    Yaml(#[from] Error),
}

impl<'a> LoopFile<'a> {
    /// Reads a file; YAML is recognized by its top-level keys.
    pub(super) fn parse(text: &'a str) -> Result<Self, LoopsError> {
        let yaml = Yaml { text };
        Ok(if yaml.has_key(CLOSURES) {
            Self::Closures(yaml.parse()?, yaml)
        } else if yaml.has_key(FRAME_PAIRS) {
            Self::FramePairs(yaml.parse()?, yaml)
        } else {
            Self::Toml(text)
        })
    }

    /// Joints whose coordinates follow from the loops, so that a coupling to another joint is not needed.
    pub(super) fn solved(&self) -> BTreeSet<&str> {
        match self {
            Self::Closures(closures, _) => closures.solved(),
            Self::Toml(_) | Self::FramePairs(..) => BTreeSet::new(),
        }
    }

    /// Closes the loops of a chain; parts of it that the file replaces are added to the ignored ones.
    pub(super) fn close(
        &self,
        chain: &Mechanism,
        ignored: &mut Vec<String>,
    ) -> Result<Mechanism, LoopsError> {
        match self {
            Self::Toml(text) => Ok(native::with_loops(chain, text)?),
            Self::Closures(closures, yaml) => Ok(closures.close(*yaml, chain)?),
            Self::FramePairs(pairs, yaml) => Ok(pairs.close(*yaml, chain, ignored)?),
        }
    }
}
