//! `/api/v1/cell/jog`: the robot of the cell, moved by hand.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use jointplay::cell::check::{CheckOptions, Moment, Straight, check_pose, straight_until_contact};
use jointplay::cell::jog::{Jogged, Stopped};
use jointplay::cell::robot::{EffectorId, WaferTarget};
use jointplay::cell::station::SlotId;
use jointplay::cell::trajectory::Trajectory;
use jointplay::cell::wafer::Unreachable;
use jointplay::cell::workcell::Cell;
use jointplay::cell::{CellError, Stop};
use jointplay::format::cell::explain;
use jointplay::format::export::{Recording, frames};
use jointplay::gpr::AxisHeight;

use super::cell::{desk, interrupted, nothing};
use super::cell_parts::forgotten;
use crate::app::App;
use crate::body::Body;
use crate::cell_plan::{Plan, standing};
use crate::problem::Problem;
use crate::wire::cell_jog::{Aim, JogRequest, SlotFields, positions};
use crate::wire::cell_jogged::{
    BranchDocument, JogDocument, StoppedDocument, axes, effector, from_slot, platform,
};
use crate::wire::cell_pose::PoseCheckDocument;

/// The robot of the cell moved by hand: as far as its limits let it go, what stops it there, and where everything is then
///
/// By axes, by the platform, or by a wafer: in the base frame, or as seen from a slot. The arm's droop is made up for, as programs do.
/// The answer carries the minimum distances and violations of the pose found; `stop_at_contact` stops the robot before two bodies touch.
/// Where a wafer cannot come to the place asked for, the robot goes as far on the way as it comes, and `stopped` says why.
#[utoipa::path(
    post,
    path = "/api/v1/cell/jog",
    operation_id = "jog",
    request_body = JogRequest,
    responses(
        (status = 200, description = "Where the robot has come to", body = JogDocument),
        (status = 409, description = "There is no robot to move", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is wrong", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn jog(
    State(app): State<App>,
    Body(mut request): Body<JogRequest>,
) -> Result<Json<JogDocument>, Problem> {
    let desk = desk(&app)?;
    let known = request.plan.take().map(|key| desk.planned(&key).ok_or_else(forgotten));
    let known = known.transpose()?;
    let (cell, program) = desk.texts(request.cell.take(), request.program.take());
    let moved = move |stop: Stop<'_>| {
        let plan = match known {
            Some(plan) => plan,
            None => desk.plan(cell, program, stop).map_err(interrupted)?,
        };
        let mut still = None;
        moved(&with_robot(&plan, &mut still)?, request).map(Json)
    };
    app.work.run_while_awaited(moved).await
}

/// The motion of a plan; where it has none, the robot at home.
///
/// # Errors
/// There is no robot.
pub(super) fn with_robot<'p>(
    plan: &'p Plan,
    still: &'p mut Option<Trajectory>,
) -> Result<Recording<'p>, Problem> {
    let refused = || Problem::request(StatusCode::CONFLICT, nothing(plan));
    if let Some(recording) = plan.recording() {
        return Ok(recording);
    }
    let cell = plan.cell.as_ref().ok_or_else(refused)?;
    let motion = still.insert(standing(cell).ok_or_else(refused)?);
    Ok(Recording { cell, motion, program: "", flaws: &[] })
}

