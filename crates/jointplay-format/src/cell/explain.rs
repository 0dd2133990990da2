//! Errors of cells and of robots with arms as messages in units of display and degrees.

use jointplay_cell::CellError;
use jointplay_cell::jog::StopReason;
use jointplay_cell::robot::{
    Axis, AxisKind, Branch, BranchSelection, HybridRobot, LimitViolation, OutOfReach,
};
use jointplay_cell::station::teach::TeachError;
use jointplay_cell::wafer::{DroopError, RejectedBranch, SagError, Unreachable};
use jointplay_cell::workcell::Cell;
use jointplay_core::range_fault;

use crate::display_units::DisplayUnits;
use crate::number::number;
use crate::units::deg;

/// The message of an error.
#[must_use]
pub fn explain(error: &CellError, units: DisplayUnits) -> String {
    let with_unit = |value: f64, unit: &str| with_unit(value, unit, units);
    match error {
        CellError::NotPositive { what, value, unit } => {
            format!("{what} is {}, but has to be positive", with_unit(*value, unit))
        }
        CellError::OutOfRange { what, value, min, max, unit } => format!(
            "{what} is {}, but has to lie from {} to {}",
            with_unit(*value, unit),
            with_unit(*min, unit),
            with_unit(*max, unit)
        ),
        CellError::LimitsReversed { what, min, max, unit } => format!(
            "the limits of {what} are {}: least {}, most {}",
            range_fault(*min, *max),
            with_unit(*min, unit),
            with_unit(*max, unit)
        ),
        CellError::NotThin { diameter, thickness, allowed } => format!(
            "the wafer is {} thick and {} wide, but a thin plate of that diameter is at most {} thick",
            units.exact(*thickness),
            units.exact(*diameter),
            units.exact(*allowed)
        ),
        CellError::RetractReach { station, found, reach } => format!(
            "the retract distance of station {station} is {}, but has to be less than the distance of its wafer from the first joint of the arm, {}",
            units.exact(*found),
            units.length(*reach, 3)
        ),
        CellError::StationTilt { station, tilt, max } => format!(
            "station {station} tilts by {:.3}°, but the robot tilts by at most {:.3}°; level the station",
            deg(tilt.angle),
            deg(*max)
        ),
        CellError::Platform(error) => crate::explain::explain(error, units),
        other => other.to_string(),
    }
}

/// An SI value with its unit of messages: that of display for lengths, degrees for angles.
fn with_unit(value: f64, unit: &str, units: DisplayUnits) -> String {
    match unit.strip_prefix("rad") {
        Some(rate) => format!("{}°{rate}", number(deg(value))),
        None if unit == "m" || unit.starts_with("m/") => {
            format!("{}{}", units.exact(value), &unit[1..])
        }
        None => format!("{} {unit}", number(value)).trim_end().to_owned(),
    }
}

/// A position of an axis, to a micrometre or a ten-thousandth of a degree.
#[must_use]
pub fn position(axis: &Axis, value: f64, units: DisplayUnits) -> String {
    match axis.kind {
        AxisKind::Linear => units.length(value, 3),
        AxisKind::Rotary => format!("{:.4}°", deg(value)),
    }
}

/// The message of a violated limit.
#[must_use]
pub fn explain_limit(robot: &HybridRobot, limit: &LimitViolation, units: DisplayUnits) -> String {
    match *limit {
        LimitViolation::Axis { axis, position: value, min, max } => {
            let axis = &robot.axes[axis];
            format!(
                "axis {} at {}, limits {} to {}",
                axis.name,
                position(axis, value, units),
                position(axis, min, units),
                position(axis, max, units)
            )
        }
        LimitViolation::Tilt { angle, max } => {
            format!("tilt of {:.4}°, limit {:.4}°", deg(angle), deg(max))
        }
    }
}

