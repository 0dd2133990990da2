//! `POST /api/v1/mobility`: the result of `jointplay mobility --format json`.

use axum::Json;
use axum::extract::State;
use jointplay::gpr::Gpr;
use jointplay::mobility::{RANK_THRESHOLD, augmented_mobility, finite_mobility};
use jointplay::report::{self, MobilityReport};
use jointplay::virtualization::{Planar, SolveOptions};

use super::check_limits;
use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::question::MobilityRequest;
use crate::wire::rods;

/// The Kutzbach, instantaneous and finite mobility
///
/// The same document as `jointplay mobility --format json`, in mm and degrees.
#[utoipa::path(
    post,
    path = "/api/v1/mobility",
    operation_id = "mobility",
    request_body = MobilityRequest,
    responses(
        (status = 200, description = "The mobility", body = MobilityReport),
        (status = 409, description = "The pose is beyond a limit, or there is no solution", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn mobility(
    State(state): State<AppState>,
    Body(request): Body<MobilityRequest>,
) -> Result<Json<MobilityReport>, Problem> {
    let work = state.work.clone();
    work.run(move || compute(&state.robot(request.robot.as_ref())?.gpr, request)).await.map(Json)
}

fn compute(gpr: &Gpr, request: MobilityRequest) -> Result<MobilityReport, Problem> {
    let rods = match request.rods_m {
        Some(given) => rods(given.0, "rods_m")?,
        None => [gpr.working_height(); 3],
    };
    let broken = check_limits(gpr, &rods, gpr.plane_tilt(&rods), request.ignore_limits)?;
    // The rigid mechanism is the one whose virtual joints are held; which virtualization holds them makes no difference.
    let options = SolveOptions::default();
    let pose = gpr.forward(rods, &Planar, &options)?;
    let rigid = gpr.system(&Planar);
    let finite = finite_mobility(&rigid, &rigid.configuration(&pose), RANK_THRESHOLD)?;
    let augmented = match request.virtualization {
        None => None,
        Some(name) => {
            let model = name.model();
            let relieved = gpr.system(model);
            let at = relieved.configuration(&gpr.forward(rods, model, &options)?);
            Some((model.name(), augmented_mobility(&relieved, &at, RANK_THRESHOLD)?))
        }
    };
    let augmented = augmented.as_ref().map(|(name, found)| (*name, found));
    Ok(report::mobility(&pose, gpr.kutzbach_mobility(), &finite, augmented, &broken))
}
