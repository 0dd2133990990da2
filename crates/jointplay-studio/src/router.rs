//! The routes of the HTTP API and their OpenAPI description.

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::{StatusCode, Uri, header};
use axum::middleware;
use axum::response::IntoResponse;
use axum::routing::get;
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::body::MAX_BODY_BYTES;
use crate::compression;
use crate::guard::{self, Guard};
use crate::length_header;
use crate::page;
use crate::problem::Problem;
use crate::routes::{
    cell, cell_entry, cell_export, cell_jog, cell_parts, cell_plan, cell_samples, cell_station,
    compare, controller, forward, inverse, mechanism, mechanism_export, mechanism_file,
    mechanism_mobility, mechanism_motions, mechanism_open, mechanism_reach, mechanism_suggest,
    mesh, mobility, pose, quantity, robot, robot_file, sensitivity, study,
};
use crate::state::AppState;

#[derive(OpenApi)]
#[openapi(
    info(
        title = "jointplay studio",
        description = "The three-rod robot of this server: poses, models, mobility, sensitivity, studies.\n\nUnits are SI and part of the field names, such as `rods_m` and `heading_rad`; documents of the command line are in mm and degrees. Lengths in messages are in the unit of the request header `Length-Unit`: `mm` (default) or `in`. Every error is a problem document (RFC 9457) with the name of the field.",
        license(name = "MIT OR Apache-2.0", identifier = "MIT OR Apache-2.0")
    ),
    tags((name = "studio"))
)]
struct Description;

fn api() -> OpenApiRouter<AppState> {
    OpenApiRouter::with_openapi(Description::openapi())
        .routes(routes!(robot::robot))
        .routes(routes!(robot_file::robot_file, robot_file::save_robot))
        .routes(routes!(robot_file::open_robot))
        .routes(routes!(mesh::base_mesh))
        .routes(routes!(mesh::platform_mesh))
        .routes(routes!(pose::pose))
        .routes(routes!(quantity::quantity))
        .routes(routes!(forward::forward))
        .routes(routes!(inverse::inverse))
        .routes(routes!(mobility::mobility))
        .routes(routes!(sensitivity::sensitivity))
        .routes(routes!(compare::compare))
        .routes(routes!(mechanism::mechanism_poses))
        .routes(routes!(mechanism_file::mechanism_file, mechanism_file::save_mechanism))
        .routes(routes!(mechanism_file::catalogue_entries))
        .routes(routes!(mechanism_file::catalogue_picture))
        .routes(routes!(mechanism_open::mechanism_open))
        .routes(routes!(mechanism_open::mechanism_configuration))
        .routes(routes!(mechanism_open::mechanism_drive))
        .routes(routes!(mechanism_reach::mechanism_reach))
        .routes(routes!(mechanism_export::mechanism_export))
        .routes(routes!(mechanism_mobility::mobility_of_mechanism))
        .routes(routes!(mechanism_motions::instantaneous_motions))
        .routes(routes!(mechanism_motions::assembly_modes))
        .routes(routes!(mechanism_suggest::suggest_virtual_joints))
        .routes(routes!(study::study))
        .routes(routes!(study::study_csv))
        .routes(routes!(study::study_parquet))
        .routes(routes!(cell::cell_files, cell::save_cell))
        .routes(routes!(cell_plan::plan))
        .routes(routes!(cell_samples::samples))
        .routes(routes!(cell_export::export))
        .routes(routes!(cell_station::station))
        .routes(routes!(cell_entry::entry))
        .routes(routes!(cell_parts::instructions))
        .routes(routes!(cell_parts::violations))
        .routes(routes!(cell_parts::overview))
        .routes(routes!(cell_parts::window))
        .routes(routes!(cell_parts::scene))
        .routes(routes!(cell_jog::jog))
        .routes(routes!(controller::controller))
        .routes(routes!(controller::host))
}

/// The OpenAPI description of the server, as JSON text.
#[must_use]
pub fn description() -> String {
    let described = api().into_openapi();
    let text = described.to_pretty_json().expect("a description has string keys only");
    text + "\n"
}

/// All routes of the server, for requests on `port`.
pub(crate) fn router(state: AppState, port: u16) -> Router {
    let (router, _) = api().split_for_parts();
    let described = description();
    let describe =
        || async move { ([(header::CONTENT_TYPE, "application/json")], described).into_response() };
    router
        .route("/api/v1/openapi.json", get(describe))
        .fallback(fallback)
        .method_not_allowed_fallback(method_not_allowed)
        .layer(DefaultBodyLimit::max(MAX_BODY_BYTES))
        .layer(middleware::from_fn(compression::compress))
        .layer(middleware::from_fn(length_header::serve))
        .layer(middleware::from_fn_with_state(
            Guard::new(port, state.work.deadlines.request),
            guard::check,
        ))
        .with_state(state)
}

/// Serves a file of the page, or a problem for an unknown path of the API.
async fn fallback(method: axum::http::Method, uri: Uri) -> axum::response::Response {
    let path = uri.path();
    if path.starts_with("/api/") {
        let detail =
            format!("unknown path {path}; see /api/v1/openapi.json for the available paths");
        return Problem::request(StatusCode::NOT_FOUND, detail).into_response();
    }
    page::answer(&method, path)
}

async fn method_not_allowed(method: axum::http::Method, uri: Uri) -> Problem {
    let detail = format!(
        "{} does not accept {method}; see /api/v1/openapi.json for its methods",
        uri.path()
    );
    Problem::request(StatusCode::METHOD_NOT_ALLOWED, detail)
}
