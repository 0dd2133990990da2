//! `/api/v1/cell`: the files of the cell.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;

use crate::body::Body;
use crate::cell_files::SaveError;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::cell::{CellDocument, SaveRequest};

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
pub(crate) async fn cell_files(
    State(state): State<AppState>,
) -> Result<Json<CellDocument>, Problem> {
    let session = state.session()?;
    let read = move || session.reload().map_err(|why| Problem::request(StatusCode::CONFLICT, why));
    state.work.run(read).await.map(|files| Json(CellDocument::new(files)))
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
