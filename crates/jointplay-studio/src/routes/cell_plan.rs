//! `/api/v1/cell/plan`: the plan of a program in a cell.

use axum::Json;
use axum::extract::State;
use jointplay::cell::StopRequested;
use jointplay::interop::export::Window;

use super::lookup::interrupted;
use crate::body::Body;
use crate::plan::Plan;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::cell::{
    PlanDocument, PlanRequest, WindowDocument, truncated, violation_intervals,
};
use crate::wire::cell_chain::ChainDocument;
use crate::wire::cell_parts::{RobotParts, bodies, stations, wafers, zones};
use crate::wire::program_parameters::with_parameters;

/// Plan a program in a cell: the motion in windows, the report, and all errors
///
/// Errors in the texts are not errors of the request: `diagnostics` lists all of them with their positions.
/// Closing the connection stops the planning.
#[utoipa::path(
    post,
    path = "/api/v1/cell/plan",
    operation_id = "plan",
    request_body = PlanRequest,
    responses(
        (status = 200, description = "The plan", body = PlanDocument),
        (status = 409, description = "The server no longer has the plan of `since`: send the complete texts", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn plan(
    State(state): State<AppState>,
    Body(PlanRequest { cell, program, parameters, since }): Body<PlanRequest>,
) -> Result<Json<PlanDocument>, Problem> {
    let session = state.session()?;
    let (cell, program) = match since {
        Some(since) => {
            let known = session.kept_plan(&since.plan).ok_or_else(|| {
                Problem::outdated(
                    "since",
                    "the server no longer has this plan: send the complete texts",
                )
            })?;
            let changed = since.texts(known.texts())?;
            (cell.unwrap_or(changed.0), program.unwrap_or(changed.1))
        }
        None => session.texts(cell, program),
    };
    let program = with_parameters(program, parameters)?;
    let planned = move |stop: StopRequested<'_>| {
        let plan = session.plan(cell, program, stop).map_err(interrupted)?;
        Ok(Json(document(&plan)))
    };
    state.work.run_while_awaited(planned).await
}

fn document(plan: &Plan) -> PlanDocument {
    let cell = plan.cell.as_ref();
    let report = plan.report.as_ref();
    let window = |window: &Window| WindowDocument {
        key: window.key.clone(),
        start_s: window.start,
        step: window.steps.start + 1,
        instruction: window.instruction + 1,
        line: window.line,
    };
    PlanDocument {
        key: plan.key.clone(),
        diagnostics: plan.diagnostics.clone(),
        report: report.map(truncated),
        instructions: report.map_or(0, |report| report.instructions.len()),
        violations: report.map_or(0, |report| report.violations.len()),
        violations_s: report.map(violation_intervals).unwrap_or_default(),
        windows: plan.timeline.iter().flat_map(|all| &all.windows).map(window).collect(),
        scene: plan.scene.as_ref().map(|scene| scene.key.clone()),
        stations: cell.map(stations).unwrap_or_default(),
        robot: cell.map(|cell| RobotParts::new(cell, plan.texts().0)),
        play_budget_m: cell.map(|cell| cell.play_budget),
        chain: cell.map(ChainDocument::new),
        wafers: cell.map(wafers).unwrap_or_default(),
        zones: cell.map(zones).unwrap_or_default(),
        bodies: cell.map(bodies).unwrap_or_default(),
        effectors: cell
            .map(|cell| {
                let name = |id: jointplay::cell::robot::EffectorId| {
                    cell.robot.arms[id.arm].effectors[id.effector].name.clone()
                };
                cell.robot.effectors().map(name).collect()
            })
            .unwrap_or_default(),
    }
}
