//! `/api/v1/cell/jog`: the robot of the cell, moved by hand.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use jointplay::cell::Stop;
use jointplay::cell::check::{
    CheckOptions, ContactFreePath, PoseContext, advance_until_contact, check_pose,
};
use jointplay::cell::jog::{JogOutcome, Stopped};
use jointplay::cell::robot::{EffectorId, WaferTarget};
use jointplay::cell::station::SlotId;
use jointplay::cell::wafer::Unreachable;
use jointplay::gpr::AxisHeight;
use jointplay::interop::export::{MotionExport, frames};

use super::lookup::{
    cell_error, interrupted, named_effector, named_slot, robot_motion, unknown_key,
};
use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::cell_jog::{JogRequest, JogTarget, positions};
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
    State(state): State<AppState>,
    Body(mut request): Body<JogRequest>,
) -> Result<Json<JogDocument>, Problem> {
    let session = state.session()?;
    let known = request.plan.take().map(|key| session.kept_plan(&key).ok_or_else(unknown_key));
    let known = known.transpose()?;
    let (cell, program) = session.texts(request.cell.take(), request.program.take());
    let moved = move |stop: Stop<'_>| {
        let plan = match known {
            Some(plan) => plan,
            None => session.plan(cell, program, stop).map_err(interrupted)?,
        };
        let mut still = None;
        moved(&robot_motion(&plan, &mut still)?, request).map(Json)
    };
    state.work.run_while_awaited(moved).await
}

fn moved(motion_export: &MotionExport<'_>, request: JogRequest) -> Result<JogDocument, Problem> {
    let cell = motion_export.cell;
    let time = request.time_s.clamp(0.0, motion_export.motion.duration());
    let from = match request.from {
        Some(given) => positions(cell, given, "from")?,
        None => motion_export.motion.sample_at(time).positions,
    };
    let id = named_effector(cell, request.effector.as_deref(), "effector")?;
    let fields = ["seen_from.station", "seen_from.slot"];
    let slot = request.seen_from.map(|slot| named_slot(cell, &slot, fields)).transpose()?;
    let placing = |error: jointplay::interop::export::Error| {
        Problem::request(StatusCode::CONFLICT, error.to_string())
    };
    let (_, carried) = frames(motion_export, time, &from).map_err(placing)?;
    let loaded = carried.contains(&id);
    let moment =
        PoseContext { motion: motion_export.motion, time, reaches: slot.map(|slot| (id, slot)) };
    let start = from.clone();
    let mut jogged = match request.to.map(|to| to.read(cell)).transpose()? {
        None => JogOutcome { positions: from, stopped: None },
        Some(JogTarget::Axes(to)) => cell.jog_axes(&from, &to).map_err(cell_error)?,
        Some(JogTarget::Platform { tilt, height }) => {
            cell.jog_platform(&from, tilt, AxisHeight(height)).map_err(cell_error)?
        }
        Some(JogTarget::World(mut target)) => {
            let free = cell.robot.heading_is_free(id).map_err(cell_error)?;
            target.heading = target.heading.filter(|_| free);
            or_stay(&from, cell.jog_wafer(&from, id, loaded, &target))
        }
        Some(JogTarget::Slot(to)) => {
            let slot = slot.ok_or_else(|| {
                Problem::field("seen_from", "a place as seen from a slot needs the slot")
            })?;
            or_stay(&from, cell.jog_slot_relative(&from, id, loaded, slot, &to))
        }
    };
    if request.stop_at_contact {
        let ways = [&start[..], &jogged.positions];
        let ContactFreePath { positions, touching, .. } =
            advance_until_contact(cell, &moment, ways, &CheckOptions::default())
                .map_err(cell_error)?;
        if let Some(pair) = touching {
            jogged = JogOutcome { positions, stopped: Some(Stopped::Contact(pair)) };
        }
    }
    document(motion_export, (&moment, id, slot), &carried, &jogged, placing)
}

/// Where nothing can be computed, the robot stays.
fn or_stay(from: &[f64], jogged: Result<JogOutcome, Unreachable>) -> JogOutcome {
    jogged.unwrap_or_else(|why| JogOutcome {
        positions: from.to_vec(),
        stopped: Some(Stopped::Place(why)),
    })
}

fn document(
    motion_export: &MotionExport<'_>,
    (moment, id, slot): (&PoseContext<'_>, EffectorId, Option<SlotId>),
    carried: &[EffectorId],
    jogged: &JogOutcome,
    placing: impl Fn(jointplay::interop::export::Error) -> Problem,
) -> Result<JogDocument, Problem> {
    let (cell, at) = (motion_export.cell, jogged.positions.as_slice());
    let loaded = carried.contains(&id);
    let effectors = cell.robot.effectors().map(|one| {
        let loaded = carried.contains(&one);
        let pose = cell.wafer_pose_or_rigid(one, at, loaded).map_err(cell_error)?;
        let free = cell.robot.heading_is_free(one).map_err(cell_error)?;
        Ok(effector(cell, one, &pose, loaded, free))
    });
    let effectors = effectors.collect::<Result<_, Problem>>()?;
    let (pose, _) = cell.wafer_pose_or_rigid(id, at, loaded).map_err(cell_error)?;
    let seen =
        slot.map(|slot| from_slot(cell, slot, &cell.slot_relative_pose(&pose, id, slot), &pose));
    let rigid = cell.robot.effector_pose(at, id).map_err(cell_error)?;
    let ways = cell.robot.inverse(id, &WaferTarget::of(&rigid), at).map_err(cell_error)?;
    let (frames, _) = frames(motion_export, moment.time, at).map_err(placing)?;
    let report = check_pose(cell, moment, at, &CheckOptions::default()).map_err(cell_error)?;
    Ok(JogDocument {
        axes: axes(cell, at),
        platform: platform(cell, at),
        effectors,
        from_slot: seen,
        branches: ways.branches.iter().map(|branch| BranchDocument::new(cell, branch)).collect(),
        stopped: jogged.stopped.as_ref().map(|stopped| StoppedDocument::new(cell, stopped)),
        frames: frames.into_iter().map(Into::into).collect(),
        check: PoseCheckDocument::new(cell, &report),
    })
}
