//! `GET /api/v1/robot`: the robot that is served.

use axum::Json;
use axum::extract::State;

use crate::state::AppState;
use crate::wire::robot::RobotDocument;

/// The robot of this server
#[utoipa::path(
    get,
    path = "/api/v1/robot",
    operation_id = "robot",
    responses((status = 200, description = "The robot", body = RobotDocument))
)]
pub(crate) async fn robot(State(state): State<AppState>) -> Json<RobotDocument> {
    Json(RobotDocument::new(&state.robot.robot(), state.started_with()))
}
