//! `/api/v1/cell/plans…`, `windows`, `scenes`: parts of plans that the server remembers.

use axum::Json;
use axum::extract::rejection::PathRejection;
use axum::extract::{Path, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::lookup::unknown_key;
use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::Binary;
use crate::wire::cell::{InstructionsPage, OverviewRequest, ViolationsPage};

/// Rows of a page.
const PAGE: usize = 100;
/// What a key names never changes.
const FOREVER: &str = "private, max-age=31536000, immutable";

fn named<T>(path: Result<Path<T>, PathRejection>) -> Result<T, Problem> {
    path.map(|Path(named)| named).map_err(|_| unknown_key())
}

/// Part of a list.
fn page<T: Clone>(all: &[T], page: &str) -> Result<Vec<T>, Problem> {
    let number: usize = page.parse().map_err(|_| unknown_key())?;
    let start = number.saturating_mul(PAGE).min(all.len());
    Ok(all[start..(start + PAGE).min(all.len())].to_vec())
}

/// The instructions of a plan, a hundred a page
///
/// As `jointplay cell check --format json` has them.
#[utoipa::path(
    get,
    path = "/api/v1/cell/plans/{plan}/instructions/{page}",
    operation_id = "instructions",
    params(("plan" = String, Path, description = "Key of the plan"), ("page" = String, Path, description = "Number of the page, from 0")),
    responses(
        (status = 200, description = "The instructions", body = InstructionsPage),
        (status = "4XX", description = "The plan is not remembered", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn instructions(
    State(state): State<AppState>,
    path: Result<Path<(String, String)>, PathRejection>,
) -> Result<Json<InstructionsPage>, Problem> {
    let (key, number) = named(path)?;
    let plan = state.session()?.kept_plan(&key).ok_or_else(unknown_key)?;
    let all = plan.report.as_ref().map_or(&[][..], |report| &report.instructions);
    Ok(Json(InstructionsPage { of: all.len(), instructions: page(all, &number)? }))
}

/// The violations of a plan, a hundred a page
#[utoipa::path(
    get,
    path = "/api/v1/cell/plans/{plan}/violations/{page}",
    operation_id = "violations",
    params(("plan" = String, Path, description = "Key of the plan"), ("page" = String, Path, description = "Number of the page, from 0")),
    responses(
        (status = 200, description = "The violations", body = ViolationsPage),
        (status = "4XX", description = "The plan is not remembered", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn violations(
    State(state): State<AppState>,
    path: Result<Path<(String, String)>, PathRejection>,
) -> Result<Json<ViolationsPage>, Problem> {
    let (key, number) = named(path)?;
    let plan = state.session()?.kept_plan(&key).ok_or_else(unknown_key)?;
    let all = plan.report.as_ref().map_or(&[][..], |report| &report.violations);
    Ok(Json(ViolationsPage { of: all.len(), violations: page(all, &number)? }))
}

/// Least and largest values of all axes in windows of a plan
///
/// Binary as `cell/windows/{key}`: its JSON says how many windows and axes there are; for each window and axis there are seven numbers: least and largest position, velocity and acceleration, and how long it moves, in m, rad and s.
#[utoipa::path(
    post,
    path = "/api/v1/cell/overview",
    operation_id = "overview",
    request_body = OverviewRequest,
    responses(
        (status = 200, description = "The numbers", body = Binary, content_type = "application/octet-stream"),
        (status = "4XX", description = "The plan is not remembered, or the request is wrong", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn overview(
    State(state): State<AppState>,
    Body(OverviewRequest { plan, windows }): Body<OverviewRequest>,
) -> Result<Response, Problem> {
    let plan = state.session()?.kept_plan(&plan).ok_or_else(unknown_key)?;
    let count = plan.timeline.as_ref().map_or(0, |timeline| timeline.windows.len());
    if let Some(place) = windows.iter().position(|&window| window >= count) {
        let detail = format!("there is no window {}, there are {count}", windows[place]);
        return Err(Problem::field(format!("windows[{place}]"), detail));
    }
    let bytes = move || match (&plan.timeline, plan.motion_export()) {
        (Some(timeline), Some(motion_export)) => Ok(timeline.overview(&motion_export, &windows)),
        _ => Err(unknown_key()),
    };
    let bytes = state.work.run(bytes).await?;
    Ok(([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response())
}

/// What happens in a window of a motion
///
/// Binary: the length of a JSON text as 32 bits, the text, and numbers of 64 bits, all little-endian. The text has the motions, the channels by which all axes, the platform and the deflection of the arms move, the wafers that have changed hands before, those that do in it, and the violations.
/// It never changes: the key is a hash of all that it depends on.
#[utoipa::path(
    get,
    path = "/api/v1/cell/windows/{key}",
    operation_id = "window",
    params(("key" = String, Path, description = "Key of the window")),
    responses(
        (status = 200, description = "The window", body = Binary, content_type = "application/octet-stream"),
        (status = "4XX", description = "No plan with it is remembered", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn window(
    State(state): State<AppState>,
    path: Result<Path<String>, PathRejection>,
) -> Result<Response, Problem> {
    let (session, key) = (state.session()?, named(path)?);
    let content = move || {
        let content = session.window(&key).ok_or_else(unknown_key)?;
        content.map_err(|error| Problem::request(StatusCode::CONFLICT, error.to_string()))
    };
    let bytes = state.work.run(content).await?;
    let kind = (header::CONTENT_TYPE, "application/octet-stream");
    Ok(([kind, (header::CACHE_CONTROL, FOREVER)], bytes).into_response())
}

/// The cell standing still, as binary glTF
///
/// It never changes: the key is a hash of it.
#[utoipa::path(
    get,
    path = "/api/v1/cell/scenes/{key}",
    operation_id = "scene",
    params(("key" = String, Path, description = "Key of the picture")),
    responses(
        (status = 200, description = "The cell", body = Binary, content_type = "model/gltf-binary"),
        (status = "4XX", description = "No plan with it is remembered", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn scene(
    State(state): State<AppState>,
    path: Result<Path<String>, PathRejection>,
) -> Result<Response, Problem> {
    let scene = state.session()?.scene(&named(path)?).ok_or_else(unknown_key)?;
    let kind = (header::CONTENT_TYPE, "model/gltf-binary");
    Ok(([kind, (header::CACHE_CONTROL, FOREVER)], scene.file.clone()).into_response())
}
