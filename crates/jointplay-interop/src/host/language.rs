//! The language of a host.

use super::command::CommandRule;
use crate::controller_text::{AxisFormat, Checksum, Codes, OutputFormat, Template};

/// Text of the file of the neutral language.
pub const NEUTRAL: &str = include_str!("neutral.toml");

/// Language between a host and the simulated controller: patterns of commands and templates of answers.
#[derive(Debug, Clone, PartialEq)]
pub struct HostLanguage {
    /// Name of the language.
    pub name: String,
    /// Purpose of the language, in one line.
    pub about: String,
    pub(super) axis: AxisFormat,
    pub(super) effector: Template,
    pub(super) slot: Template,
    pub(super) commands: Vec<CommandRule>,
    pub(super) station_codes: Option<Codes>,
    pub(super) effector_codes: Option<Codes>,
    pub(super) input: InputFormat,
    pub(super) answer: Answers,
    pub(super) output: OutputFormat,
}

/// Form of the received lines.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct InputFormat {
    /// The part of a line that its checksum covers; of `None` the text.
    pub(super) covered: Option<Template>,
    /// The received line; of `None` the covered part.
    pub(super) line: Option<Template>,
    pub(super) checksum: Option<Checksum>,
}

/// Templates of answers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Answers {
    pub(super) welcome: Vec<Template>,
    pub(super) accepted: Vec<Template>,
    pub(super) completed: Vec<Template>,
    pub(super) stopped: Vec<Template>,
    pub(super) refused: Vec<Template>,
    pub(super) status: Vec<Template>,
    pub(super) map: Vec<Template>,
}
