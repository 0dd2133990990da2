//! `POST /api/v1/mechanism/export`: the motion of a joint as a file.

use std::collections::BTreeMap;

use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use jointplay::cell::StopRequested;
use jointplay::interop::export::{self, MechanismMotion};
use jointplay::mechanism::{DEFAULT_STEPS, Drive, DrivePath, DrivenMotion, held_actuators};
use jointplay::nalgebra::DVector;
use jointplay::report::{self, MotionReport, table};

use super::lookup::driven;
use crate::body::Body;
use crate::mechanism_source::{self, ReadMechanism, play_scale};
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::Binary;
use crate::wire::mechanism_view::{MechanismExportFormat, MechanismExportRequest};

/// Maximum number of steps of a motion, which is kept in memory until it is sent.
const MAX_STEPS: usize = 20_000;
/// Duration of a scene (s).
const DURATION: f64 = 4.0;
/// Largest deviation of a scene from the steps of its motion (m).
const TOLERANCE: f64 = 1e-6;

/// The motion of a joint as a file: a table of all coordinates, or an animated 3D scene
///
/// Other actuated joints are held. From the configuration of the file, the files are those of `jointplay move FILE --drive JOINT=FROM:TO --steps N --to csv,gltf --exaggerate SCALE`. A motion that stops or leaves limits is a problem.
#[utoipa::path(
    post,
    path = "/api/v1/mechanism/export",
    operation_id = "mechanism_export",
    request_body = MechanismExportRequest,
    responses(
        (status = 200, description = "The file", body = Binary, content_type = "application/octet-stream"),
        (status = 409, description = "The motion stops, leaves limits, or its loops are not closed", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn mechanism_export(
    State(state): State<AppState>,
    Body(request): Body<MechanismExportRequest>,
) -> Result<Response, Problem> {
    let permit = state.work.export()?;
    let made = move |stop: StopRequested<'_>| {
        let _permit = permit;
        file(&request, stop)
    };
    let contents = state.work.run_while_awaited(made).await?;
    Ok(([(header::CONTENT_TYPE, "application/octet-stream")], contents).into_response())
}

fn file(request: &MechanismExportRequest, stop: StopRequested<'_>) -> Result<Vec<u8>, Problem> {
    let scale = play_scale(request.play_scale)?;
    if !(1..=MAX_STEPS).contains(&request.steps) {
        let detail = format!("the number of steps must be 1 to {MAX_STEPS}, got {}", request.steps);
        return Err(Problem::field("steps", detail));
    }
    let read = mechanism_source::required(&request.mechanism)?;
    let mechanism = &read.file.mechanism;
    let value = |text: &str, field: &str| {
        let command = BTreeMap::from([(request.drive.clone(), text.to_owned())]);
        let found = read.commands(&command, field)?;
        found.first().copied().ok_or_else(|| Problem::broken("a command without a value"))
    };
    let ((coordinate, from), (_, to)) = (value(&request.from, "from")?, value(&request.to, "to")?);
    if from == to {
        return Err(Problem::field("to", "the values at the start and at the end are equal"));
    }
    let reference = read.closed(None)?.coordinates;
    let at = match &request.at {
        Some(at) => read.closed_at(read.checked(at, "at")?)?.coordinates,
        None => reference.clone(),
    };
    let start = if at[coordinate] == from {
        at
    } else {
        let first = [Drive { coordinate, to: from }];
        let moved = run(&read, &at, &DrivePath::line(&at, &first)?, DEFAULT_STEPS, stop)?;
        if let Some(message) = described(&read, coordinate, &moved).message {
            let detail = format!("before the start of the motion: {message}");
            return Err(Problem::request(StatusCode::CONFLICT, detail));
        }
        moved.waypoints.last().map_or(at, |last| last.coordinates.clone())
    };
    stopped(stop)?;
    let path = DrivePath::through(vec![coordinate], vec![vec![from], vec![to]])?;
    let moved = run(&read, &start, &path, request.steps, stop)?;
    let report = described(&read, coordinate, &moved);
    complete(&report)?;
    stopped(stop)?;
    match request.format {
        MechanismExportFormat::Csv => Ok(table::csv(&report.columns()).into_bytes()),
        MechanismExportFormat::Gltf => {
            let waypoints = moved.waypoints.iter().map(|waypoint| &waypoint.coordinates);
            let shares: Vec<f64> = moved.waypoints.iter().map(|waypoint| waypoint.share).collect();
            let scene = export::proportional_times(DURATION, &shares).and_then(|times| {
                MechanismMotion::new(mechanism, &reference, waypoints, times, scale)?
                    .gltf(TOLERANCE)
            });
            let failed =
                |why: export::Error| Problem::request(StatusCode::CONFLICT, why.to_string());
            scene.map_err(failed)
        }
    }
}

fn run(
    read: &ReadMechanism,
    from: &DVector<f64>,
    path: &DrivePath,
    steps: usize,
    stop: StopRequested<'_>,
) -> Result<DrivenMotion, Problem> {
    let mechanism = &read.file.mechanism;
    let held = held_actuators(mechanism, path.coordinates());
    driven(mechanism, from, path, &held, steps, stop)
}

fn described(read: &ReadMechanism, driven: usize, moved: &DrivenMotion) -> MotionReport {
    let held = held_actuators(&read.file.mechanism, &[driven]);
    report::motion(&read.file, &[driven], &held, None, moved)
}

/// Whether a motion reaches its end within limits.
fn complete(report: &MotionReport) -> Result<(), Problem> {
    let refused = |detail: String| Err(Problem::request(StatusCode::CONFLICT, detail));
    if let Some(message) = &report.message {
        return refused(format!("the motion is not complete: {message}"));
    }
    let Some(first) = &report.first_beyond_limits else { return Ok(()) };
    let limits: Vec<&str> =
        first.limits_broken.iter().map(|limit| limit.message.as_str()).collect();
    refused(format!("the motion leaves limits at {}: {}", first.place, limits.join("; ")))
}

fn stopped(stop: StopRequested<'_>) -> Result<(), Problem> {
    if stop() { Err(super::lookup::interrupted(jointplay::cell::Interrupted)) } else { Ok(()) }
}
