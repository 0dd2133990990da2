//! `/api/v1/cell/station`: a station taught or edited in the text of the cell.

use axum::Json;
use axum::extract::State;
use jointplay::cell::StopRequested;
use jointplay::cell::check::{CheckOptions, PoseContext, check_pose};
use jointplay::format::cell;

use super::lookup::{cell_error, interrupted, named_effector, named_slot, robot_motion};
use crate::body::Body;
use crate::plan::Plan;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::cell::{CellText, StationRequest, TaughtByFields};
use crate::wire::cell_jog::{SlotFields, positions};
use crate::wire::cell_pose::touching;

/// Change the values of a station in the text of the cell file
///
/// Comments and all other values are preserved. Nothing is saved before both texts are `PUT`.
/// With `taught_by`, the pose of the robot is checked in the unchanged cell. A pose in contact requires `confirm_contact`; a comment at the station then records the contact.
#[utoipa::path(
    post,
    path = "/api/v1/cell/station",
    operation_id = "station",
    request_body = StationRequest,
    responses(
        (status = 200, description = "The text of the cell file", body = CellText),
        (status = 409, description = "The pose is in contact and not confirmed: `field` is `taught_by.confirm_contact`; or the cell has no valid robot", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn station(
    State(state): State<AppState>,
    Body(mut request): Body<StationRequest>,
) -> Result<Json<CellText>, Problem> {
    let session = state.session()?;
    let changes = request.changes()?;
    let by = request.taught_by.take();
    let program = by.as_ref().and_then(|by| by.program.clone());
    let (text, program) = session.texts(request.cell, program);
    let station = request.station;
    let set = move |stop: StopRequested<'_>| {
        let invalid_station =
            |problem: cell::Problem| Problem::field("station", problem.to_string());
        let mut touching = Vec::new();
        let mut changed = cell::set_station(&text, &station, &changes).map_err(invalid_station)?;
        if let Some(by) = by {
            let plan = session.plan(text, program, stop).map_err(interrupted)?;
            touching = contacts(&plan, &station, by)?;
            changed = cell::note_station(&changed, &station, &touching).map_err(invalid_station)?;
        }
        let contacts = touching.iter().map(|pair| pair.to_vec()).collect();
        Ok(Json(CellText { cell: changed, contacts }))
    };
    state.work.run_while_awaited(set).await
}

/// The pairs in contact in the pose by which a station is taught.
///
/// # Errors
/// A contact that is not confirmed.
fn contacts(plan: &Plan, station: &str, by: TaughtByFields) -> Result<Vec<[String; 2]>, Problem> {
    let mut still = None;
    let motion_export = robot_motion(plan, &mut still)?;
    let cell = motion_export.cell;
    let id = named_effector(cell, by.effector.as_deref(), "taught_by.effector")?;
    let asked = SlotFields { station: station.to_owned(), slot: by.slot };
    let slot = named_slot(cell, &asked, ["station", "taught_by.slot"])?;
    let at = positions(cell, by.positions, "taught_by.positions")?;
    let time = by.time_s.clamp(0.0, motion_export.motion.duration());
    let moment =
        PoseContext { trajectory: motion_export.motion, time, slot_access: Some((id, slot)) };
    let report = check_pose(cell, &moment, &at, &CheckOptions::default()).map_err(cell_error)?;
    let touching: Vec<[String; 2]> =
        touching(&report).into_iter().map(|pair| pair.map(|one| cell.entity_name(one))).collect();
    if touching.is_empty() || by.confirm_contact {
        return Ok(touching);
    }
    let pairs: Vec<String> =
        touching.iter().map(|[one, other]| format!("{one} and {other}")).collect();
    let detail = format!(
        "there is contact between {} in this pose; move the robot away, or confirm that {station} is taught in contact",
        pairs.join("; ")
    );
    Err(Problem::outdated("taught_by.confirm_contact", detail))
}
