//! `/api/v1/mechanism`: the mechanism that the server was started with; `/api/v1/catalogue`: those that are included.

use axum::Json;
use axum::extract::{Path, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use jointplay::format::catalogue;
use jointplay::interop::FileKind;
use jointplay::mechanism::pose_commanded;
use jointplay::plot::{Labels, MechanismPicture};

use crate::body::Body;
use crate::cell_files::SaveError;
use crate::mechanism_file::MechanismFileOnDisk;
use crate::mechanism_source;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::mechanism_view::{
    CatalogueEntry, MechanismFileDocument, MechanismSource, SaveMechanismRequest,
};

impl From<MechanismFileOnDisk> for MechanismFileDocument {
    fn from(file: MechanismFileOnDisk) -> Self {
        let (version, writable) = (file.version(), file.path.is_some());
        Self { name: file.name, writable, text: file.text, loops: file.loops, version }
    }
}

/// The text of the mechanism, read from disk
#[utoipa::path(
    get,
    path = "/api/v1/mechanism",
    operation_id = "mechanism_file",
    responses(
        (status = 200, description = "The text", body = MechanismFileDocument),
        (status = 404, description = "The server was started without a mechanism", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The file cannot be read", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn mechanism_file(
    State(state): State<AppState>,
) -> Result<Json<MechanismFileDocument>, Problem> {
    let session = state.mechanism()?;
    let read = move || session.reload().map_err(|why| Problem::request(StatusCode::CONFLICT, why));
    state.work.run(read).await.map(|file| Json(file.into()))
}

/// Save the text of the mechanism
///
/// The file is written completely, or not at all. Errors in the text do not matter.
/// With `replaces`, the text is saved only if the file on disk still has this version.
#[utoipa::path(
    put,
    path = "/api/v1/mechanism",
    operation_id = "save_mechanism",
    request_body = SaveMechanismRequest,
    responses(
        (status = 200, description = "The saved text", body = MechanismFileDocument),
        (status = 404, description = "The server was started without a mechanism", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The file cannot be saved; if it has changed on disk, `field` is `replaces`", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn save_mechanism(
    State(state): State<AppState>,
    Body(SaveMechanismRequest { text, replaces }): Body<SaveMechanismRequest>,
) -> Result<Json<MechanismFileDocument>, Problem> {
    let session = state.mechanism()?;
    let save = move || {
        session.save(text, replaces.as_deref()).map_err(|why| match why {
            SaveError::Changed(why) => Problem::outdated("replaces", why),
            SaveError::Unwritable(why) => Problem::request(StatusCode::CONFLICT, why),
        })
    };
    state.work.run(save).await.map(|file| Json(file.into()))
}

/// Kinds of catalogue entries that are mechanisms.
const SHOWN: [FileKind; 2] = [FileKind::Mechanism, FileKind::ThreeRods];

/// The included mechanisms
#[utoipa::path(
    get,
    path = "/api/v1/catalogue",
    operation_id = "catalogue",
    responses((status = 200, description = "The entries, by name", body = [CatalogueEntry]))
)]
pub(crate) async fn catalogue_entries() -> Json<Vec<CatalogueEntry>> {
    let shown = |entry: &&catalogue::Entry| {
        FileKind::detect(entry.text).is_some_and(|kind| SHOWN.contains(&kind))
    };
    let document = |entry: &catalogue::Entry| CatalogueEntry {
        name: entry.name.to_owned(),
        title: entry.title(),
        text: entry.text.to_owned(),
    };
    Json(catalogue::entries().iter().filter(shown).map(document).collect())
}

/// Width of a picture (px).
const WIDTH: f64 = 240.0;

/// A picture of an included mechanism
#[utoipa::path(
    get,
    path = "/api/v1/catalogue/{name}/picture",
    operation_id = "catalogue_picture",
    params(("name" = String, Path, description = "Name of the entry")),
    responses(
        (status = 200, description = "The picture (SVG)", body = String, content_type = "image/svg+xml"),
        (status = 404, description = "There is no mechanism with this name", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn catalogue_picture(
    State(state): State<AppState>,
    Path(name): Path<String>,
) -> Result<Response, Problem> {
    let svg = state.work.run(move || picture(&name)).await?;
    Ok(([(header::CONTENT_TYPE, "image/svg+xml")], svg).into_response())
}

fn picture(name: &str) -> Result<String, Problem> {
    let unknown = || {
        Problem::request(StatusCode::NOT_FOUND, format!("the catalogue has no mechanism {name:?}"))
    };
    let entry = catalogue::find(name).ok_or_else(unknown)?;
    let text = entry.text.to_owned();
    let source = MechanismSource { text, loops: None, parameters: Default::default() };
    let read = mechanism_source::read(&source).map_err(|_| unknown())?;
    let mechanism = &read.file.mechanism;
    let closed = pose_commanded(mechanism, &[], None)?.closed.coordinates;
    let picture = MechanismPicture::new(mechanism, closed)
        .with_labels(Labels::None)
        .with_title("")
        .with_width(WIDTH);
    picture.to_svg().map_err(|error| Problem::broken(&error.to_string()))
}
