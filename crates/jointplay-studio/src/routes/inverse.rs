//! `POST /api/v1/inverse`: what `jointplay inverse --format json` answers.

use axum::Json;
use axum::extract::State;
use jointplay::gpr::Gpr;
use jointplay::report::{self, ForwardReport};

use super::{allowed, reached};
use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::question::CommandRequest;

/// Which rods tilt the platform so, and where it then is
///
/// The same document as `jointplay inverse --format json`, in mm and degrees.
#[utoipa::path(
    post,
    path = "/api/v1/inverse",
    operation_id = "inverse",
    request_body = CommandRequest,
    responses(
        (status = 200, description = "The pose", body = ForwardReport),
        (status = 409, description = "The answer is no: beyond a limit, or unsolved", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is wrong", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn inverse(
    State(state): State<AppState>,
    Body(request): Body<CommandRequest>,
) -> Result<Json<ForwardReport>, Problem> {
    let robot = state.robot.clone();
    state.work.run(move || compute(&robot.gpr, request)).await.map(Json)
}

fn compute(gpr: &Gpr, request: CommandRequest) -> Result<ForwardReport, Problem> {
    let (model, options) = (request.model.model(), request.model.options("model")?);
    let target = request.command.read(gpr, "command")?;
    let (rods, tilt) = reached(gpr, target, model, &options)?;
    let broken = allowed(gpr, &rods, tilt, request.ignore_limits)?;
    let pose = gpr.forward(rods, model, &options)?;
    Ok(report::forward(&pose, model, &broken))
}
