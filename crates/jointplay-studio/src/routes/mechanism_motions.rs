//! `POST /api/v1/mechanism/motions` and `branches`: instantaneous motions, and assembly modes.

use axum::Json;
use axum::extract::State;
use jointplay::mechanism::{
    MechanismSystem, SparseSystem, branches, poses_along_motion, poses_along_sparse_motion,
};
use jointplay::mobility::{RANK_THRESHOLD, instantaneous_mobility};
use jointplay::spatial::Pose;

use crate::body::Body;
use crate::mechanism_source::{self, play_scale, too_large};
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::mechanism_view::{
    BranchesDocument, ConfigurationRequest, MotionDocument, MotionsDocument,
};

/// Number of other starts from which assembly modes are searched.
const STARTS: usize = 30;
/// Poses of a motion are at this many steps to either side.
const STEPS: i32 = 8;
/// Largest number of poses in a response, some 20 MB: further motions are not drawn.
const MAX_POSES: usize = 100_000;

/// The instantaneous motions of a mechanism in a configuration, as poses to animate
///
/// Each link moves as a rigid body along its velocity: joints open in the picture where the motion is only instantaneous.
#[utoipa::path(
    post,
    path = "/api/v1/mechanism/motions",
    operation_id = "mechanism_motions",
    request_body = ConfigurationRequest,
    responses(
        (status = 200, description = "The motions", body = MotionsDocument),
        (status = 409, description = "The loops are not closed", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn instantaneous_motions(
    State(state): State<AppState>,
    Body(request): Body<ConfigurationRequest>,
) -> Result<Json<MotionsDocument>, Problem> {
    state.work.run(move || motions(&request)).await.map(Json)
}

fn motions(request: &ConfigurationRequest) -> Result<MotionsDocument, Problem> {
    play_scale(request.play_scale)?;
    let read = mechanism_source::required(&request.mechanism)?;
    let at = read.closed_at(read.checked(&request.coordinates, "coordinates")?)?;
    let mechanism = &read.file.mechanism;
    let shares: Vec<f64> = (-STEPS..=STEPS).map(|k| f64::from(k) / f64::from(STEPS)).collect();
    let allowed = MAX_POSES / (shares.len() * mechanism.links().len().max(1));
    let described = |steps: Vec<Vec<Pose>>| MotionDocument {
        steps: steps.iter().map(|poses| poses.iter().map(Into::into).collect()).collect(),
    };
    if !MechanismSystem::fits(mechanism) {
        let system = SparseSystem::new(mechanism, at.coordinates)?;
        let found = system.mobility(RANK_THRESHOLD)?;
        let motion =
            |motion| poses_along_sparse_motion(&system, &found, motion, &shares).map(described);
        let motions = (0..found.mobility.min(allowed)).map(motion).collect::<Result<_, _>>()?;
        return Ok(MotionsDocument { mobility: found.mobility, motions });
    }
    let system = MechanismSystem::new(mechanism, at.coordinates)?;
    let first = instantaneous_mobility(&system, &system.at_home(), RANK_THRESHOLD)?;
    let motion = |motion| poses_along_motion(&system, &first, motion, &shares).map(described);
    let motions = (0..first.mobility.min(allowed)).map(motion).collect::<Result<_, _>>()?;
    Ok(MotionsDocument { mobility: first.mobility, motions })
}

/// The assembly modes of a mechanism: closed configurations with the actuated joints at given values
///
/// The search starts from the given configuration and from others, and ends when 16 are found; it may miss some.
#[utoipa::path(
    post,
    path = "/api/v1/mechanism/branches",
    operation_id = "mechanism_branches",
    request_body = ConfigurationRequest,
    responses(
        (status = 200, description = "The closed configurations", body = BranchesDocument),
        (status = 409, description = "The loops cannot be closed", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn assembly_modes(
    State(state): State<AppState>,
    Body(request): Body<ConfigurationRequest>,
) -> Result<Json<BranchesDocument>, Problem> {
    state.work.run(move || modes(&request)).await.map(Json)
}

fn modes(request: &ConfigurationRequest) -> Result<BranchesDocument, Problem> {
    let scale = play_scale(request.play_scale)?;
    let read = mechanism_source::required(&request.mechanism)?;
    let mechanism = &read.file.mechanism;
    MechanismSystem::check_size(mechanism).map_err(|error| too_large(&error))?;
    let mut start = read.checked(&request.coordinates, "coordinates")?;
    // Assembly modes are those of rigid links.
    let joints = mechanism.joint_freedoms();
    start.rows_mut(joints, mechanism.virtual_joints().len()).fill(0.0);
    let held = mechanism.actuated_coordinates();
    let found = branches(mechanism, &start, &held, STARTS)?;
    let branches = found.closures.iter().map(|closed| read.configuration(closed, scale));
    Ok(BranchesDocument {
        held: held.iter().map(|&k| read.coordinates.all()[k].name.clone()).collect(),
        branches: branches.collect::<Result<_, _>>()?,
    })
}
