//! Steps without a trajectory, in mm and degrees.

use jointplay_cell::robot::HybridRobot;
use jointplay_cell::trajectory::{PathError, PathErrorKind, StepError, StepErrorKind};

use super::explain::{explain_unreachable_pose, position};
use crate::units::{deg, mm};

/// What to change where a Cartesian line cannot be followed.
const REMEDY: &str = "change the radius of the station, `retract_mm`, the heading (`yaw_deg`, `approach`) or the posture at the start of the line, or move the axes instead";

/// Why a step has no trajectory, and what to change.
#[must_use]
pub fn explain_step(robot: &HybridRobot, error: &StepError) -> String {
    match &error.kind {
        StepErrorKind::NotContinuous { axis, start, previous_end } => {
            let axis = &robot.axes[*axis];
            format!(
                "axis {} starts at {}, but the step before ends at {}: steps have to join",
                axis.name,
                position(axis, *start),
                position(axis, *previous_end)
            )
        }
        StepErrorKind::Path(error) => explain_path(robot, error),
        StepErrorKind::TooLong { step, allowed, .. } if step > allowed => format!(
            "this motion alone takes {step:.0} s, but a program takes at most {allowed:.0} s, a day: raise the velocity, acceleration and jerk limits of the axes that move, or SPEED"
        ),
        StepErrorKind::TooLong { end, allowed, .. } => format!(
            "the program takes {end:.0} s up to the end of this motion, but at most {allowed:.0} s, a day, are allowed: raise limits or SPEED, wait for a shorter time, or divide the program"
        ),
        other => other.to_string(),
    }
}

/// Why the axes cannot follow a Cartesian line, and what to change.
#[must_use]
pub fn explain_path(robot: &HybridRobot, error: &PathError) -> String {
    let share = 100.0 * error.share;
    let position_on_line = error.position.map_or_else(String::new, |position| {
        let [x, y, z] = [position.x, position.y, position.z].map(mm);
        format!(", at x {x:.1}, y {y:.1}, z {z:.1} mm")
    });
    let why = match &error.kind {
        PathErrorKind::Pose(error) => explain_unreachable_pose(robot, error),
        PathErrorKind::Singular => format!(
            "the arm is in a singular position, in which the effector cannot follow the line in all directions; {REMEDY}"
        ),
        PathErrorKind::NotReached { distance, tilt, heading } => {
            let heading = heading
                .map_or_else(String::new, |heading| format!(", {:.2}° of heading", deg(heading)));
            format!(
                "the effector does not reach the line: {:.3} mm, {:.3} mrad of tilt{heading} are missing; {REMEDY}",
                mm(*distance),
                tilt * 1e3
            )
        }
        PathErrorKind::OtherBranch { axis, difference } => {
            let axis = &robot.axes[*axis];
            format!(
                "the line leads to another branch of the arm than that of its end, axis {} differs by {}; {REMEDY}",
                axis.name,
                position(axis, *difference)
            )
        }
        PathErrorKind::BranchJump => {
            format!("the axes jump from one branch of the arm to another; {REMEDY}")
        }
        PathErrorKind::NotConverged { deviation, points } => format!(
            "the wafer deviates by {:.3} mm from the line with {points} points: the line passes too near a singular position; {REMEDY}",
            mm(*deviation)
        ),
        other => other.to_string(),
    };
    format!("{share:.1} % along the line{position_on_line}: {why}")
}