/// The message of a target that the links of an arm do not reach.
#[must_use]
pub fn explain_out_of_reach(reach: &OutOfReach, units: DisplayUnits) -> String {
    format!(
        "out of reach: the links would have to reach {} from their joint, but reach {} to {}; the nearest reachable point is {} away",
        units.length(reach.distance, 3),
        units.bare(reach.min, 3),
        units.length(reach.max, 3),
        units.length(reach.missing(), 3)
    )
}

/// One branch in one line: elbow configuration, and the reason for its selection or rejection.
#[must_use]
pub fn explain_branch(robot: &HybridRobot, branch: &Branch, units: DisplayUnits) -> String {
    let why = match branch.selection {
        BranchSelection::Chosen => format!("chosen, {:.3} s away at top speed", branch.travel_time),
        BranchSelection::OtherConfiguration => {
            "not chosen: the arm would have to pass its stretched or folded position".to_owned()
        }
        BranchSelection::NotNearest => {
            format!("not chosen: farther, {:.3} s at top speed", branch.travel_time)
        }
        BranchSelection::BreaksLimits => {
            let limits: Vec<String> =
                branch.violations.iter().map(|limit| explain_limit(robot, limit, units)).collect();
            format!("not possible: {}", limits.join("; "))
        }
    };
    format!("{}: {why}", branch.configuration)
}

/// The reasons why jogging stops: one line for each limit, or for each elbow configuration of the arm.
#[must_use]
pub fn explain_stopped(cell: &Cell, stopped: &StopReason, units: DisplayUnits) -> Vec<String> {
    let robot = &cell.robot;
    let limits = |broken: &mut dyn Iterator<Item = &LimitViolation>| {
        broken.map(|limit| explain_limit(robot, limit, units)).collect::<Vec<String>>()
    };
    match stopped {
        StopReason::Limits(broken) => limits(&mut broken.iter()),
        StopReason::Unreachable(Unreachable::Limits(branches)) => {
            let rejection = |branch: &RejectedBranch| {
                let why = limits(&mut branch.violations.iter()).join("; ");
                format!("{}: {why}", branch.configuration)
            };
            branches.iter().map(rejection).collect()
        }
        StopReason::Unreachable(Unreachable::OutOfReach(reach)) => {
            vec![explain_out_of_reach(reach, units)]
        }
        StopReason::Unreachable(Unreachable::Robot(error)) => vec![explain(error, units)],
        StopReason::Unreachable(other) => vec![explain_unreachable_pose(robot, other, units)],
        StopReason::Contact(pair) => {
            let [one, other] = pair.map(|one| cell.entity_label(one));
            vec![format!("{one} and {other} would touch")]
        }
    }
}

/// The message of a droop table that does not cover a reach or a load, with a remedy.
#[must_use]
pub fn explain_droop(error: &DroopError, units: DisplayUnits) -> String {
    match error {
        DroopError::Reach { reach, min, max } => format!(
            "the droop table covers a reach from {} to {}, but not {}: measure the droop there, or use the cantilever model",
            units.bare(*min, 3),
            units.length(*max, 3),
            units.length(*reach, 3)
        ),
        DroopError::Load { load, max } => format!(
            "the droop table covers loads from 0 to {1:.3} g, but not {0:.3} g: measure with a larger load, or use the cantilever model",
            load * 1e3,
            max * 1e3
        ),
        other => other.to_string(),
    }
}

/// The message of an unreachable wafer pose; the limits that reject every branch come first.
#[must_use]
pub fn explain_unreachable_pose(
    robot: &HybridRobot,
    error: &Unreachable,
    units: DisplayUnits,
) -> String {
    match error {
        Unreachable::Robot(error) => explain(error, units),
        Unreachable::Droop(error) => explain_droop(error, units),
        Unreachable::Tilt { needed, allowed, residual, threshold } => format!(
            "the platform would have to tilt by {:.4}°, but tilts by at most {:.4}°: a tilt of {:.1} µrad would remain, at most {:.1} µrad are allowed",
            deg(*needed),
            deg(*allowed),
            residual * 1e6,
            threshold * 1e6
        ),
        Unreachable::OutOfReach(out) => explain_out_of_reach(out, units),
        Unreachable::Limits(branches) => explain_rejected(robot, branches, units),
        Unreachable::NotConverged { residual, iterations } => format!(
            "the droop compensation did not converge: a residual of {:.3e} {} remains after {iterations} iterations",
            units.from_meters(*residual),
            units.unit()
        ),
        other => other.to_string(),
    }
}

