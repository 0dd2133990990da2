//! `POST /api/v1/inverse`: the result of `jointplay inverse --format json`.

use axum::Json;
use axum::extract::State;
use jointplay::gpr::Gpr;
use jointplay::report::{self, ForwardReport};

use super::{check_limits, solve_command};
use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::question::CommandRequest;

/// The rod lengths of a tilt, and the pose of the platform
///
/// The same document as `jointplay inverse --format json`, in mm and degrees.
#[utoipa::path(
    post,
    path = "/api/v1/inverse",
    operation_id = "inverse",
    request_body = CommandRequest,
    responses(
        (status = 200, description = "The pose", body = ForwardReport),
        (status = 409, description = "The pose is beyond a limit, or there is no solution", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn inverse(
    State(state): State<AppState>,
    Body(request): Body<CommandRequest>,
) -> Result<Json<ForwardReport>, Problem> {
    let work = state.work.clone();
    work.run(move || compute(&state.robot(request.robot.as_ref())?.gpr, request)).await.map(Json)
}

fn compute(gpr: &Gpr, request: CommandRequest) -> Result<ForwardReport, Problem> {
    let (model, options) = (request.model.model(), request.model.options("model")?);
    let target = request.command.read(gpr, "command")?;
    let (rods, tilt) = solve_command(gpr, target, model, &options)?;
    let broken = check_limits(gpr, &rods, tilt, request.ignore_limits)?;
    let pose = gpr.forward(rods, model, &options)?;
    Ok(report::forward(gpr, &pose, model, &broken))
}
