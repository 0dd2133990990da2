//! `POST /api/v1/sensitivity`: the result of `jointplay sensitivity --format json`.

use axum::Json;
use axum::extract::State;
use jointplay::gpr::Gpr;
use jointplay::report::{self, SensitivityReport};
use jointplay::spatial::Tilt;

use super::{check_limits, solve_command};
use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::question::CommandRequest;

/// The displacement of the virtual joints for a tilt, with its first-order bounds
///
/// The same document as `jointplay sensitivity --format json`, in mm and degrees.
/// The motion starts at the level pose of the same axis height.
#[utoipa::path(
    post,
    path = "/api/v1/sensitivity",
    operation_id = "sensitivity",
    request_body = CommandRequest,
    responses(
        (status = 200, description = "The sensitivity", body = SensitivityReport),
        (status = 409, description = "The pose is beyond a limit, or there is no solution", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn sensitivity(
    State(state): State<AppState>,
    Body(request): Body<CommandRequest>,
) -> Result<Json<SensitivityReport>, Problem> {
    let work = state.work.clone();
    work.run(move || compute(&state.robot(request.robot.as_ref())?.gpr, request)).await.map(Json)
}

fn compute(gpr: &Gpr, request: CommandRequest) -> Result<SensitivityReport, Problem> {
    let (model, options) = (request.model.model(), request.model.options("model")?);
    let target = request.command.read(gpr, "command")?;
    let (rods, tilt) = solve_command(gpr, target, model, &options)?;
    let broken = check_limits(gpr, &rods, tilt, request.ignore_limits)?;
    let end = gpr.forward(rods, model, &options)?;
    let level = gpr.inverse(Tilt::LEVEL, end.axis_height())?;
    let start = gpr.forward(level, model, &options)?;
    Ok(report::sensitivity(gpr, &gpr.play_between(start, end, model)?, model, &broken))
}
