//! `/api/v1/cell…`: the cell, and what programs come to in it.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, UInt32Array};
use arrow_ipc::writer::StreamWriter;
use arrow_schema::{ArrowError, DataType, Field, Schema};
use axum::Json;
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use jointplay::cell::check::{CheckOptions, Moment, check_pose};
use jointplay::cell::{Interrupted, Stop};
use jointplay::format::cell;
use jointplay::interop::export::{self, Window};
use jointplay::report::table::{Column, Values};

use super::cell_jog::{named_effector, named_slot, robot, with_robot};
use crate::app::App;
use crate::body::Body;
use crate::cell::{Desk, NotKept};
use crate::cell_plan::Plan;
use crate::problem::Problem;
use crate::wire::Binary;
use crate::wire::cell::{
    CellDocument, CellText, PlanDocument, PlanRequest, SamplesRequest, SaveRequest, StationRequest,
    TaughtByFields, WindowDocument, broken, short,
};
use crate::wire::cell_chain::ChainDocument;
use crate::wire::cell_jog::{SlotFields, positions};
use crate::wire::cell_parts::{RobotParts, bodies, stations, wafers, zones};
use crate::wire::cell_pose::touching;

pub(super) fn desk(app: &App) -> Result<Desk, Problem> {
    app.desk.clone().ok_or_else(|| {
        let detail = "this studio shows no cell: start it with `jointplay studio --cell`";
        Problem::request(StatusCode::NOT_FOUND, detail)
    })
}

