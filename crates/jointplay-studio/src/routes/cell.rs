//! `/api/v1/cell`: the files of the cell.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;

use crate::body::Body;
use crate::cell_files::SaveError;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::cell::{CellDocument, SaveRequest};

/// The texts of cell file and program file, read from disk
#[utoipa::path(
    get,
    path = "/api/v1/cell",
    operation_id = "cell",
    responses(
        (status = 200, description = "The texts of both files", body = CellDocument),
        (status = 404, description = "The server has no cell", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The files cannot be read", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn cell_files(
    State(state): State<AppState>,
) -> Result<Json<CellDocument>, Problem> {
    let session = state.session()?;
    let read = move || session.reload().map_err(|why| Problem::request(StatusCode::CONFLICT, why));
    state.work.run(read).await.map(|files| Json(CellDocument::new(files)))
}

/// Save both texts
///
/// Both files are written completely, or neither. Errors in the texts do not matter.
/// With `replaces`, the texts are saved only if the files on disk still have this version.
#[utoipa::path(
    put,
    path = "/api/v1/cell",
    operation_id = "save_cell",
    request_body = SaveRequest,
    responses(
        (status = 200, description = "The saved texts", body = CellDocument),
        (status = 409, description = "The files cannot be saved; if they have changed on disk, `field` is `replaces`", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn save_cell(
    State(state): State<AppState>,
    Body(SaveRequest { cell, program, replaces }): Body<SaveRequest>,
) -> Result<Json<CellDocument>, Problem> {
    let session = state.session()?;
    let save = move || {
        session.save(cell, program, replaces.as_deref()).map_err(|why| match why {
            SaveError::Changed(why) => Problem::outdated("replaces", why),
            SaveError::Unwritable(why) => Problem::request(StatusCode::CONFLICT, why),
        })
    };
    state.work.run(save).await.map(|files| Json(CellDocument::new(files)))
}
