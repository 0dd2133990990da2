//! Values of a program's parameters in requests.

use std::collections::BTreeMap;

use jointplay::format::program::{self, Setting};
use serde::Deserialize;
use utoipa::ToSchema;

use crate::problem::Problem;

/// Value of a parameter of a program.
#[derive(Debug, Clone, PartialEq, Deserialize, ToSchema)]
#[serde(untagged, expecting = "expected a number or a text, such as 5 or \"5 mm\"")]
pub(crate) enum ParameterValue {
    /// A number without unit.
    Number(f64),
    /// A number, with the unit of the parameter if it has one, such as `5 mm`.
    Text(String),
}

/// The text of a program with values of its parameters.
pub(crate) fn with_parameters(
    program: String,
    parameters: BTreeMap<String, ParameterValue>,
) -> Result<String, Problem> {
    if parameters.is_empty() {
        return Ok(program);
    }
    let setting = |(name, value): (String, ParameterValue)| {
        let value = match value {
            ParameterValue::Number(number) => number.to_string(),
            ParameterValue::Text(text) => text,
        };
        Setting { name, value }
    };
    let settings: Vec<Setting> = parameters.into_iter().map(setting).collect();
    program::with_parameters(&program, &settings).map_err(|errors| {
        let messages: Vec<String> = errors.iter().map(ToString::to_string).collect();
        Problem::field("parameters", messages.join("; "))
    })
}