/// The cell and its program, as their files have them
#[utoipa::path(
    get,
    path = "/api/v1/cell",
    operation_id = "cell",
    responses(
        (status = 200, description = "The texts", body = CellDocument),
        (status = 404, description = "The studio shows no cell", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The files cannot be read", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn cell_files(State(app): State<App>) -> Result<Json<CellDocument>, Problem> {
    let desk = desk(&app)?;
    let read = move || desk.read().map_err(|why| Problem::request(StatusCode::CONFLICT, why));
    app.work.run(read).await.map(|files| Json(CellDocument::new(files)))
}

/// Keeps both texts in the files that they came from
///
/// Both files are written whole, or neither is; what is wrong with the texts does not matter.
/// With the version that they replace, they are not kept where the files have changed on the disk since.
#[utoipa::path(
    put,
    path = "/api/v1/cell",
    operation_id = "save_cell",
    request_body = SaveRequest,
    responses(
        (status = 200, description = "The texts, as they are kept now", body = CellDocument),
        (status = 409, description = "They cannot be kept; where the files have changed on the disk, `field` is `replaces`", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is wrong", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn save_cell(
    State(app): State<App>,
    Body(SaveRequest { cell, program, replaces }): Body<SaveRequest>,
) -> Result<Json<CellDocument>, Problem> {
    let desk = desk(&app)?;
    let save = move || {
        desk.save(cell, program, replaces.as_deref()).map_err(|why| match why {
            NotKept::Changed(why) => Problem::outdated("replaces", why),
            NotKept::Unwritten(why) => Problem::request(StatusCode::CONFLICT, why),
        })
    };
    app.work.run(save).await.map(|files| Json(CellDocument::new(files)))
}

/// What a program comes to in a cell: its motion in windows, its report, and all that is wrong
///
/// A text that is wrong is no error of the request: `problems` says what and where, all of it at once.
/// Closing the connection ends the planning.
#[utoipa::path(
    post,
    path = "/api/v1/cell/plan",
    operation_id = "plan",
    request_body = PlanRequest,
    responses(
        (status = 200, description = "The plan", body = PlanDocument),
        (status = 409, description = "The plan of `since` is not remembered: send whole texts", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is wrong", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn plan(
    State(app): State<App>,
    Body(PlanRequest { cell, program, since }): Body<PlanRequest>,
) -> Result<Json<PlanDocument>, Problem> {
    let desk = desk(&app)?;
    let (cell, program) = match since {
        Some(since) => {
            let known = desk.planned(&since.plan).ok_or_else(|| {
                Problem::outdated("since", "this plan is not remembered: send whole texts")
            })?;
            let changed = since.texts(known.texts())?;
            (cell.unwrap_or(changed.0), program.unwrap_or(changed.1))
        }
        None => desk.texts(cell, program),
    };
    let planned = move |stop: Stop<'_>| {
        let plan = desk.plan(cell, program, stop).map_err(interrupted)?;
        Ok(Json(document(&plan)))
    };
    app.work.run_while_awaited(planned).await
}

pub(super) fn interrupted(_: Interrupted) -> Problem {
    let detail = "the computation was stopped: the client is gone, or the server ends";
    Problem::unavailable(StatusCode::SERVICE_UNAVAILABLE, detail)
}

fn document(plan: &Plan) -> PlanDocument {
    let cell = plan.cell.as_ref();
    let report = plan.report.as_ref();
    let window = |window: &Window| WindowDocument {
        key: window.key.clone(),
        start_s: window.start,
        step: window.steps.start + 1,
        instruction: window.instruction + 1,
        line: window.line,
    };
    PlanDocument {
        key: plan.key.clone(),
        problems: plan.problems.clone(),
        report: report.map(short),
        instructions: report.map_or(0, |report| report.instructions.len()),
        violations: report.map_or(0, |report| report.violations.len()),
        broken_s: report.map(broken).unwrap_or_default(),
        windows: plan.timeline.iter().flat_map(|all| &all.windows).map(window).collect(),
        scene: plan.scene.as_ref().map(|scene| scene.key.clone()),
        stations: cell.map(stations).unwrap_or_default(),
        robot: cell.map(RobotParts::new),
        chain: cell.map(ChainDocument::new),
        wafers: cell.map(wafers).unwrap_or_default(),
        zones: cell.map(zones).unwrap_or_default(),
        bodies: cell.map(bodies).unwrap_or_default(),
        effectors: cell
            .map(|cell| {
                let name = |id: jointplay::cell::robot::EffectorId| {
                    cell.robot.arms[id.arm].effectors[id.effector].name.clone()
                };
                cell.robot.effectors().map(name).collect()
            })
            .unwrap_or_default(),
    }
}

pub(super) fn nothing(plan: &Plan) -> String {
    match plan.problems.first() {
        Some(first) => format!("there is nothing to show: line {}: {}", first.line, first.message),
        None => "there is nothing to show".to_owned(),
    }
}

/// Most rows of samples in one answer.
const ROWS: f64 = 100_000.0;

/// The motion sample by sample, as an Arrow stream
///
/// Time, line of the program, step; position, speed and acceleration of each axis and the wafer centre of each effector, in mm and degrees, as `jointplay cell run` writes them.
/// Longer motions are asked for in stretches of time.
#[utoipa::path(
    post,
    path = "/api/v1/cell/samples",
    operation_id = "samples",
    request_body = SamplesRequest,
    responses(
        (status = 200, description = "The samples", body = Binary, content_type = "application/vnd.apache.arrow.stream"),
        (status = 409, description = "Nothing moves", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is wrong", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn samples(
    State(app): State<App>,
    Body(request): Body<SamplesRequest>,
) -> Result<Response, Problem> {
    let (desk, rate, peaks) = (desk(&app)?, request.rate()?, request.peaks);
    let (from, to) = (request.from_s.unwrap_or(0.0), request.to_s.unwrap_or(f64::INFINITY));
    let (cell, program) = desk.texts(request.cell, request.program);
    let told = move |stop: Stop<'_>| {
        let plan = desk.plan(cell, program, stop).map_err(interrupted)?;
        let refused = |why: String| Problem::request(StatusCode::CONFLICT, why);
        let recording = plan.recording().ok_or_else(|| refused(nothing(&plan)))?;
        let stretch = [from.max(0.0), to.min(recording.motion.duration())];
        let rows = (stretch[1] - stretch[0]) * rate;
        if rows.is_nan() || rows > ROWS {
            let detail = format!(
                "{rows:.0} samples are more than the {ROWS:.0} of one answer: ask for a shorter stretch by from_s and to_s, or for fewer a second by rate_hz"
            );
            return Err(Problem::field("to_s", detail));
        }
        let columns = export::samples_within(&recording, rate, peaks, stretch);
        let columns = columns.map_err(|error| refused(error.to_string()))?;
        arrow(columns).map_err(|error| Problem::broken(&error.to_string()))
    };
    let stream = app.work.run_while_awaited(told).await?;
    Ok(([(header::CONTENT_TYPE, "application/vnd.apache.arrow.stream")], stream).into_response())
}

/// Columns as one batch of an Arrow stream.
fn arrow(columns: Vec<Column>) -> Result<Vec<u8>, ArrowError> {
    let field = |column: &Column| {
        let kind = match column.values {
            Values::Real(_) => DataType::Float64,
            Values::Count(_) => DataType::UInt32,
        };
        Field::new(&column.name, kind, false)
    };
    let fields: Vec<Field> = columns.iter().map(field).collect();
    let arrays: Vec<ArrayRef> = columns
        .into_iter()
        .map(|column| match column.values {
            Values::Real(values) => Arc::new(Float64Array::from(values)) as ArrayRef,
            Values::Count(values) => Arc::new(UInt32Array::from(values)) as ArrayRef,
        })
        .collect();
    let samples = arrays.first().map_or(0, |array| array.len());
    let metadata = HashMap::from([("samples".to_owned(), samples.to_string())]);
    let schema = Arc::new(Schema::new_with_metadata(fields, metadata));
    let mut writer = StreamWriter::try_new(Vec::new(), &schema)?;
    writer.write(&RecordBatch::try_new(schema, arrays)?)?;
    writer.finish()?;
    writer.into_inner()
}

/// The text of the cell with new values of one station
///
/// Comments and all else stay as they are; nothing is kept until both texts are `PUT`.
/// With `taught_by`, the pose of the robot is checked in the cell as it was: where bodies touch, the station is taught only with `confirm_contact`, and a comment before the station says so.
#[utoipa::path(
    post,
    path = "/api/v1/cell/station",
    operation_id = "station",
    request_body = StationRequest,
    responses(
        (status = 200, description = "The text", body = CellText),
        (status = 409, description = "The pose is in contact, and that is not confirmed: `field` is `taught_by.confirm_contact`; or there is no robot to check", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is wrong", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn station(
    State(app): State<App>,
    Body(mut request): Body<StationRequest>,
) -> Result<Json<CellText>, Problem> {
    let desk = desk(&app)?;
    let changes = request.changes()?;
    let by = request.taught_by.take();
    let program = by.as_ref().and_then(|by| by.program.clone());
    let (text, program) = desk.texts(request.cell, program);
    let station = request.station;
    let set = move |stop: Stop<'_>| {
        let wrong = |problem: cell::Problem| Problem::field("station", problem.to_string());
        let mut touching = Vec::new();
        let mut changed = cell::set_station(&text, &station, &changes).map_err(wrong)?;
        if let Some(by) = by {
            let plan = desk.plan(text, program, stop).map_err(interrupted)?;
            touching = contacts(&plan, &station, by)?;
            changed = cell::note_station(&changed, &station, &touching).map_err(wrong)?;
        }
        let touching = touching.iter().map(|pair| pair.to_vec()).collect();
        Ok(Json(CellText { cell: changed, touching }))
    };
    app.work.run_while_awaited(set).await
}

/// What touches in the pose that a station is taught by, if that is confirmed.
fn contacts(plan: &Plan, station: &str, by: TaughtByFields) -> Result<Vec<[String; 2]>, Problem> {
    let mut still = None;
    let recording = with_robot(plan, &mut still)?;
    let cell = recording.cell;
    let id = named_effector(cell, by.effector.as_deref(), "taught_by.effector")?;
    let asked = SlotFields { station: station.to_owned(), slot: by.slot };
    let slot = named_slot(cell, &asked, ["station", "taught_by.slot"])?;
    let at = positions(cell, by.positions, "taught_by.positions")?;
    let time = by.time_s.clamp(0.0, recording.motion.duration());
    let moment = Moment { motion: recording.motion, time, reaches: Some((id, slot)) };
    let report = check_pose(cell, &moment, &at, &CheckOptions::default()).map_err(robot)?;
    let touching = touching(&report);
    if touching.is_empty() || by.confirm_contact {
        return Ok(touching);
    }
    let pairs: Vec<String> =
        touching.iter().map(|[one, other]| format!("{one} and {other}")).collect();
    let detail = format!(
        "in this pose there is contact between {}; move the robot out of it, or confirm that {station} is taught in contact",
        pairs.join("; ")
    );
    Err(Problem::outdated("taught_by.confirm_contact", detail))
}
