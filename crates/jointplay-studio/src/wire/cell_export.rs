//! Requests for exports of the motion of a program.

use std::collections::BTreeMap;

use serde::Deserialize;
use utoipa::ToSchema;

use super::program_parameters::ParameterValue;
use super::sampling_rate::sampling_rate;
use crate::problem::Problem;

/// A cell and a program, and the file to be made of their motion.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CellExportRequest {
    /// Text of the cell; default: that of the file.
    #[serde(default)]
    pub(crate) cell: Option<String>,
    /// Text of the program; default: that of the file.
    #[serde(default)]
    pub(crate) program: Option<String>,
    /// Values of parameters of the program.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) parameters: BTreeMap<String, ParameterValue>,
    /// Format of the file.
    pub(crate) format: CellExportFormat,
    /// Dialect of the controller text, by its name.
    #[serde(default)]
    pub(crate) dialect: Option<String>,
    /// Sampling rate of tables, scenes and dialects with points (Hz).
    #[serde(default = "default_rate")]
    #[schema(required = false, default = 100.0, minimum = 0.1, maximum = 100000)]
    pub(crate) rate_hz: f64,
    /// Whether a program with violations is exported; name and contents of the file then contain a warning. Reports are always exported.
    #[serde(default)]
    pub(crate) despite_errors: bool,
}

/// Format of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum CellExportFormat {
    /// Samples as comma-separated values, as from `jointplay cell export --to csv`.
    Csv,
    /// Animated 3D scene as binary glTF.
    Gltf,
    /// Controller text in a dialect.
    Text,
    /// Report as one page of HTML, as from `jointplay cell report`.
    Report,
}

fn default_rate() -> f64 {
    100.0
}

impl CellExportRequest {
    /// The sampling rate, checked (Hz).
    pub(crate) fn rate(&self) -> Result<f64, Problem> {
        sampling_rate(self.rate_hz, 100_000.0)
    }
}
