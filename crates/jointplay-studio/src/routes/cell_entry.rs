//! `/api/v1/cell/entry`: stations, bodies, arms and effectors of a cell file.

use axum::Json;
use axum::extract::State;
use jointplay::format::cell::{self, EntryAdded, EntryList};

use crate::body::Body;
use crate::cell_files::CellFiles;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::cell_entry::{EntryAction, EntryDocument, EntryRequest};

/// Add, duplicate or remove a station, a body, an arm or an effector in the text of a cell file
///
/// Comments and all other entries are preserved. Nothing is saved before both texts are `PUT`.
/// Bodies, parts and frames attached to an entry are duplicated and removed with it, and their allowed contacts; other references to a removed entry become errors of the cell or of the program.
/// An arm is duplicated and removed with its effectors and its own axes; an added or duplicated arm is mounted above the others, and an added or duplicated effector 10 mm above another one of its arm.
/// A robot of the catalogue is copied into the text of the cell before its arms change; a robot in a file of its own cannot be changed here.
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
    state.work.run(move || change(&text, &request, &session.files())).await.map(Json)
}

fn change(text: &str, request: &EntryRequest, files: &CellFiles) -> Result<EntryDocument, Problem> {
    let files = &mut |name: &str| files.named(name);
    let list = request.entry_list();
    let invalid = |problem: cell::Problem| Problem::field("name", problem.to_string());
    let added = |EntryAdded { text, name }| EntryDocument { cell: text, name: Some(name) };
    Ok(match request.action {
        EntryAction::Add => {
            let invalid = |problem: cell::Problem| {
                let field = if list == EntryList::Effector { "arm" } else { "name" };
                Problem::field(field, problem.to_string())
            };
            let added_entry = cell::add_entry(text, &request.new_entry()?, files);
            added(added_entry.map_err(invalid)?)
        }
        EntryAction::Duplicate => {
            let name = request.required_name()?;
            added(cell::duplicate_entry(text, list, name, files).map_err(invalid)?)
        }
        EntryAction::Remove => {
            let cell = cell::remove_entry(text, list, request.required_name()?).map_err(invalid)?;
            EntryDocument { cell, name: None }
        }
    })
}
