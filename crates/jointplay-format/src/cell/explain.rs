//! Faults and limits of robots with arms, said in mm and degrees.

use jointplay_cell::CellError;
use jointplay_cell::jog::Stopped;
use jointplay_cell::robot::{
    Axis, AxisKind, Branch, BranchSelection, HybridRobot, Inverse, LimitViolation, OutOfReach,
};
use jointplay_cell::wafer::{RejectedBranch, Unreachable};
use jointplay_cell::workcell::Cell;

use crate::number::number;
use crate::units::{deg, mm};

/// What went wrong, in mm and degrees.
#[must_use]
pub fn explain(error: &CellError) -> String {
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
            "the limits of {what} are reversed: least {}, most {}",
            with_unit(*min, unit),
            with_unit(*max, unit)
        ),
        CellError::Platform(error) => crate::explain::explain(error),
        other => other.to_string(),
    }
}

/// A number in SI with the unit that people use.
fn with_unit(value: f64, unit: &str) -> String {
    match unit.strip_prefix("rad") {
        Some(rate) => format!("{}°{rate}", number(deg(value))),
        None if unit == "m" || unit.starts_with("m/") => {
            format!("{} m{unit}", number(mm(value)))
        }
        None => format!("{} {unit}", number(value)).trim_end().to_owned(),
    }
}

/// A position of an axis, to a micrometre or a ten-thousandth of a degree.
#[must_use]
pub fn position(axis: &Axis, value: f64) -> String {
    match axis.kind {
        AxisKind::Linear => format!("{:.3} mm", mm(value)),
        AxisKind::Rotary => format!("{:.4}°", deg(value)),
    }
}

/// A broken limit, with its numbers.
#[must_use]
pub fn explain_limit(robot: &HybridRobot, limit: &LimitViolation) -> String {
    match *limit {
        LimitViolation::Axis { axis, position: value, min, max } => {
            let axis = &robot.axes[axis];
            format!(
                "axis {} would stand at {}, allowed are {} to {}",
                axis.name,
                position(axis, value),
                position(axis, min),
                position(axis, max)
            )
        }
        LimitViolation::Tilt { pitch, max } => {
            format!("the tilt is {:.4}°, allowed is up to {:.4}°", deg(pitch), deg(max))
        }
    }
}

/// Why links do not span the distance to a target.
#[must_use]
pub fn explain_out_of_reach(reach: &OutOfReach) -> String {
    let (distance, min, max) = (mm(reach.distance), mm(reach.min), mm(reach.max));
    format!(
        "out of reach: the links would have to span {distance:.3} mm, but span {min:.3} to {max:.3} mm; the nearest place is {:.3} mm away",
        mm(reach.missing())
    )
}

/// One branch in one line: how the arm is bent, and why it is taken or not.
#[must_use]
pub fn explain_branch(robot: &HybridRobot, branch: &Branch) -> String {
    let why = match branch.standing {
        BranchSelection::Chosen => format!("chosen, {:.3} s away at top speed", branch.distance),
        BranchSelection::OtherElbow => {
            "not chosen: the arm would have to pass its stretched or folded position".to_owned()
        }
        BranchSelection::NotNearest => {
            format!("not chosen: farther, {:.3} s at top speed", branch.distance)
        }
        BranchSelection::BreaksLimits => {
            let limits: Vec<String> =
                branch.broken.iter().map(|limit| explain_limit(robot, limit)).collect();
            format!("not possible: {}", limits.join("; "))
        }
    };
    format!("{}: {why}", branch.configuration)
}

/// Why there is no branch to take, in one line; `None` where there is one.
#[must_use]
pub fn explain_unreachable(robot: &HybridRobot, inverse: &Inverse) -> Option<String> {
    if inverse.chosen.is_some() {
        return None;
    }
    let reach = inverse.out_of_reach.iter().map(explain_out_of_reach);
    let plane = inverse.broken_by_plane.iter().filter(|_| inverse.branches.is_empty());
    let plane = plane.map(|limit| explain_limit(robot, limit));
    let branches = inverse.branches.iter().map(|branch| explain_branch(robot, branch));
    Some(reach.chain(plane).chain(branches).collect::<Vec<_>>().join("; "))
}

/// What stops a robot that is moved by hand: one line for each limit, or for each way that the arm could be bent.
#[must_use]
pub fn explain_stopped(cell: &Cell, stopped: &Stopped) -> Vec<String> {
    let robot = &cell.robot;
    let limits = |broken: &mut dyn Iterator<Item = &LimitViolation>| {
        broken.map(|limit| explain_limit(robot, limit)).collect::<Vec<String>>()
    };
    match stopped {
        Stopped::Limits(broken) => limits(&mut broken.iter()),
        Stopped::Place(Unreachable::Limits(ways)) => {
            let told = |way: &RejectedBranch| {
                let why = limits(&mut way.broken.iter().map(|(_, limit)| limit)).join("; ");
                format!("{}: {why}", way.configuration)
            };
            ways.iter().map(told).collect()
        }
        Stopped::Place(Unreachable::OutOfReach(reach)) => vec![explain_out_of_reach(reach)],
        Stopped::Place(Unreachable::Robot(error)) => vec![explain(error)],
        Stopped::Place(other) => vec![other.to_string()],
        Stopped::Contact(pair) => {
            let [one, other] = pair.map(|one| cell.entity_name(one));
            vec![format!("{one} and {other} would touch")]
        }
    }
}
