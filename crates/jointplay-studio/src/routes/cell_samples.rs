//! `/api/v1/cell/samples`: the motion of a program at a sampling rate.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, UInt32Array};
use arrow_ipc::writer::StreamWriter;
use arrow_schema::{ArrowError, DataType, Field, Schema};
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use jointplay::cell::StopRequested;
use jointplay::interop::export::{self, SampleOptions, select_columns};
use jointplay::report::table::{Column, Values};

use super::lookup::{interrupted, no_motion};
use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::Binary;
use crate::wire::cell_samples::SamplesRequest;
use crate::wire::program_parameters::with_parameters;

/// Maximum number of samples in a response.
const MAX_SAMPLES: f64 = 100_000.0;

/// The motion at a sampling rate, as an Arrow stream
///
/// Columns: time, program line, step; position, velocity and acceleration of each axis, and the wafer centre of each effector, in mm and degrees, as in the output of `jointplay cell run`; or those of `columns`.
/// Request long motions in several time ranges.
#[utoipa::path(
    post,
    path = "/api/v1/cell/samples",
    operation_id = "samples",
    request_body = SamplesRequest,
    responses(
        (status = 200, description = "The samples", body = Binary, content_type = "application/vnd.apache.arrow.stream"),
        (status = 409, description = "There is no motion", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn samples(
    State(state): State<AppState>,
    Body(request): Body<SamplesRequest>,
) -> Result<Response, Problem> {
    let (session, rate, peaks) = (state.session()?, request.rate()?, request.peaks);
    request.check_columns()?;
    let (from, to) = (request.from_s.unwrap_or(0.0), request.to_s.unwrap_or(f64::INFINITY));
    let names = request.columns;
    let (cell, program) = session.texts(request.cell, request.program);
    let program = with_parameters(program, request.parameters)?;
    let sampled = move |stop: StopRequested<'_>| {
        let plan = session.plan(cell, program, stop).map_err(interrupted)?;
        let refused = |why: String| Problem::request(StatusCode::CONFLICT, why);
        let motion_export = plan.motion_export().ok_or_else(|| refused(no_motion(&plan)))?;
        let range = [from.max(0.0), to.min(motion_export.motion.duration())];
        let rows = (range[1] - range[0]) * rate;
        if rows.is_nan() || rows > MAX_SAMPLES {
            let detail = format!(
                "{rows:.0} samples were requested, at most {MAX_SAMPLES:.0} are allowed: request a shorter range with from_s and to_s, or a lower rate with rate_hz"
            );
            return Err(Problem::field("to_s", detail));
        }
        let columns = names.map(|names| select_columns(motion_export.cell, &names)).transpose();
        let columns = columns.map_err(|error| Problem::field("columns", error.to_string()))?;
        let options = SampleOptions { rate, peaks, window: Some(range), columns };
        let columns = export::samples_with(&motion_export, &options);
        let columns = columns.map_err(|error| refused(error.to_string()))?;
        arrow(columns).map_err(|error| Problem::broken(&error.to_string()))
    };
    let stream = state.work.run_while_awaited(sampled).await?;
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
