//! `POST /api/v1/mechanism/mobility`: the mobility of a mechanism in a configuration.

use axum::Json;
use axum::extract::State;
use jointplay::mechanism::{MechanismSystem, OpenLoops, SparseSystem, mechanism_mobility};
use jointplay::mobility::RANK_THRESHOLD;
use jointplay::report;

use crate::body::Body;
use crate::mechanism_source::{self, play_scale};
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::mechanism_view::{ConfigurationRequest, MobilityOfMechanism};

/// The mobility of a mechanism in a configuration, with its evidence
///
/// The documents are those of `jointplay mobility --format json`: by dense algebra, or by sparse algebra if there are many loops.
#[utoipa::path(
    post,
    path = "/api/v1/mechanism/mobility",
    operation_id = "mechanism_mobility",
    request_body = ConfigurationRequest,
    responses(
        (status = 200, description = "The mobility", body = MobilityOfMechanism),
        (status = 409, description = "The loops are not closed", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn mobility_of_mechanism(
    State(state): State<AppState>,
    Body(request): Body<ConfigurationRequest>,
) -> Result<Json<MobilityOfMechanism>, Problem> {
    state.work.run(move || compute(&request)).await.map(Json)
}

fn compute(request: &ConfigurationRequest) -> Result<MobilityOfMechanism, Problem> {
    play_scale(request.play_scale)?;
    let read = mechanism_source::required(&request.mechanism)?;
    let at = read.checked(&request.coordinates, "coordinates")?;
    let file = &read.file;
    if !MechanismSystem::fits(&file.mechanism) {
        let system = SparseSystem::new(&file.mechanism, at)?;
        let found = system.mobility(RANK_THRESHOLD)?;
        let sparse = report::sparse_mobility(file, &system, &found);
        return Ok(MobilityOfMechanism { dense: None, sparse: Some(sparse) });
    }
    let system = MechanismSystem::new(&file.mechanism, at.clone())?;
    let found = mechanism_mobility(&system, RANK_THRESHOLD, OpenLoops::Refused)?;
    let dense = report::mechanism_mobility(file, &system, &at, None, &found, None)?;
    Ok(MobilityOfMechanism { dense: Some(dense), sparse: None })
}
