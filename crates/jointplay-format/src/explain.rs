//! Errors of the core as messages in mm and degrees.

use jointplay_core::gpr::{BrokenLimit, NotThreeRods};
use jointplay_core::linalg::LinalgError;
use jointplay_core::mechanism::Unassembled;
use jointplay_core::{Error, range_fault};

use crate::mechanism::Units;
use crate::number::{number, rounded};
use crate::units;

/// A length of a message in mm, from metres.
fn mm(meters: f64) -> String {
    number(units::mm(meters))
}

/// An angle of a message in degrees, from radians.
fn deg(radians: f64) -> String {
    number(units::deg(radians))
}

/// Why a mechanism of this name becomes no three-rod robot, in mm and degrees.
#[must_use]
pub fn explain_recognition(name: &str, error: &NotThreeRods) -> String {
    let reason = match error {
        NotThreeRods::NotParallel { joint, angle } => format!(
            "joint {joint:?} is inclined by {}° to the first rod, but rods are parallel",
            rounded(angle.to_degrees(), 6)
        ),
        NotThreeRods::UnequalLimits { joint, min, max } => format!(
            "the rod of joint {joint:?} has limits from {} to {} mm, but the first has others: all rods need the same",
            rounded(units::mm(*min), 6),
            rounded(units::mm(*max), 6)
        ),
        // Its joints are those of such a robot.
        NotThreeRods::Dimensions(error) => return explain(error),
        _ => error.to_string(),
    };
    format!("{name} is not a three-rod robot: {reason}")
}

/// The message of loops that could not be closed, in the units of a mechanism file.
#[must_use]
pub fn explain_unassembled(found: &Unassembled, units: Units) -> String {
    found.message(|distance, angle| {
        format!(
            "{} {} and {} {}",
            rounded(units.length.from_meters(distance), 4),
            units.length.name(),
            rounded(units.angle.from_radians(angle), 4),
            units.angle.name()
        )
    })
}

/// The message of an error, in mm and degrees.
#[must_use]
pub fn explain(error: &Error) -> String {
    match error {
        Error::NotPositive { what, limb, value } => {
            format!("{what} of limb {limb} is {} mm, but has to be positive", mm(*value))
        }
        Error::LimitsReversed { what, min, max } => {
            let fault = range_fault(*min, *max);
            format!("the {what} limits are {fault}: least {} mm, most {} mm", mm(*min), mm(*max))
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
        Error::TiltTooLarge { tilt_angle } => {
            format!("the tilt angle is {}°, but has to lie between -90° and 90°", deg(*tilt_angle))
        }
        Error::NotConverged(unconverged) => format!(
            "the {} iteration for the virtual joints did not converge in {} steps: the best sides deviate by {} mm, at most {} mm are allowed\n  best virtual joints (m, rad): {}",
            unconverged.solver,
            unconverged.iterations,
            rounded(units::mm(unconverged.residual), 4),
            rounded(units::mm(unconverged.threshold), 4),
            unconverged.best.iter().map(|&one| rounded(one, 6)).collect::<Vec<_>>().join(", "),
        ),
        Error::DependentSides { characteristic_length, iterations } => format!(
            "the virtual joints cannot change the three sides independently after {iterations} iterations; the characteristic length of {} mm may weigh angles too lightly or too heavily",
            rounded(units::mm(*characteristic_length), 6)
        ),
        Error::NotFinite { what, value } => {
            format!("{what} is {}, but has to be a finite number", number(*value))
        }
        Error::Linalg(LinalgError::NotFinite { value }) => {
            format!("an entry of the matrix is {}, but has to be a finite number", number(*value))
        }
        Error::Collinear { what, height_to_base, allowed } => format!(
            "the three {what} lie on one line: their triangle is {} times as high as it is long, at least {} is needed",
            rounded(*height_to_base, 3),
            number(*allowed)
        ),
        Error::NotClosed { residual, allowed } => format!(
            "the configuration breaks the constraints: scaled residual {}, at most {} is allowed; close the loops first",
            rounded(*residual, 3),
            number(*allowed)
        ),
        Error::NotAssembled(found) => explain_unassembled(found, Units::MM),
        other => other.to_string(),
    }
}

/// The message of a violated limit, in mm and degrees.
#[must_use]
pub fn explain_limit(limit: &BrokenLimit) -> String {
    match limit {
        BrokenLimit::Rod { limb, length, min, max } => {
            let (min, max) = (units::mm(*min), units::mm(*max));
            let length = beyond(units::mm(*length), min, max);
            let (min, max) = (number(min), number(max));
            format!("rod {limb} is {length} mm long, its limits are {min} to {max} mm")
        }
        BrokenLimit::Tilt { angle: tilt_angle, max } => {
            let max = units::deg(*max);
            let tilt_angle = beyond(units::deg(*tilt_angle), 0.0, max);
            format!("the tilt is {tilt_angle}°, its limit is {}°", number(max))
        }
    }
}

/// A number with six decimals, or with all digits where rounding would hide that it is out of its limits.
pub fn beyond(value: f64, min: f64, max: f64) -> String {
    if value.abs() >= 1e7 {
        return number(value);
    }
    let short = format!("{value:.6}");
    let hides = short.parse().is_ok_and(|shown: f64| (min..=max).contains(&shown));
    if hides { format!("{value}") } else { short }
}
