//! `/api/v1/robot/file`: the file of the robot; `POST /api/v1/robot/open`: a robot from the text of a file.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use jointplay::format::robot::{self, Dimensions};

use crate::body::Body;
use crate::cell_files::SaveError;
use crate::problem::Problem;
use crate::robot_file::RobotFileOnDisk;
use crate::state::AppState;
use crate::wire::robot::{RobotDocument, StartedWith};
use crate::wire::robot_file::{
    DimensionExpression, MAX_CHANGES, OpenRobotRequest, OpenedRobotDocument, RobotFileDocument,
    RobotParameter, SaveRobotRequest,
};

impl From<RobotFileOnDisk> for RobotFileDocument {
    fn from(file: RobotFileOnDisk) -> Self {
        let (version, writable) = (file.version(), file.path.is_some());
        let RobotFileOnDisk { name, text, parameters, .. } = file;
        Self { name, writable, text, parameters, version }
    }
}

/// The text of the robot file, read from disk
#[utoipa::path(
    get,
    path = "/api/v1/robot/file",
    operation_id = "robot_file",
    responses(
        (status = 200, description = "The text", body = RobotFileDocument),
        (status = 409, description = "The file cannot be read", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn robot_file(
    State(state): State<AppState>,
) -> Result<Json<RobotFileDocument>, Problem> {
    let session = state.robot.clone();
    let read = move || session.reload().map_err(|why| Problem::request(StatusCode::CONFLICT, why));
    state.work.run(read).await.map(|file| Json(file.into()))
}

/// Save the text of the robot file
///
/// The file is written completely, or not at all. A text without errors becomes the robot of this server.
/// With `replaces`, the text is saved only if the file on disk still has this version.
#[utoipa::path(
    put,
    path = "/api/v1/robot/file",
    operation_id = "save_robot",
    request_body = SaveRobotRequest,
    responses(
        (status = 200, description = "The saved text", body = RobotFileDocument),
        (status = 409, description = "The file cannot be saved; if it has changed on disk, `field` is `replaces`", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn save_robot(
    State(state): State<AppState>,
    Body(SaveRobotRequest { text, replaces }): Body<SaveRobotRequest>,
) -> Result<Json<RobotFileDocument>, Problem> {
    let session = state.robot.clone();
    let save = move || {
        session.save(text, replaces.as_deref()).map_err(|why| match why {
            SaveError::Changed(why) => Problem::outdated("replaces", why),
            SaveError::Unwritable(why) => Problem::request(StatusCode::CONFLICT, why),
        })
    };
    state.work.run(save).await.map(|file| Json(file.into()))
}

/// A robot from the text of a file
///
/// `changes` replace numbers in the text and leave its comments; they are refused where the text has an expression.
/// The text is returned with all its errors; requests for poses and studies accept it as `robot`.
#[utoipa::path(
    post,
    path = "/api/v1/robot/open",
    operation_id = "open_robot",
    request_body = OpenRobotRequest,
    responses(
        (status = 200, description = "The robot, or the errors of its text", body = OpenedRobotDocument),
        (status = "4XX", description = "The request is invalid, or a number cannot be changed", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn open_robot(
    State(state): State<AppState>,
    Body(request): Body<OpenRobotRequest>,
) -> Result<Json<OpenedRobotDocument>, Problem> {
    let parts = state.started_with();
    state.work.run(move || open(request, parts)).await.map(Json)
}

fn open(request: OpenRobotRequest, parts: StartedWith) -> Result<OpenedRobotDocument, Problem> {
    let OpenRobotRequest { robot: mut source, changes } = request;
    if changes.len() > MAX_CHANGES {
        let detail =
            format!("{} changes are given, at most {MAX_CHANGES} are allowed", changes.len());
        return Err(Problem::field("changes", detail));
    }
    let read = changes.into_iter().enumerate();
    let changes = read
        .map(|(k, change)| change.read(&format!("changes[{k}]")))
        .collect::<Result<Vec<_>, Problem>>()?;
    if !changes.is_empty() {
        source.text = robot::with_dimensions(&source.text, &changes)
            .map_err(|errors| Problem::field("changes", errors.to_string()))?;
    }
    let (robot, diagnostics) = match source.parse() {
        Ok(robot) => (Some(RobotDocument::new(&robot, parts)), Vec::new()),
        Err(errors) => (None, errors.iter().map(Into::into).collect()),
    };
    let Dimensions { parameters, expressions } = robot::dimensions(&source.text);
    let parameters = parameters.into_iter().map(|(name, value)| RobotParameter { name, value });
    let expressions = expressions
        .into_iter()
        .map(|(dimension, expression)| DimensionExpression::new(&dimension, expression));
    Ok(OpenedRobotDocument {
        text: source.text,
        diagnostics,
        robot,
        parameters: parameters.collect(),
        expressions: expressions.collect(),
    })
}