fn moved(recording: &Recording<'_>, request: JogRequest) -> Result<JogDocument, Problem> {
    let cell = recording.cell;
    let time = request.time_s.clamp(0.0, recording.motion.duration());
    let from = match request.from {
        Some(given) => positions(cell, given, "from")?,
        None => recording.motion.at(time).positions,
    };
    let id = named_effector(cell, request.effector.as_deref(), "effector")?;
    let fields = ["seen_from.station", "seen_from.slot"];
    let slot = request.seen_from.map(|slot| named_slot(cell, &slot, fields)).transpose()?;
    let placing = |error: jointplay::format::export::Error| {
        Problem::request(StatusCode::CONFLICT, error.to_string())
    };
    let (_, carried) = frames(recording, time, &from).map_err(placing)?;
    let loaded = carried.contains(&id);
    let moment = Moment { motion: recording.motion, time, reaches: slot.map(|slot| (id, slot)) };
    let start = from.clone();
    let mut jogged = match request.to.map(|to| to.read(cell)).transpose()? {
        None => Jogged { positions: from, stopped: None },
        Some(Aim::Axes(to)) => cell.jog_axes(&from, &to).map_err(robot)?,
        Some(Aim::Platform { tilt, height }) => {
            cell.jog_platform(&from, tilt, AxisHeight(height)).map_err(robot)?
        }
        Some(Aim::World(mut target)) => {
            let free = cell.robot.heading_is_free(id).map_err(robot)?;
            target.heading = target.heading.filter(|_| free);
            or_stay(&from, cell.jog_wafer(&from, id, loaded, &target))
        }
        Some(Aim::Slot(to)) => {
            let slot = slot.ok_or_else(|| {
                Problem::field("seen_from", "a place as seen from a slot needs the slot")
            })?;
            or_stay(&from, cell.jog_from_slot(&from, id, loaded, slot, &to))
        }
    };
    if request.stop_at_contact {
        let ways = [&start[..], &jogged.positions];
        let Straight { positions, touching, .. } =
            straight_until_contact(cell, &moment, ways, &CheckOptions::default()).map_err(robot)?;
        if let Some(pair) = touching {
            jogged = Jogged { positions, stopped: Some(Stopped::Contact(pair)) };
        }
    }
    document(recording, (&moment, id, slot), &carried, &jogged, placing)
}

/// Where nothing can be computed, the robot stays.
fn or_stay(from: &[f64], jogged: Result<Jogged, Unreachable>) -> Jogged {
    jogged.unwrap_or_else(|why| Jogged {
        positions: from.to_vec(),
        stopped: Some(Stopped::Place(why)),
    })
}

pub(super) fn robot(error: CellError) -> Problem {
    Problem::request(StatusCode::CONFLICT, explain::explain(&error))
}

fn document(
    recording: &Recording<'_>,
    (moment, id, slot): (&Moment<'_>, EffectorId, Option<SlotId>),
    carried: &[EffectorId],
    jogged: &Jogged,
    placing: impl Fn(jointplay::format::export::Error) -> Problem,
) -> Result<JogDocument, Problem> {
    let (cell, at) = (recording.cell, jogged.positions.as_slice());
    let loaded = carried.contains(&id);
    let effectors = cell.robot.effectors().map(|one| {
        let loaded = carried.contains(&one);
        let pose = cell.wafer_pose_as_known(one, at, loaded).map_err(robot)?;
        let free = cell.robot.heading_is_free(one).map_err(robot)?;
        Ok(effector(cell, one, &pose, loaded, free))
    });
    let effectors = effectors.collect::<Result<_, Problem>>()?;
    let (pose, _) = cell.wafer_pose_as_known(id, at, loaded).map_err(robot)?;
    let seen = slot.map(|slot| from_slot(cell, slot, &cell.seen_from_slot(&pose, id, slot), &pose));
    let rigid = cell.robot.effector_pose(at, id).map_err(robot)?;
    let ways = cell.robot.inverse(id, &WaferTarget::of(&rigid), at).map_err(robot)?;
    let (frames, _) = frames(recording, moment.time, at).map_err(placing)?;
    let report = check_pose(cell, moment, at, &CheckOptions::default()).map_err(robot)?;
    Ok(JogDocument {
        axes: axes(cell, at),
        platform: platform(cell, at),
        effectors,
        from_slot: seen,
        branches: ways.branches.iter().map(|branch| BranchDocument::new(cell, branch)).collect(),
        stopped: jogged.stopped.as_ref().map(|stopped| StoppedDocument::new(cell, stopped)),
        frames: frames.into_iter().map(Into::into).collect(),
        check: PoseCheckDocument::new(&report),
    })
}

/// The effector of a name; the first without one.
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
            format!("there is no effector {:?}; known: {}", name.unwrap_or(""), known.join(", "));
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
        let detail = format!("there is no station {name:?}; known: {}", known.join(", "));
        return Err(Problem::field(of_station, detail));
    };
    if cell.stations[station].has_slot(*slot) {
        return Ok(SlotId { station, slot: *slot });
    }
    let most = cell.stations[station].slots;
    let detail = format!("{name} has slots 1 to {most}, but no slot {slot}");
    Err(Problem::field(of_slot, detail))
}
