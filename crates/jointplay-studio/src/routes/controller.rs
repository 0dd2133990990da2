//! `/api/v1/controller`: the simulated controller and the robots of its hosts.

use axum::Json;
use axum::extract::rejection::PathRejection;
use axum::extract::{Path, State};
use axum::http::StatusCode;

use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::controller::{ControllerDocument, HostDocument};

/// The simulated controller and its connected hosts
#[utoipa::path(
    get,
    path = "/api/v1/controller",
    operation_id = "controller",
    responses(
        (status = 200, description = "The controller", body = ControllerDocument),
        (status = 404, description = "The server has no controller", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn controller(
    State(state): State<AppState>,
) -> Result<Json<ControllerDocument>, Problem> {
    Ok(Json(ControllerDocument::new(&state.controller()?)))
}

/// The robot of a host at the present time
///
/// Positions and frames are those of the planned motion at this time.
#[utoipa::path(
    get,
    path = "/api/v1/controller/hosts/{host}",
    operation_id = "host_of_controller",
    params(("host" = String, Path, description = "Number of the host")),
    responses(
        (status = 200, description = "The robot of the host", body = HostDocument),
        (status = 404, description = "The server has no controller, or the host is not connected", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn host(
    State(state): State<AppState>,
    path: Result<Path<String>, PathRejection>,
) -> Result<Json<HostDocument>, Problem> {
    let controller = state.controller()?;
    let number = path.ok().and_then(|Path(number)| number.parse().ok());
    let Some(host) = number.and_then(|number| controller.host(number)) else {
        let detail = "this host is not connected; see /api/v1/controller for the connected hosts";
        return Err(Problem::request(StatusCode::NOT_FOUND, detail));
    };
    // Short, and needed while all workers plan: not one of their computations.
    HostDocument::new(&host).map(Json)
}
