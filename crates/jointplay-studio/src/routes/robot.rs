//! `GET /api/v1/robot`: the robot that is served.

use axum::Json;
use axum::extract::State;

use crate::app::App;
use crate::wire::robot::RobotDocument;

/// The robot that this server serves
#[utoipa::path(
    get,
    path = "/api/v1/robot",
    operation_id = "robot",
    responses((status = 200, description = "The robot, and what may be asked of it", body = RobotDocument))
)]
pub(crate) async fn robot(State(app): State<App>) -> Json<RobotDocument> {
    Json(RobotDocument::new(&app.robot, app.desk.is_some()))
}
