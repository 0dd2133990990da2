//! The language of a controller.

use crate::controller_text::{AxisFormat, Codes, OutputFormat, Template};

/// Language of a controller.
#[derive(Debug, Clone, PartialEq)]
pub struct Dialect {
    /// Name of the dialect.
    pub name: String,
    /// Purpose of the dialect, in one line.
    pub about: String,
    /// Extension of its files.
    pub extension: String,
    pub(super) time_decimals: usize,
    pub(super) axis: AxisFormat,
    /// Pose of one effector in the poses of all.
    pub(super) pose: Option<Template>,
    pub(super) comment: Template,
    pub(super) begin: Vec<Template>,
    pub(super) instruction: Vec<Template>,
    pub(super) motion: Motions,
    pub(super) blend: Vec<Template>,
    pub(super) taken: Vec<Template>,
    pub(super) left: Vec<Template>,
    pub(super) end: Vec<Template>,
    pub(super) station_codes: Option<Codes>,
    pub(super) effector_codes: Option<Codes>,
    pub(super) output: OutputFormat,
}

/// Description of motions.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Motions {
    /// By the end and the duration of each motion.
    Steps { axes: Vec<Template>, line: Vec<Template>, still: Vec<Template> },
    /// By points at equal intervals of time.
    Points(Vec<Template>),
}
