//! `GET /api/v1/meshes/…`: the shapes that the robot file names.

use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use jointplay::format::robot::Robot;

use crate::meshes::media_type;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::Binary;

/// What the base looks like, in the base frame
///
/// STL and OBJ are in mm, glTF in m.
#[utoipa::path(
    get,
    path = "/api/v1/meshes/base",
    operation_id = "base_mesh",
    responses(
        (status = 200, description = "The mesh", body = Binary, content_type = "application/octet-stream"),
        (status = 404, description = "The robot file names no mesh, or the file is missing", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn base_mesh(State(state): State<AppState>) -> Result<Response, Problem> {
    mesh(state, |robot| robot.base_mesh.as_ref()).await
}

/// What the platform looks like, in the platform frame
///
/// STL and OBJ are in mm, glTF in m.
#[utoipa::path(
    get,
    path = "/api/v1/meshes/platform",
    operation_id = "platform_mesh",
    responses(
        (status = 200, description = "The mesh", body = Binary, content_type = "application/octet-stream"),
        (status = 404, description = "The robot file names no mesh, or the file is missing", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn platform_mesh(State(state): State<AppState>) -> Result<Response, Problem> {
    mesh(state, |robot| robot.platform_mesh.as_ref()).await
}

async fn mesh(
    state: AppState,
    of: fn(&Robot) -> Option<&jointplay::format::robot::Mesh>,
) -> Result<Response, Problem> {
    let work = state.work.clone();
    let read = move || {
        let robot = state.robot.robot();
        let missing = |why: String| Problem::request(StatusCode::NOT_FOUND, why);
        let mesh = of(&robot).ok_or_else(|| missing("the robot file names no such mesh".into()))?;
        let bytes = state.meshes.read(mesh).map_err(|error| missing(error.to_string()))?;
        Ok((media_type(mesh.format), bytes))
    };
    let (kind, bytes) = work.run(read).await?;
    Ok(([(header::CONTENT_TYPE, kind)], bytes).into_response())
}
