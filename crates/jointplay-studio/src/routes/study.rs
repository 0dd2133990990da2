//! `POST /api/v1/study`: a motion, sample by sample.

use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};

use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::study::{self, Study};
use crate::wire::Binary;
use crate::wire::study::StudyRequest;

/// The samples of a motion, as an Arrow stream
///
/// Record batches of 4096 samples, sent as they are computed; `samples` in the metadata of the schema is the total number.
/// Columns are in SI units, which are part of their names; `status` is an index into `statuses` in the metadata, 0 for a solution.
/// Closing the connection stops the study. Limits of the robot are ignored.
#[utoipa::path(
    post,
    path = "/api/v1/study",
    operation_id = "study",
    request_body = StudyRequest,
    responses(
        (status = 200, description = "The samples", body = Binary, content_type = "application/vnd.apache.arrow.stream"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn study(
    State(state): State<AppState>,
    Body(request): Body<StudyRequest>,
) -> Result<Response, Problem> {
    let body = study::arrow(&state, Study::new(state.robot(request.robot.as_ref())?, request)?)?;
    let kind = (header::CONTENT_TYPE, "application/vnd.apache.arrow.stream");
    Ok(([kind], body).into_response())
}

/// The samples of a motion, as comma-separated values
///
/// The columns of `study`.
#[utoipa::path(
    post,
    path = "/api/v1/study.csv",
    operation_id = "study_csv",
    request_body = StudyRequest,
    responses(
        (status = 200, description = "The samples", body = String, content_type = "text/csv"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn study_csv(
    State(state): State<AppState>,
    Body(request): Body<StudyRequest>,
) -> Result<Response, Problem> {
    let body = study::csv(&state, Study::new(state.robot(request.robot.as_ref())?, request)?)?;
    let headers = [
        (header::CONTENT_TYPE, "text/csv; charset=utf-8"),
        (header::CONTENT_DISPOSITION, "attachment; filename=\"study.csv\""),
    ];
    Ok((headers, body).into_response())
}

/// The samples of a motion, as a Parquet file
///
/// The columns of `study`, of at most 500,000 samples; a build without Parquet support returns 501.
#[utoipa::path(
    post,
    path = "/api/v1/study.parquet",
    operation_id = "study_parquet",
    request_body = StudyRequest,
    responses(
        (status = 200, description = "The samples", body = Binary, content_type = "application/vnd.apache.parquet"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn study_parquet(
    State(state): State<AppState>,
    Body(request): Body<StudyRequest>,
) -> Result<Response, Problem> {
    let body =
        study::parquet(&state, Study::new(state.robot(request.robot.as_ref())?, request)?).await?;
    let headers = [
        (header::CONTENT_TYPE, "application/vnd.apache.parquet"),
        (header::CONTENT_DISPOSITION, "attachment; filename=\"study.parquet\""),
    ];
    Ok((headers, body).into_response())
}
