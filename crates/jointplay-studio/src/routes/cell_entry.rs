//! `/api/v1/cell/entry`: stations and bodies of a cell file.

use axum::Json;
use axum::extract::State;
use jointplay::format::cell::{self, EntryAdded};

use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::cell_entry::{EntryAction, EntryDocument, EntryRequest};

/// Add, duplicate or remove a station or a body in the text of a cell file
///
/// Comments and all other entries are preserved. Nothing is saved before both texts are `PUT`.
/// A removed entry is also removed from the allowed contacts; other references to it become errors of the cell.
#[utoipa::path(
    post,
    path = "/api/v1/cell/entry",
    operation_id = "entry",
    request_body = EntryRequest,
    responses(
        (status = 200, description = "The text of the cell file", body = EntryDocument),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn entry(
    State(state): State<AppState>,
    Body(mut request): Body<EntryRequest>,
) -> Result<Json<EntryDocument>, Problem> {
    let session = state.session()?;
    let (text, _) = session.texts(request.cell.take(), None);
    state.work.run(move || change(&text, &request)).await.map(Json)
}

fn change(text: &str, request: &EntryRequest) -> Result<EntryDocument, Problem> {
    let list = request.entry_list();
    let invalid = |problem: cell::Problem| Problem::field("name", problem.to_string());
    let added = |EntryAdded { text, name }| EntryDocument { cell: text, name: Some(name) };
    Ok(match request.action {
        EntryAction::Add => added(cell::add_entry(text, &request.new_entry()?).map_err(invalid)?),
        EntryAction::Duplicate => {
            added(cell::duplicate_entry(text, list, request.required_name()?).map_err(invalid)?)
        }
        EntryAction::Remove => {
            let cell = cell::remove_entry(text, list, request.required_name()?).map_err(invalid)?;
            EntryDocument { cell, name: None }
        }
    })
}
