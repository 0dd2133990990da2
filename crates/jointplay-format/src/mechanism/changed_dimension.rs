//! A mechanism file with other values of a parameter, for derivatives by that parameter.

use jointplay_core::mechanism::{ChangedDimension, Mechanism};

use super::problem::Errors;
use super::read::{MechanismFile, parse_with};
use crate::number::number;

/// A step, as a share of the value of a parameter: central differences of fourth order are exact to 10⁻¹² then.
const STEP: f64 = 1.0 / 4096.0;
/// The least value that steps are a share of, as a share of the size of the mechanism.
const LEAST_VALUE: f64 = 1e-3;

/// Why a file has no derivative by a parameter.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "parameter `{parameter}` cannot be changed from {} to {}, so that there is no derivative: {errors}",
    number(*value),
    number(*changed)
)]
pub struct ParameterError {
    /// The parameter.
    pub parameter: String,
    /// Its value, in the units of the file.
    pub value: f64,
    /// The value for which the file is invalid, in the units of the file.
    pub changed: f64,
    /// Errors of the file with that value.
    pub errors: Errors,
}

/// The mechanism of a file with values of a parameter near its own; a step is in the units of the file.
///
/// # Arguments
/// * `file` – as read from the text with the same replaced values
/// * `replaced` – names of parameters of the file, and their values in the units of the file
/// * `parameter` – its name and its value
///
/// # Errors
/// [`ParameterError`] where the file is invalid with another value.
pub fn changed_dimension(
    file: &MechanismFile,
    text: &str,
    replaced: &[(String, f64)],
    (parameter, value): (&str, f64),
) -> Result<ChangedDimension, ParameterError> {
    let step = STEP * scale(file, value);
    let with = |steps: f64| -> Result<Mechanism, ParameterError> {
        let changed = value + steps * step;
        let mut all: Vec<(String, f64)> = replaced.to_vec();
        all.retain(|(name, _)| name != parameter);
        all.push((parameter.to_owned(), changed));
        let parameter = parameter.to_owned();
        parse_with(text, &all).map(|file| file.mechanism).map_err(|errors| ParameterError {
            parameter,
            value,
            changed,
            errors,
        })
    };
    Ok(ChangedDimension { mechanisms: [with(-2.0)?, with(-1.0)?, with(1.0)?, with(2.0)?], step })
}

/// Scale of steps: the value, or for values near zero one unit or the size of the mechanism.
fn scale(file: &MechanismFile, value: f64) -> f64 {
    let frames = file.mechanism.joints().iter().flat_map(|joint| &joint.frames);
    let reach = frames.map(|frame| frame.translation.vector.norm()).fold(0.0, f64::max);
    let reach = file.units.length.from_meters(reach);
    let size = if reach > 0.0 { reach.min(1.0) } else { 1.0 };
    if value == 0.0 { size } else { value.abs().max(LEAST_VALUE * size) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::parse;

    const SAMPLE: &str = include_str!("sample.toml");

    #[test]
    fn a_parameter_changes_the_frames_that_depend_on_it() {
        let file = parse(SAMPLE).unwrap();
        let changed = changed_dimension(&file, SAMPLE, &[], ("a", 220.0)).unwrap();
        assert_eq!(changed.step, 220.0 / 4096.0);
        for (mechanism, steps) in changed.mechanisms.iter().zip([-2.0, -1.0, 1.0, 2.0]) {
            let half = (220.0 + steps * changed.step) / 2e3;
            let found = mechanism.joints()[0].frames[0].translation.x;
            assert!((found - half).abs() < 1e-15, "{found}");
        }
        // A parameter that other values replace keeps them in the others.
        let replaced = [("a".to_owned(), 100.0), ("half".to_owned(), 7.0)];
        let file = parse_with(SAMPLE, &replaced).unwrap();
        let changed = changed_dimension(&file, SAMPLE, &replaced, ("a", 100.0)).unwrap();
        assert_eq!(changed.mechanisms[3].joints()[0].frames[0].translation.x, 0.007);
    }

    #[test]
    fn a_value_at_the_end_of_its_range_has_no_derivative() {
        let text = SAMPLE.replacen("[parameters]", "[parameters]\nedge = 0", 1).replacen(
            "point = [\"half\", 0,",
            "point = [\"half + sqrt(edge)\", 0,",
            1,
        );
        let file = parse(&text).unwrap();
        let refused = changed_dimension(&file, &text, &[], ("edge", 0.0)).unwrap_err();
        assert!(refused.to_string().starts_with("parameter `edge` cannot be changed from 0 to -"));
        assert!(refused.changed < 0.0);
    }
}
