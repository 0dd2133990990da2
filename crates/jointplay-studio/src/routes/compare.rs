//! `POST /api/v1/compare`: what `jointplay compare --format json` answers.

use axum::Json;
use axum::extract::State;
use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::report::{self, CompareReport};
use jointplay::spatial::Tilt;
use jointplay::virtualization::built_in;

use super::allowed;
use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::question::{CompareRequest, MOST_PITCHES};
use crate::wire::{angle, length, pitch};

/// What every model says of a range of tilts, side by side
///
/// The same document as `jointplay compare --format json`, in mm and degrees.
#[utoipa::path(
    post,
    path = "/api/v1/compare",
    operation_id = "compare",
    request_body = CompareRequest,
    responses(
        (status = 200, description = "The comparison", body = CompareReport),
        (status = 409, description = "The answer is no: beyond a limit, or unsolved", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is wrong", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot", body = Problem, content_type = "application/problem+json"),
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
    if !(1..=MOST_PITCHES).contains(&pitches.len()) {
        let detail =
            format!("{} pitches are given, from 1 to {MOST_PITCHES} may be", pitches.len());
        return Err(Problem::field("pitches_rad", detail));
    }
    for (k, &found) in pitches.iter().enumerate() {
        pitch(found, &format!("pitches_rad[{k}]"))?;
    }
    let mut broken = Vec::new();
    // The ends of the range break whatever any of its tilts does at this azimuth and height.
    let ends = [pitches.iter().copied().reduce(f64::min), pitches.iter().copied().reduce(f64::max)];
    for pitch in ends.into_iter().flatten() {
        let tilt = Tilt { yaw, pitch };
        for limit in allowed(gpr, &gpr.inverse(tilt, height)?, tilt, request.ignore_limits)? {
            if !broken.contains(&limit) {
                broken.push(limit);
            }
        }
    }
    let compared = jointplay::study::compare(gpr, &built_in(), yaw, &pitches, height, &options)?;
    Ok(report::compare(&compared, &broken))
}
