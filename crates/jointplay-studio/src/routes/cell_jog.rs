//! `/api/v1/cell/jog`: jogging of the robot of the cell.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use jointplay::cell::StopRequested;
use jointplay::cell::check::{
    CheckOptions, ContactFreePath, PoseContext, advance_until_contact, check_pose, nearest_points,
};
use jointplay::cell::jog::{JogOutcome, StopReason};
use jointplay::cell::robot::{EffectorId, WaferTarget};
use jointplay::cell::station::SlotId;
use jointplay::cell::wafer::Unreachable;
use jointplay::cell::workcell::Cell;
use jointplay::format::explain::explain;
use jointplay::gpr::AxisHeight;
use jointplay::interop::export::{MotionExport, frames};

use super::lookup::{
    cell_error, interrupted, named_effector, named_slot, robot_motion, unknown_key,
};
use super::pose::answer;
use crate::body::Body;
use crate::display::display_units;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::cell_jog::{JogRequest, JogTarget, positions};
use crate::wire::cell_jogged::{
    BranchDocument, JogDocument, PlatformPlayDocument, StoppedDocument, axes, effector, from_slot,
    platform,
};
use crate::wire::cell_pose::PoseCheckDocument;
use crate::wire::pose::ModelDocument;
use crate::wire::{ModelChoice, VirtualizationName};

/// Jog the robot of the cell up to its limits, with the reasons of a stop and the resulting state
///
/// The target is given by the axes, by the platform, or by a wafer in the base frame or relative to a slot. The droop of the arm is compensated as in programs.
/// The response contains the minimum distances and violations of the resulting pose. With `stop_at_contact`, the robot stops before two bodies touch.
/// If a wafer cannot reach its target, the robot moves as far as possible along the path, and `stopped` gives the reasons.
#[utoipa::path(
    post,
    path = "/api/v1/cell/jog",
    operation_id = "jog",
    request_body = JogRequest,
    responses(
        (status = 200, description = "The state of the robot", body = JogDocument),
        (status = 409, description = "The cell has no valid robot", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn jog(
    State(state): State<AppState>,
    Body(mut request): Body<JogRequest>,
) -> Result<Json<JogDocument>, Problem> {
    let session = state.session()?;
    let kept = request.plan.take().map(|key| session.kept_plan(&key).ok_or_else(unknown_key));
    let kept = kept.transpose()?;
    let (cell, program) = session.texts(request.cell.take(), request.program.take());
    let moved = move |stop: StopRequested<'_>| {
        let plan = match kept {
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
    let export_error = |error: jointplay::interop::export::Error| {
        Problem::request(StatusCode::CONFLICT, error.to_string())
    };
    let (_, loaded_effectors) = frames(motion_export, time, &from).map_err(export_error)?;
    let loaded = loaded_effectors.contains(&id);
    let moment = PoseContext {
        trajectory: motion_export.motion,
        time,
        slot_access: slot.map(|slot| (id, slot)),
    };
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
            or_start(&from, cell.jog_wafer(&from, id, loaded, &target))
        }
        Some(JogTarget::Slot(to)) => {
            let slot = slot.ok_or_else(|| {
                Problem::field("seen_from", "a position relative to a slot requires `seen_from`")
            })?;
            or_start(&from, cell.jog_slot_relative(&from, id, loaded, slot, &to))
        }
    };
    if request.stop_at_contact {
        let line = [&start[..], &jogged.positions];
        let ContactFreePath { positions, touching, .. } =
            advance_until_contact(cell, &moment, line, &CheckOptions::default())
                .map_err(cell_error)?;
        if let Some(pair) = touching {
            jogged = JogOutcome { positions, stopped: Some(StopReason::Contact(pair)) };
        }
    }
    document(motion_export, (&moment, id, slot), &loaded_effectors, &jogged, export_error)
}

/// The result of a jog, or the start positions if there is no solution.
fn or_start(from: &[f64], jogged: Result<JogOutcome, Unreachable>) -> JogOutcome {
    jogged.unwrap_or_else(|why| JogOutcome {
        positions: from.to_vec(),
        stopped: Some(StopReason::Unreachable(why)),
    })
}

fn document(
    motion_export: &MotionExport<'_>,
    (moment, id, slot): (&PoseContext<'_>, EffectorId, Option<SlotId>),
    loaded_effectors: &[EffectorId],
    jogged: &JogOutcome,
    export_error: impl Fn(jointplay::interop::export::Error) -> Problem,
) -> Result<JogDocument, Problem> {
    let (cell, at) = (motion_export.cell, jogged.positions.as_slice());
    let loaded = loaded_effectors.contains(&id);
    let effectors = cell.robot.effectors().map(|one| {
        let loaded = loaded_effectors.contains(&one);
        let pose = cell.wafer_pose_or_rigid(one, at, loaded).map_err(cell_error)?;
        let free = cell.robot.heading_is_free(one).map_err(cell_error)?;
        Ok(effector(cell, one, &pose, loaded, free))
    });
    let effectors = effectors.collect::<Result<_, Problem>>()?;
    let (pose, _) = cell.wafer_pose_or_rigid(id, at, loaded).map_err(cell_error)?;
    let seen =
        slot.map(|slot| from_slot(cell, slot, &cell.slot_relative_pose(&pose, id, slot), &pose));
    let rigid = cell.robot.effector_pose(at, id).map_err(cell_error)?;
    let solutions =
        cell.robot.inverse(id, &WaferTarget::from_pose(&rigid), at).map_err(cell_error)?;
    let (frames, _) = frames(motion_export, moment.time, at).map_err(export_error)?;
    let report = check_pose(cell, moment, at, &CheckOptions::default()).map_err(cell_error)?;
    let nearest = nearest_points(cell, moment, at, &report.distances).map_err(cell_error)?;
    Ok(JogDocument {
        axes: axes(cell, at),
        platform: platform(cell, at),
        effectors,
        from_slot: seen,
        branches: solutions
            .branches
            .iter()
            .map(|branch| BranchDocument::new(cell, branch))
            .collect(),
        stopped: jogged.stopped.as_ref().map(|stopped| StoppedDocument::new(cell, stopped)),
        play: play(cell, at),
        frames: frames.into_iter().map(Into::into).collect(),
        check: PoseCheckDocument::new(cell, &report, &nearest),
    })
}

/// The platform at the rods of given axis positions, under all virtualizations.
fn play(cell: &Cell, positions: &[f64]) -> PlatformPlayDocument {
    let (gpr, options) = (&cell.robot.gpr, &cell.robot.model.options);
    let rods = [positions[0], positions[1], positions[2]];
    let model = |virtualization: VirtualizationName| {
        let found = answer(gpr, rods, virtualization.model(), options, false, false);
        let model = ModelChoice::of(virtualization, options);
        match found {
            Ok(answer) => ModelDocument { model, answer: Some(answer), problem: None },
            Err(error) => ModelDocument {
                model,
                answer: None,
                problem: Some(explain(&error, display_units())),
            },
        }
    };
    PlatformPlayDocument {
        virtualization: VirtualizationName::of(cell.robot.model.virtualization),
        budget_m: cell.play_budget,
        models: VirtualizationName::ALL.map(model).into(),
    }
}
