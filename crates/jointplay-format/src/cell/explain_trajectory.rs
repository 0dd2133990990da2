//! Errors of trajectories as messages in units of display and degrees.

use jointplay_cell::program::Phase;
use jointplay_cell::robot::HybridRobot;
use jointplay_cell::trajectory::{PathError, PathErrorKind, StepError, StepErrorKind};

use super::explain::{explain_unreachable_pose, position};
use crate::display_units::DisplayUnits;
use crate::units::deg;

/// Remedy for a line of `MOVE LINE` that the robot cannot follow.
const MOVE_REMEDY: &str = "shorten the line, start it in another posture, or move the axes instead";
/// Remedy for a line into or out of a station that the robot cannot follow.
const STATION_REMEDY: &str = "change the radius of the station, `retract_mm`, the heading (`heading_deg`, `approach`) or the posture at the start of the line, or move the axes instead";

/// The message of a step without a trajectory, with a remedy.
#[must_use]
pub fn explain_step(robot: &HybridRobot, error: &StepError, units: DisplayUnits) -> String {
    match &error.kind {
        StepErrorKind::NotContinuous { axis, start, previous_end } => {
            let axis = &robot.axes[*axis];
            format!(
                "axis {} starts at {}, but the previous step ends at {}: each step must start where the previous one ends",
                axis.name,
                position(axis, *start, units),
                position(axis, *previous_end, units)
            )
        }
        StepErrorKind::Path(path) => {
            let remedy = if error.phase == Phase::Move { MOVE_REMEDY } else { STATION_REMEDY };
            explain_path(robot, path, remedy, units)
        }
        StepErrorKind::TooLong { step, allowed, .. } if step > allowed => format!(
            "this motion alone takes {step:.0} s, but a program may take at most {allowed:.0} s (one day): raise SPEED, or the velocity, acceleration and jerk limits of the axes that move"
        ),
        StepErrorKind::TooLong { end, allowed, .. } => format!(
            "the program takes {end:.0} s up to the end of this motion, but may take at most {allowed:.0} s (one day): raise SPEED or the limits, shorten WAIT, or divide the program"
        ),
        other => other.to_string(),
    }
}

/// The message of a Cartesian line that the axes cannot follow, with a remedy.
fn explain_path(
    robot: &HybridRobot,
    error: &PathError,
    remedy: &str,
    units: DisplayUnits,
) -> String {
    let share = 100.0 * error.fraction;
    let position_on_line = error.position.map_or_else(String::new, |position| {
        let [x, y, z] = [position.x, position.y, position.z].map(|value| units.bare(value, 1));
        format!(", at x {x}, y {y}, z {z} {}", units.unit())
    });
    let why = match &error.kind {
        PathErrorKind::Pose(error) => explain_unreachable_pose(robot, error, units),
        PathErrorKind::Singular => format!(
            "the arm is in a singular position, in which the effector cannot follow the line in all directions; {remedy}"
        ),
        PathErrorKind::NotReached { distance, tilt, heading } => {
            let heading = heading
                .map_or_else(String::new, |heading| format!(", {:.2}° of heading", deg(heading)));
            format!(
                "the effector does not reach the line: {}, {:.3} mrad of tilt{heading} are missing; {remedy}",
                units.length(*distance, 3),
                tilt * 1e3
            )
        }
        PathErrorKind::GoalOnOtherBranch { axis, difference } => {
            let axis = &robot.axes[*axis];
            format!(
                "the line ends on another branch of the arm than required: axis {} differs by {}; {remedy}",
                axis.name,
                position(axis, *difference, units)
            )
        }
        PathErrorKind::Discontinuity => {
            format!("the axes jump from one branch of the arm to another; {remedy}")
        }
        PathErrorKind::NotConverged { deviation, points } => format!(
            "the wafer deviates by {} from the line with {points} points: the line passes too close to a singular position; {remedy}",
            units.length(*deviation, 3)
        ),
        other => other.to_string(),
    };
    format!("{share:.1} % along the line{position_on_line}: {why}")
}
