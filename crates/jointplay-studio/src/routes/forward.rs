//! `POST /api/v1/forward`: the result of `jointplay forward --format json`.

use axum::Json;
use axum::extract::State;
use jointplay::gpr::Gpr;
use jointplay::report::{self, ForwardReport};

use super::check_limits;
use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::question::ForwardRequest;
use crate::wire::rods;

/// The pose of the platform for given rod lengths
///
/// The same document as `jointplay forward --format json`, in mm and degrees.
#[utoipa::path(
    post,
    path = "/api/v1/forward",
    operation_id = "forward",
    request_body = ForwardRequest,
    responses(
        (status = 200, description = "The pose", body = ForwardReport),
        (status = 409, description = "The pose is beyond a limit, or there is no solution", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn forward(
    State(state): State<AppState>,
    Body(request): Body<ForwardRequest>,
) -> Result<Json<ForwardReport>, Problem> {
    let work = state.work.clone();
    work.run(move || compute(&state.robot(request.robot.as_ref())?.gpr, request)).await.map(Json)
}

fn compute(gpr: &Gpr, request: ForwardRequest) -> Result<ForwardReport, Problem> {
    let rods = rods(request.rods_m.0, "rods_m")?;
    let (model, options) = (request.model.model(), request.model.options("model")?);
    let broken = check_limits(gpr, &rods, gpr.plane_tilt(&rods), request.ignore_limits)?;
    let pose = gpr.forward(rods, model, &options)?;
    Ok(report::forward(gpr, &pose, model, &broken))
}
