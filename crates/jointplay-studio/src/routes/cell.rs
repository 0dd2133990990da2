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
use jointplay::format::cell;
use jointplay::format::export::{self, Recording};
use jointplay::format::table::{Column, Values};

use super::cell_jog::{named_effector, named_slot, robot, with_robot};
use crate::app::App;
use crate::body::Body;
use crate::cell::{Desk, NotKept, Plan, standing};
use crate::problem::Problem;
use crate::wire::Binary;
use crate::wire::cell::{
    CellDocument, CellRequest, CellText, MotionRequest, PlanDocument, SaveRequest, StationRequest,
    TaughtByFields, steps,
};
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

/// What a program comes to in a cell: steps, times, and all that is wrong
///
/// A text that is wrong is no error of the request: `problems` says what and where, all of it at once.
#[utoipa::path(
    post,
    path = "/api/v1/cell/plan",
    operation_id = "plan",
    request_body = CellRequest,
    responses(
        (status = 200, description = "The plan", body = PlanDocument),
        (status = "4XX", description = "The request is wrong", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn plan(
    State(app): State<App>,
    Body(CellRequest { cell, program }): Body<CellRequest>,
) -> Result<Json<PlanDocument>, Problem> {
    let desk = desk(&app)?;
    let (cell, program) = desk.texts(cell, program);
    app.work.run(move || Ok(Json(document(&desk.plan(cell, program))))).await
}

fn document(plan: &Plan) -> PlanDocument {
    let cell = plan.cell.as_ref();
    PlanDocument {
        problems: plan.problems.clone(),
        report: plan.document(),
        steps: match (cell, &plan.motion) {
            (Some(cell), Some(motion)) => steps(cell, motion),
            _ => Vec::new(),
        },
        stations: cell.map(stations).unwrap_or_default(),
        robot: cell.map(RobotParts::new),
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

/// The cell with its motion, as binary glTF with one animation
///
/// Where the program comes to no motion, the cell stands still; where the cell cannot be read there is nothing to show.
#[utoipa::path(
    post,
    path = "/api/v1/cell/motion.glb",
    operation_id = "motion",
    request_body = MotionRequest,
    responses(
        (status = 200, description = "The cell in motion", body = Binary, content_type = "model/gltf-binary"),
        (status = 409, description = "There is nothing to show", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is wrong", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn motion(
    State(app): State<App>,
    Body(request): Body<MotionRequest>,
) -> Result<Response, Problem> {
    let (desk, rate) = (desk(&app)?, request.rate()?);
    let (cell, program) = desk.texts(request.cell, request.program);
    let shown = move || {
        let plan = desk.plan(cell, program);
        let refused = |why: String| Problem::request(StatusCode::CONFLICT, why);
        let still;
        let recording = match (plan.recording(), &plan.cell) {
            (Some(recording), _) => recording,
            (None, Some(cell)) => {
                still = standing(cell).ok_or_else(|| refused(nothing(&plan)))?;
                Recording { cell, motion: &still, program: "", flaws: &[] }
            }
            (None, None) => return Err(refused(nothing(&plan))),
        };
        export::gltf(&recording, rate).map_err(|error| refused(error.to_string()))
    };
    let file = app.work.run(shown).await?;
    Ok(([(header::CONTENT_TYPE, "model/gltf-binary")], file).into_response())
}

pub(super) fn nothing(plan: &Plan) -> String {
    match plan.problems.first() {
        Some(first) => format!("there is nothing to show: line {}: {}", first.line, first.message),
        None => "there is nothing to show".to_owned(),
    }
}

/// The motion sample by sample, as an Arrow stream
///
/// Time, line of the program, step; position, speed and acceleration of each axis and the wafer centre of each effector, in mm and degrees, as `jointplay cell run` writes them.
#[utoipa::path(
    post,
    path = "/api/v1/cell/samples",
    operation_id = "samples",
    request_body = MotionRequest,
    responses(
        (status = 200, description = "The samples", body = Binary, content_type = "application/vnd.apache.arrow.stream"),
        (status = 409, description = "Nothing moves", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is wrong", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn samples(
    State(app): State<App>,
    Body(request): Body<MotionRequest>,
) -> Result<Response, Problem> {
    let (desk, rate, peaks) = (desk(&app)?, request.rate()?, request.peaks);
    let (cell, program) = desk.texts(request.cell, request.program);
    let told = move || {
        let plan = desk.plan(cell, program);
        let refused = |why: String| Problem::request(StatusCode::CONFLICT, why);
        let recording = plan.recording().ok_or_else(|| refused(nothing(&plan)))?;
        let table = if peaks { export::samples_with_peaks } else { export::samples };
        let columns = table(&recording, rate).map_err(|error| refused(error.to_string()))?;
        arrow(columns).map_err(|error| Problem::broken(&error.to_string()))
    };
    let stream = app.work.run(told).await?;
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
    let set = move || {
        let wrong = |problem: cell::Problem| Problem::field("station", problem.to_string());
        let mut touching = Vec::new();
        let mut changed = cell::set_station(&text, &station, &changes).map_err(wrong)?;
        if let Some(by) = by {
            touching = contacts(&desk.plan(text, program), &station, by)?;
            changed = cell::note_station(&changed, &station, &touching).map_err(wrong)?;
        }
        let touching = touching.iter().map(|pair| pair.to_vec()).collect();
        Ok(Json(CellText { cell: changed, touching }))
    };
    app.work.run(set).await
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
