//! Requests for samples of the motion of a program.

use std::collections::BTreeMap;

use serde::Deserialize;
use utoipa::ToSchema;

use super::program_parameters::ParameterValue;
use super::sampling_rate::sampling_rate;
use crate::problem::Problem;

/// A cell and a program, and the samples of their motion.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SamplesRequest {
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
    /// Sampling rate (Hz).
    #[serde(default = "default_rate")]
    #[schema(required = false, default = 25.0, minimum = 0.1, maximum = 10000)]
    pub(crate) rate_hz: f64,
    /// Additional samples at extrema of velocities and at kinks of accelerations, so that linear interpolation reproduces the motion.
    #[serde(default)]
    pub(crate) peaks: bool,
    /// Start of the time range; default: start of the motion (s).
    #[serde(default)]
    pub(crate) from_s: Option<f64>,
    /// End of the time range; default: end of the motion (s).
    #[serde(default)]
    pub(crate) to_s: Option<f64>,
    /// Columns by name or group, as for `jointplay cell export --columns`; default: those of `jointplay cell run`.
    #[serde(default)]
    #[schema(min_items = 1)]
    pub(crate) columns: Option<Vec<String>>,
}

fn default_rate() -> f64 {
    25.0
}

impl SamplesRequest {
    /// Refuses an empty list of columns, of which no table can be made.
    pub(crate) fn check_columns(&self) -> Result<(), Problem> {
        match &self.columns {
            Some(columns) if columns.is_empty() => {
                Err(Problem::field("columns", "name at least one column, or omit `columns`"))
            }
            _ => Ok(()),
        }
    }

    /// The sampling rate, checked (Hz).
    pub(crate) fn rate(&self) -> Result<f64, Problem> {
        sampling_rate(self.rate_hz, 10_000.0)
    }
}
