//! `POST /api/v1/compare`: the result of `jointplay compare --format json`.

use axum::Json;
use axum::extract::State;
use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::report::{self, CompareReport};
use jointplay::study::broken_limits;
use jointplay::virtualization::built_in;

use super::accepted_limits;
use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::question::{CompareRequest, MAX_TILTS};
use crate::wire::{angle, length, tilt_angle};

/// The results of all models over a range of tilts
///
/// The same document as `jointplay compare --format json`, in mm and degrees.
#[utoipa::path(
    post,
    path = "/api/v1/compare",
    operation_id = "compare",
    request_body = CompareRequest,
    responses(
        (status = 200, description = "The comparison", body = CompareReport),
        (status = 409, description = "The pose is beyond a limit, or there is no solution", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn compare(
    State(state): State<AppState>,
    Body(request): Body<CompareRequest>,
) -> Result<Json<CompareReport>, Problem> {
    let work = state.work.clone();
    work.run(move || compute(&state.robot(request.robot.as_ref())?.gpr, request)).await.map(Json)
}

fn compute(gpr: &Gpr, request: CompareRequest) -> Result<CompareReport, Problem> {
    let options = request.choice().options("")?;
    let azimuth = angle(request.azimuth_rad, "azimuth_rad")?;
    let height = request.axis_height_m.unwrap_or(gpr.working_height());
    let height = AxisHeight(length(height, "axis_height_m")?);
    let tilt_angles = request.tilts_rad;
    if !(1..=MAX_TILTS).contains(&tilt_angles.len()) {
        let detail =
            format!("{} tilt angles are given, 1 to {MAX_TILTS} are allowed", tilt_angles.len());
        return Err(Problem::field("tilts_rad", detail));
    }
    for (k, &found) in tilt_angles.iter().enumerate() {
        tilt_angle(found, &format!("tilts_rad[{k}]"))?;
    }
    let broken = broken_limits(gpr, azimuth, &tilt_angles, height)?;
    let broken = accepted_limits(broken, request.ignore_limits)?;
    let compared =
        jointplay::study::compare(gpr, &built_in(), azimuth, &tilt_angles, height, &options)?;
    Ok(report::compare(&compared, &broken, &[]))
}
