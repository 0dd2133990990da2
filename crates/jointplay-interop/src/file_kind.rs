//! Kinds of files, by their contents.

use jointplay_format::cell::robot::KIND as ARMS;
use jointplay_format::mechanism::kind_of;
use jointplay_format::program::is_program;

use crate::import::{is_loops_of_another_program, is_model, is_picture};

/// First bytes of pictures that are not text: PNG, JPEG and PDF.
const PICTURES: [&[u8]; 3] = [b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff", b"%PDF-"];

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
    /// A part of work cells (TOML).
    Part,
    /// A program of a work cell.
    Program,
    /// A study (TOML).
    Study,
    /// Loops that close a model (TOML or YAML).
    Loops,
    /// A picture (SVG, PNG, JPEG or PDF), which no reader accepts.
    Picture,
    /// A functional mock-up unit, which no reader accepts.
    Fmu,
}

impl FileKind {
    /// Every kind, for lists of all of them.
    pub const ALL: [Self; 11] = [
        Self::Mechanism,
        Self::Model,
        Self::ThreeRods,
        Self::Arms,
        Self::Cell,
        Self::Part,
        Self::Program,
        Self::Study,
        Self::Loops,
        Self::Picture,
        Self::Fmu,
    ];

    /// The kind that a text declares by its first element, its key `kind` or its commands; `None` for an unknown one.
    #[must_use]
    pub fn detect(text: &str) -> Option<Self> {
        if is_picture(text) {
            return Some(Self::Picture);
        }
        if is_model(text) {
            return Some(Self::Model);
        }
        match kind_of(text).as_deref() {
            Some("mechanism") => Some(Self::Mechanism),
            Some("gpr") => Some(Self::ThreeRods),
            Some(ARMS) => Some(Self::Arms),
            Some("cell") => Some(Self::Cell),
            Some("part") => Some(Self::Part),
            Some("study") => Some(Self::Study),
            Some("loops") => Some(Self::Loops),
            None if is_program(text) => Some(Self::Program),
            None if is_loops_of_another_program(text) => Some(Self::Loops),
            _ => None,
        }
    }

    /// The kind of a file that is not text, by its first bytes; `None` for an unknown one.
    ///
    /// Archives are recognised by [`document_text`](crate::import::document_text).
    #[must_use]
    pub fn detect_binary(start: &[u8]) -> Option<Self> {
        PICTURES.iter().any(|first| start.starts_with(first)).then_some(Self::Picture)
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
            Self::Part => "a part of work cells",
            Self::Program => "a program of a work cell",
            Self::Study => "a study",
            Self::Loops => "a file of loops",
            Self::Picture => "a picture",
            Self::Fmu => "a functional mock-up unit (FMU)",
        }
    }
}
