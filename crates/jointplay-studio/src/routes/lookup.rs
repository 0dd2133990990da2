//! What several endpoints look up in a request or a plan or compute, and the problems they share.

use std::ops::ControlFlow;

use axum::http::StatusCode;
use jointplay::cell::robot::EffectorId;
use jointplay::cell::station::SlotId;
use jointplay::cell::trajectory::Trajectory;
use jointplay::cell::workcell::Cell;
use jointplay::cell::{CellError, Interrupted, StopRequested};
use jointplay::format::cell::explain;
use jointplay::interop::export::MotionExport;
use jointplay::mechanism::{DrivePath, DrivenMotion, Mechanism, drive_from};
use jointplay::nalgebra::DVector;

use crate::display::display_units;
use crate::plan::{Plan, rest_at_home};
use crate::problem::Problem;
use crate::wire::cell_jog::SlotFields;

pub(super) fn interrupted(_: Interrupted) -> Problem {
    let detail = "the computation was cancelled: the client has disconnected, or the server is shutting down";
    Problem::unavailable(StatusCode::SERVICE_UNAVAILABLE, detail)
}

/// A motion of a mechanism along a path, until the client disconnects.
pub(super) fn driven(
    mechanism: &Mechanism,
    from: &DVector<f64>,
    path: &DrivePath,
    held: &[usize],
    steps: usize,
    stop: StopRequested<'_>,
) -> Result<DrivenMotion, Problem> {
    let mut progress = |_| if stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    drive_from(mechanism, from, path, held, steps, None, &mut progress).map_err(|error| match error
    {
        jointplay::Error::Interrupted => interrupted(Interrupted),
        other => other.into(),
    })
}

pub(super) fn no_motion(plan: &Plan) -> String {
    match plan.diagnostics.first() {
        Some(first) => format!("the plan has no motion: line {}: {}", first.line, first.message),
        None => "the program contains no motion (all axes stay at home)".to_owned(),
    }
}

/// The problem of an unknown key of a plan, window or scene.
pub(super) fn unknown_key() -> Problem {
    let detail = "unknown key: the server keeps the last plans only; plan the texts again";
    Problem::request(StatusCode::NOT_FOUND, detail)
}

/// The motion of a plan; for a plan without a motion, the robot at home.
///
/// # Errors
/// A cell without a valid robot.
pub(super) fn robot_motion<'p>(
    plan: &'p Plan,
    still: &'p mut Option<Trajectory>,
) -> Result<MotionExport<'p>, Problem> {
    let refused = || Problem::request(StatusCode::CONFLICT, no_motion(plan));
    if let Some(motion_export) = plan.motion_export() {
        return Ok(motion_export);
    }
    let cell = plan.cell.as_ref().ok_or_else(refused)?;
    let motion = still.insert(rest_at_home(cell).ok_or_else(refused)?);
    Ok(MotionExport { cell, motion, program: "", violation_notes: &[] })
}

pub(super) fn cell_error(error: CellError) -> Problem {
    Problem::request(StatusCode::CONFLICT, explain::explain(&error, display_units()))
}

/// The effector with a name; the first one without a name.
pub(super) fn named_effector(
    cell: &Cell,
    name: Option<&str>,
    field: &str,
) -> Result<EffectorId, Problem> {
    let name_of = |id: EffectorId| cell.robot.arms[id.arm].effectors[id.effector].name.as_str();
    let mut effectors = cell.robot.effectors();
    let found = effectors.find(|&id| name.is_none_or(|name| name == name_of(id)));
    found.ok_or_else(|| {
        let known: Vec<&str> = cell.robot.effectors().map(name_of).collect();
        let detail =
            format!("unknown effector {:?}; known: {}", name.unwrap_or(""), known.join(", "));
        Problem::field(field, detail)
    })
}

pub(super) fn named_slot(
    cell: &Cell,
    asked: &SlotFields,
    [of_station, of_slot]: [&str; 2],
) -> Result<SlotId, Problem> {
    let SlotFields { station: name, slot } = asked;
    let Some(station) = cell.stations.iter().position(|station| station.name == *name) else {
        let known: Vec<&str> = cell.stations.iter().map(|one| one.name.as_str()).collect();
        let detail = format!("unknown station {name:?}; known: {}", known.join(", "));
        return Err(Problem::field(of_station, detail));
    };
    if cell.stations[station].has_slot(*slot) {
        return Ok(SlotId { station, slot: *slot });
    }
    let most = cell.stations[station].slots;
    let detail = format!("{name} has no slot {slot}; its slots are 1 to {most}");
    Err(Problem::field(of_slot, detail))
}
