//! Kinds of files, by their contents.

use jointplay_format::cell::robot::KIND as ARMS;
use jointplay_format::mechanism::kind_of;

use crate::import::is_model;

/// Kind of an input file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A mechanism file (TOML).
    Mechanism,
    /// A model of another program: MJCF, SDF, URDF or ASMT.
    Model,
    /// A three-rod robot (TOML).
    ThreeRods,
    /// A robot with arms (TOML).
    Arms,
    /// A work cell (TOML).
    Cell,
    /// A study (TOML).
    Study,
    /// Loops that close a model (TOML).
    Loops,
}

impl FileKind {
    /// The kind that a text declares by its first element or its key `kind`; `None` for an unknown one.
    #[must_use]
    pub fn detect(text: &str) -> Option<Self> {
        if is_model(text) {
            return Some(Self::Model);
        }
        match kind_of(text)?.as_str() {
            "mechanism" => Some(Self::Mechanism),
            "gpr" => Some(Self::ThreeRods),
            ARMS => Some(Self::Arms),
            "cell" => Some(Self::Cell),
            "study" => Some(Self::Study),
            "loops" => Some(Self::Loops),
            _ => None,
        }
    }

    /// Name of the kind with its article, such as `a work cell`.
    #[must_use]
    pub fn noun(self) -> &'static str {
        match self {
            Self::Mechanism => "a mechanism",
            Self::Model => "a model of another program",
            Self::ThreeRods => "a three-rod robot",
            Self::Arms => "a robot with arms",
            Self::Cell => "a work cell",
            Self::Study => "a study",
            Self::Loops => "a file of loops",
        }
    }
}
