//! `/api/v1/cell/plans…`, `windows`, `scenes`: parts of kept plans.

use axum::Json;
use axum::extract::rejection::PathRejection;
use axum::extract::{Path, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use jointplay::report::CellReport;

use super::lookup::unknown_key;
use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::Binary;
use crate::wire::cell::{InstructionsPage, OverviewRequest, ViolationsPage};

/// Number of rows per page.
const PAGE_SIZE: usize = 100;
/// The response for a key never changes.
const IMMUTABLE: &str = "private, max-age=31536000, immutable";

fn named<T>(path: Result<Path<T>, PathRejection>) -> Result<T, Problem> {
    path.map(|Path(named)| named).map_err(|_| unknown_key())
}

/// Total length and one page of a list in the report of a kept plan, by the key of the plan and the number of the page.
fn report_page<T: Clone>(
    state: &AppState,
    path: Result<Path<(String, String)>, PathRejection>,
    list: fn(&CellReport) -> &Vec<T>,
) -> Result<(usize, Vec<T>), Problem> {
    let (key, number) = named(path)?;
    let plan = state.session()?.kept_plan(&key).ok_or_else(unknown_key)?;
    let number: usize = number.parse().map_err(|_| unknown_key())?;
    let all = plan.report.as_ref().map_or(&[][..], |report| list(report));
    let start = number.saturating_mul(PAGE_SIZE).min(all.len());
    Ok((all.len(), all[start..(start + PAGE_SIZE).min(all.len())].to_vec()))
}

/// The instructions of a plan, 100 per page
///
/// As in the output of `jointplay cell check --format json`.
#[utoipa::path(
    get,
    path = "/api/v1/cell/plans/{plan}/instructions/{page}",
    operation_id = "instructions",
    params(("plan" = String, Path, description = "Key of the plan"), ("page" = String, Path, description = "Number of the page, from 0")),
    responses(
        (status = 200, description = "The instructions", body = InstructionsPage),
        (status = "4XX", description = "The plan is unknown", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn instructions(
    State(state): State<AppState>,
    path: Result<Path<(String, String)>, PathRejection>,
) -> Result<Json<InstructionsPage>, Problem> {
    let (total, instructions) = report_page(&state, path, |report| &report.instructions)?;
    Ok(Json(InstructionsPage { total, instructions }))
}

/// The violations of a plan, 100 per page
#[utoipa::path(
    get,
    path = "/api/v1/cell/plans/{plan}/violations/{page}",
    operation_id = "violations",
    params(("plan" = String, Path, description = "Key of the plan"), ("page" = String, Path, description = "Number of the page, from 0")),
    responses(
        (status = 200, description = "The violations", body = ViolationsPage),
        (status = "4XX", description = "The plan is unknown", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn violations(
    State(state): State<AppState>,
    path: Result<Path<(String, String)>, PathRejection>,
) -> Result<Json<ViolationsPage>, Problem> {
    let (total, violations) = report_page(&state, path, |report| &report.violations)?;
    Ok(Json(ViolationsPage { total, violations }))
}

/// Minimum and maximum values of all axes in windows of a plan
///
/// Binary as `cell/windows/{key}`: its JSON contains the number of windows and axes. For each window and axis there are seven numbers: minimum and maximum of position, velocity and acceleration, and the time in motion, in m, rad and s.
#[utoipa::path(
    post,
    path = "/api/v1/cell/overview",
    operation_id = "overview",
    request_body = OverviewRequest,
    responses(
        (status = 200, description = "The numbers", body = Binary, content_type = "application/octet-stream"),
        (status = "4XX", description = "The plan is unknown, or the request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn overview(
    State(state): State<AppState>,
    Body(OverviewRequest { plan, windows }): Body<OverviewRequest>,
) -> Result<Response, Problem> {
    let plan = state.session()?.kept_plan(&plan).ok_or_else(unknown_key)?;
    let count = plan.timeline.as_ref().map_or(0, |timeline| timeline.windows.len());
    if windows.len() > count {
        let asked = windows.len();
        let detail = format!("{asked} windows are given, but the plan has {count}");
        return Err(Problem::field("windows", detail));
    }
    if let Some(place) = windows.iter().position(|&window| window >= count) {
        let detail = format!("unknown window {}; the plan has {count} windows", windows[place]);
        return Err(Problem::field(format!("windows[{place}]"), detail));
    }
    let bytes = move || match (&plan.timeline, plan.motion_export()) {
        (Some(timeline), Some(motion_export)) => Ok(timeline.overview(&motion_export, &windows)),
        _ => Err(unknown_key()),
    };
    let bytes = state.work.run(bytes).await?;
    Ok(([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response())
}

/// The contents of a window of a motion
///
/// Binary: the length of a JSON text as 32 bits, the text, and numbers of 64 bits, all little-endian. The text contains the motions, the channels of all axes, of the platform and of the deflections of the arms, the hand-offs of wafers before and within the window, and the violations.
/// The contents never change: the key is a hash of everything that they depend on.
#[utoipa::path(
    get,
    path = "/api/v1/cell/windows/{key}",
    operation_id = "window",
    params(("key" = String, Path, description = "Key of the window")),
    responses(
        (status = 200, description = "The window", body = Binary, content_type = "application/octet-stream"),
        (status = "4XX", description = "No kept plan has this key", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
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
    Ok(([kind, (header::CACHE_CONTROL, IMMUTABLE)], bytes).into_response())
}

/// The cell with the robot at home, as binary glTF
///
/// The contents never change: the key is their hash.
#[utoipa::path(
    get,
    path = "/api/v1/cell/scenes/{key}",
    operation_id = "scene",
    params(("key" = String, Path, description = "Key of the scene")),
    responses(
        (status = 200, description = "The cell", body = Binary, content_type = "model/gltf-binary"),
        (status = "4XX", description = "No kept plan has this key", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn scene(
    State(state): State<AppState>,
    path: Result<Path<String>, PathRejection>,
) -> Result<Response, Problem> {
    let scene = state.session()?.scene(&named(path)?).ok_or_else(unknown_key)?;
    let kind = (header::CONTENT_TYPE, "model/gltf-binary");
    Ok(([kind, (header::CACHE_CONTROL, IMMUTABLE)], scene.file.clone()).into_response())
}
