//! `POST /api/v1/mechanism/open`, `configuration` and `drive`: mechanisms of texts, and motions of their joints.

use axum::Json;
use axum::extract::State;
use jointplay::cell::StopRequested;
use jointplay::mechanism::{Closure, Drive, DrivePath, held_actuators};
use jointplay::report;

use super::lookup::driven;
use crate::body::Body;
use crate::mechanism_source::{self, Unread, how_to_open, play_scale};
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::mechanism_view::{
    ConfigurationDocument, ConfigurationRequest, DriveDocument, DriveRequest, FileKindName,
    OpenRequest, OpenedDocument,
};

/// Number of steps of a motion, between which limits are examined.
const STEPS: usize = 24;

/// A mechanism from the text of a file, with its closed configuration
///
/// Models of other programs and three-rod robots are converted to mechanism files. Errors of the text, and files of other kinds, are part of the answer.
#[utoipa::path(
    post,
    path = "/api/v1/mechanism/open",
    operation_id = "mechanism_open",
    request_body = OpenRequest,
    responses(
        (status = 200, description = "The mechanism, or the errors of its text", body = OpenedDocument),
        (status = 409, description = "The poses cannot be computed", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn mechanism_open(
    State(state): State<AppState>,
    Body(request): Body<OpenRequest>,
) -> Result<Json<OpenedDocument>, Problem> {
    state.work.run(move || open(request)).await.map(Json)
}

fn open(request: OpenRequest) -> Result<OpenedDocument, Problem> {
    let scale = play_scale(request.play_scale)?;
    let source = request.mechanism;
    let read = match mechanism_source::read(&source) {
        Ok(read) => read,
        Err(unread) => {
            let (kind, note, diagnostics) = match unread {
                Unread::OtherKind(kind) => (Some(kind), Some(how_to_open(kind)), Vec::new()),
                Unread::Invalid(found) => {
                    (jointplay::interop::FileKind::detect(&source.text), None, found)
                }
            };
            let kind = FileKindName::from(kind);
            let text = source.text;
            return Ok(OpenedDocument { kind, note, text, diagnostics, mechanism: None });
        }
    };
    // A change of the text may have changed the number of coordinates: then they are of no use.
    let count = read.coordinates.all().len();
    let from = request.from.filter(|from| from.len() == count);
    let from = from.map(|from| read.checked(&from, "from")).transpose()?;
    let mechanism = read.document(from.as_ref(), scale)?;
    Ok(OpenedDocument {
        kind: Some(read.kind).into(),
        note: read.note,
        text: read.text,
        diagnostics: Vec::new(),
        mechanism: Some(mechanism),
    })
}

/// A configuration with the poses of its links at another play scale
#[utoipa::path(
    post,
    path = "/api/v1/mechanism/configuration",
    operation_id = "mechanism_configuration",
    request_body = ConfigurationRequest,
    responses(
        (status = 200, description = "The configuration", body = ConfigurationDocument),
        (status = 409, description = "The loops are not closed", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn mechanism_configuration(
    State(state): State<AppState>,
    Body(request): Body<ConfigurationRequest>,
) -> Result<Json<ConfigurationDocument>, Problem> {
    state.work.run(move || configuration(&request)).await.map(Json)
}

fn configuration(request: &ConfigurationRequest) -> Result<ConfigurationDocument, Problem> {
    let scale = play_scale(request.play_scale)?;
    let read = mechanism_source::required(&request.mechanism)?;
    let coordinates = read.checked(&request.coordinates, "coordinates")?;
    read.configuration(&read.closed_at(coordinates)?, scale)
}

/// Drive joints of a mechanism from a configuration
///
/// The configuration is continued along its branch, with rigid links or with the least displacements of the virtual joints. A motion that cannot be completed ends where it stopped, with the reason.
#[utoipa::path(
    post,
    path = "/api/v1/mechanism/drive",
    operation_id = "mechanism_drive",
    request_body = DriveRequest,
    responses(
        (status = 200, description = "The motion", body = DriveDocument),
        (status = 409, description = "The loops are not closed where the motion begins", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn mechanism_drive(
    State(state): State<AppState>,
    Body(request): Body<DriveRequest>,
) -> Result<Json<DriveDocument>, Problem> {
    state.work.run_while_awaited(move |stop| drive(&request, stop)).await.map(Json)
}

fn drive(request: &DriveRequest, stop: StopRequested<'_>) -> Result<DriveDocument, Problem> {
    let scale = play_scale(request.play_scale)?;
    let read = mechanism_source::required(&request.mechanism)?;
    let from = read.checked(&request.from, "from")?;
    let commands = read.commands(&request.to, "to")?;
    if commands.is_empty() {
        return Err(Problem::field("to", "name at least one joint coordinate with its value"));
    }
    let mechanism = &read.file.mechanism;
    let drives: Vec<Drive> =
        commands.iter().map(|&(coordinate, to)| Drive { coordinate, to }).collect();
    let path = DrivePath::line(&from, &drives)?;
    let held = held_actuators(mechanism, path.coordinates());
    let moved = driven(mechanism, &from, &path, &held, STEPS, stop)?;
    let report = report::motion(&read.file, path.coordinates(), &held, None, &moved);
    let last = moved.waypoints.last();
    let closed = Closure {
        coordinates: last.map_or(from, |last| last.coordinates.clone()),
        residual: last.map_or(0.0, |last| last.residual),
        iterations: 0,
        is_searched: false,
    };
    Ok(DriveDocument {
        configuration: read.configuration(&closed, scale)?,
        stopped: report.stopped,
        message: report.message,
        singular: report.singular,
        first_beyond_limits: report.first_beyond_limits,
        held: report.held,
    })
}