/// The message of taught points that define no frame, with a remedy.
#[must_use]
pub fn explain_teach(error: &TeachError, units: DisplayUnits) -> String {
    match error {
        TeachError::Noise { found } => {
            format!(
                "the noise of taught points is {}, but has to be positive; omit it if it is not known",
                units.small(*found, 3)
            )
        }
        TeachError::Collinear { spread, min, best } => format!(
            "the taught points deviate from one line by {} (root mean square), but the tilt about it needs more than {}: teach a point off the line, best near {}, {}, {}",
            units.small(*spread, 1),
            units.small(*min, 1),
            units.bare(best.x, 0),
            units.bare(best.y, 0),
            units.bare(best.z, 0)
        ),
        TeachError::Upright { tilt } => format!(
            "the plane of the taught points is upright: its normal is {:.3}° from vertical",
            deg(*tilt)
        ),
        TeachError::NotAbove { rise } => format!(
            "the last slot was taught {} above the first; it must be above it by the pitch of the slots between them",
            units.exact(*rise)
        ),
        other => other.to_string(),
    }
}

/// The message of a wafer that does not rest on its supports.
#[must_use]
pub fn explain_sag(error: &SagError, units: DisplayUnits) -> String {
    match error {
        SagError::Support { what, found, diameter, max } => format!(
            "{what} of {} does not support a wafer of {}: it must be more than 0 and at most {}",
            units.length(*found, 3),
            units.length(*diameter, 3),
            units.length(*max, 3)
        ),
        other => other.to_string(),
    }
}

/// The limits that all branches violate, or else the limits of each branch.
fn explain_rejected(
    robot: &HybridRobot,
    branches: &[RejectedBranch],
    units: DisplayUnits,
) -> String {
    let listed = |limits: &mut dyn Iterator<Item = &LimitViolation>| {
        limits.map(|limit| explain_limit(robot, limit, units)).collect::<Vec<_>>().join("; and ")
    };
    let of_first = branches.iter().take(1).flat_map(|branch| &branch.violations);
    let mut common = of_first.filter(|limit| {
        branches.iter().all(|branch| branch.violations.iter().any(|other| is_same(limit, other)))
    });
    let always = listed(&mut common);
    if !always.is_empty() {
        return always;
    }
    let each = |branch: &RejectedBranch| {
        let limits = listed(&mut branch.violations.iter());
        format!("{}: {limits}", branch.configuration)
    };
    branches.iter().map(each).collect::<Vec<_>>().join("; or, ")
}

/// Whether two branches violate the same limit by the same amount.
fn is_same(one: &LimitViolation, other: &LimitViolation) -> bool {
    match (one, other) {
        (
            LimitViolation::Axis { axis: a, position: one, .. },
            LimitViolation::Axis { axis: b, position: other, .. },
        ) => a == b && (one - other).abs() < 1e-9,
        (LimitViolation::Tilt { .. }, LimitViolation::Tilt { .. }) => true,
        _ => false,
    }
}

/// An angle by which to level a station, and the part that compensates the deflection of the arms (°).
pub(crate) fn leveling_angle(by: f64, for_arms: f64) -> String {
    // Rounded up: a correction by less would not suffice.
    let [by, for_arms] = [by, for_arms].map(|angle| (angle * 1e3).ceil() * 1e-3);
    let arms = if for_arms > 1e-3 {
        format!(", {for_arms:.3}° of which compensate the deflection of the loaded arms")
    } else {
        String::new()
    };
    format!("{by:.3}°{arms}")
}
