//! Errors of the core as messages in units of display and degrees.

use jointplay_core::gpr::{BrokenLimit, NotThreeRods};
use jointplay_core::linalg::LinalgError;
use jointplay_core::mechanism::Unassembled;
use jointplay_core::{Error, range_fault};

use crate::display_units::DisplayUnits;
use crate::mechanism::{LengthUnit, Units};
use crate::number::{number, rounded};
use crate::units;

/// An angle of a message in degrees, from radians.
fn deg(radians: f64) -> String {
    number(units::deg(radians))
}

/// Why a mechanism of this name becomes no three-rod robot.
#[must_use]
pub fn explain_recognition(name: &str, error: &NotThreeRods, units: DisplayUnits) -> String {
    let reason = match error {
        NotThreeRods::NotParallel { joint, angle } => format!(
            "joint {joint:?} is inclined by {}° to the first rod, but rods are parallel",
            rounded(angle.to_degrees(), 6)
        ),
        NotThreeRods::UnequalLimits { joint, min, max } => format!(
            "the rod of joint {joint:?} has limits from {} to {}, but the first has others: all rods need the same",
            rounded(units.from_meters(*min), 6),
            units.significant(*max, 6)
        ),
        // Its joints are those of such a robot.
        NotThreeRods::Dimensions(error) => return explain(error, units),
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

/// The message of an error.
#[must_use]
pub fn explain(error: &Error, units: DisplayUnits) -> String {
    let length = |meters: f64| units.exact(meters);
    match error {
        Error::NotPositive { what, limb, value } => {
            format!("{what} of limb {limb} is {}, but has to be positive", length(*value))
        }
        Error::LimitsReversed { what, min, max } => {
            let fault = range_fault(*min, *max);
            format!("the {what} limits are {fault}: least {}, most {}", length(*min), length(*max))
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
                "the {what} is {}, but has to lie from {} to {}",
                length(*value),
                units.number(*min),
                length(*max)
            )
        }
        Error::BeyondLimits(broken) => {
            let limits: Vec<String> =
                broken.iter().map(|limit| explain_limit(&limit, units)).collect();
            format!("the pose is beyond the robot's limits: {}", limits.join("; "))
        }
        Error::TiltTooLarge { tilt_angle } => {
            format!("the tilt angle is {}°, but has to lie between -90° and 90°", deg(*tilt_angle))
        }
        Error::NotConverged(unconverged) => format!(
            "the {} iteration for the virtual joints did not converge in {} steps: the best sides deviate by {}, at most {} are allowed\n  best virtual joints (m, rad): {}",
            unconverged.solver,
            unconverged.iterations,
            units.significant(unconverged.residual, 4),
            units.significant(unconverged.threshold, 4),
            unconverged.best.iter().map(|&one| rounded(one, 6)).collect::<Vec<_>>().join(", "),
        ),
        Error::DependentSides { characteristic_length, iterations } => format!(
            "the virtual joints cannot change the three sides independently after {iterations} iterations; the characteristic length of {} may weigh angles too lightly or too heavily",
            units.significant(*characteristic_length, 6)
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
        Error::NotAssembled(found) => {
            let length = match units {
                DisplayUnits::Metric => LengthUnit::Millimeter,
                DisplayUnits::Imperial => LengthUnit::Inch,
            };
            explain_unassembled(found, Units { length, ..Units::MM })
        }
        other => other.to_string(),
    }
}

/// The message of a violated limit.
#[must_use]
pub fn explain_limit(limit: &BrokenLimit, units: DisplayUnits) -> String {
    match limit {
        BrokenLimit::Rod { limb, length, min, max } => {
            let bounds = [*min, *max].map(|meters| units.from_meters(meters));
            let length = beyond(units.from_meters(*length), bounds[0], bounds[1]);
            let unit = units.unit();
            let (min, max) = (units.number(*min), units.exact(*max));
            format!("rod {limb} is {length} {unit} long, its limits are {min} to {max}")
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
