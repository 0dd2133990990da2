//! Errors of the core, said in the units that people use.

use jointplay_core::Error;
use jointplay_core::gpr::BrokenLimit;

use crate::units::{deg, mm};

/// What went wrong, in mm and degrees.
#[must_use]
pub fn explain(error: &Error) -> String {
    match error {
        Error::NotPositive { what, limb, value } => {
            format!("{what} of limb {limb} is {} mm, but has to be positive", mm(*value))
        }
        Error::LimitsReversed { what, min, max } => {
            format!("the {what} limits are reversed: least {} mm, most {} mm", mm(*min), mm(*max))
        }
        Error::OutOfRange { what, value, min, max, unit: "rad" } => {
            format!(
                "the {what} is {}°, but has to lie between {}° and {}°",
                deg(*value),
                deg(*min),
                deg(*max)
            )
        }
        Error::OutOfRange { what, value, min, max, .. } => {
            format!(
                "the {what} is {} mm, but has to lie from {} to {} mm",
                mm(*value),
                mm(*min),
                mm(*max)
            )
        }
        Error::BeyondLimits(broken) => {
            let limits: Vec<String> = broken.iter().map(|limit| explain_limit(&limit)).collect();
            format!("the pose is beyond the robot's limits: {}", limits.join("; "))
        }
        Error::PitchTooLarge { pitch } => {
            format!("the pitch is {}°, but has to lie between -90° and 90°", deg(*pitch))
        }
        Error::NotConverged(unconverged) => format!(
            "the {} iteration for the virtual joints did not converge in {} steps: at best the sides are {:.3e} mm off, {:.3e} mm is asked for\n  best virtual joints (m, rad): {:?}",
            unconverged.solver,
            unconverged.iterations,
            mm(unconverged.residual),
            mm(unconverged.threshold),
            unconverged.best,
        ),
        Error::DependentSides { characteristic_length, iterations } => format!(
            "the virtual joints cannot change the three sides independently where the iteration stands after {iterations} steps; the characteristic length of {} mm may weigh angles too lightly or too heavily",
            mm(*characteristic_length)
        ),
        other => other.to_string(),
    }
}

/// A broken limit, in mm and degrees.
#[must_use]
pub fn explain_limit(limit: &BrokenLimit) -> String {
    match limit {
        BrokenLimit::Rod { limb, length, min, max } => {
            let (min, max) = (mm(*min), mm(*max));
            let length = beyond(mm(*length), min, max);
            format!("rod {limb} is {length} mm long, allowed are {min} to {max} mm")
        }
        BrokenLimit::Tilt { pitch, max } => {
            let max = deg(*max);
            format!("the tilt is {}°, allowed is up to {max}°", beyond(deg(*pitch), 0.0, max))
        }
    }
}

/// A number to six decimals, or with all its digits where six would round it back into its limits.
fn beyond(value: f64, min: f64, max: f64) -> String {
    let short = format!("{value:.6}");
    let hides = short.parse().is_ok_and(|shown: f64| (min..=max).contains(&shown));
    if hides { format!("{value}") } else { short }
}
