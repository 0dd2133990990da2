//! `POST /api/v1/compare`: the result of `jointplay compare --format json`.

use axum::Json;
use axum::extract::State;
use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::report::{self, CompareReport};
use jointplay::spatial::Tilt;
use jointplay::virtualization::built_in;

use super::check_limits;
use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::question::{CompareRequest, MAX_PITCHES};
use crate::wire::{angle, length, pitch};

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
    let robot = state.robot.clone();
    state.work.run(move || compute(&robot.gpr, request)).await.map(Json)
}

fn compute(gpr: &Gpr, request: CompareRequest) -> Result<CompareReport, Problem> {
    let options = request.choice().options("")?;
    let yaw = angle(request.yaw_rad, "yaw_rad")?;
    let height = request.axis_height_m.unwrap_or(gpr.working_height());
    let height = AxisHeight(length(height, "axis_height_m")?);
    let pitches = request.pitches_rad;
    if !(1..=MAX_PITCHES).contains(&pitches.len()) {
        let detail = format!("{} pitches are given, 1 to {MAX_PITCHES} are allowed", pitches.len());
        return Err(Problem::field("pitches_rad", detail));
    }
    for (k, &found) in pitches.iter().enumerate() {
        pitch(found, &format!("pitches_rad[{k}]"))?;
    }
    let mut broken = Vec::new();
    // The ends of the range violate all limits that any tilt of the range violates.
    let ends = [pitches.iter().copied().reduce(f64::min), pitches.iter().copied().reduce(f64::max)];
    for pitch in ends.into_iter().flatten() {
        let tilt = Tilt { yaw, pitch };
        for limit in check_limits(gpr, &gpr.inverse(tilt, height)?, tilt, request.ignore_limits)? {
            if !broken.contains(&limit) {
                broken.push(limit);
            }
        }
    }
    let compared = jointplay::study::compare(gpr, &built_in(), yaw, &pitches, height, &options)?;
    Ok(report::compare(&compared, &broken, &[]))
}
