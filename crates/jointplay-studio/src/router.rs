//! The routes of the HTTP API and their OpenAPI description.

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::{HeaderMap, Method, StatusCode, Uri};
use axum::middleware;
use axum::response::{IntoResponse as _, Response};
use axum::routing::{MethodFilter, MethodRouter, get};
use pastey::paste;
use utoipa::openapi::HttpMethod;
use utoipa::{OpenApi, Path};

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

/// From the handlers: the routes, each with the path and the methods of its description, and all descriptions as a document.
///
/// The server needs no more of the descriptions than this; the document is embedded, see [`page::DESCRIPTION`].
macro_rules! api {
    ($($module:ident::$handler:ident),+ $(,)?) => { paste! {
        fn api() -> Router<AppState> {
            Router::new()
                $(.route(
                    &$module::[<__path_ $handler>]::path(),
                    MethodRouter::new().on(methods::<$module::[<__path_ $handler>]>(), $module::$handler),
                ))+
        }

        fn described() -> utoipa::openapi::OpenApi {
            // Without the name of its module a handler has no tag.
            $(use $module::[<__path_ $handler>];)+

            #[derive(OpenApi)]
            #[openapi(
                info(
                    title = "jointplay studio",
                    description = "The three-rod robot of this server: poses, models, mobility, sensitivity, studies.\n\nUnits are SI and part of the field names, such as `rods_m` and `heading_rad`; documents of the command line are in mm and degrees. Lengths in messages are in the unit of the request header `Length-Unit`: `mm` (default) or `in`. Every error is a problem document (RFC 9457) with the name of the field.",
                    license(name = "MIT OR Apache-2.0", identifier = "MIT OR Apache-2.0")
                ),
                tags((name = "studio")),
                paths($($handler),+)
            )]
            struct Description;

            Description::openapi()
        }
    } };
}

api![
    robot::robot,
    robot_file::robot_file,
    robot_file::save_robot,
    robot_file::open_robot,
    mesh::base_mesh,
    mesh::platform_mesh,
    pose::pose,
    quantity::quantity,
    forward::forward,
    inverse::inverse,
    mobility::mobility,
    sensitivity::sensitivity,
    compare::compare,
    mechanism::mechanism_poses,
    mechanism_file::mechanism_file,
    mechanism_file::save_mechanism,
    mechanism_file::catalogue_entries,
    mechanism_file::catalogue_picture,
    mechanism_open::mechanism_open,
    mechanism_open::mechanism_configuration,
    mechanism_open::mechanism_drive,
    mechanism_reach::mechanism_reach,
    mechanism_export::mechanism_export,
    mechanism_mobility::mobility_of_mechanism,
    mechanism_motions::instantaneous_motions,
    mechanism_motions::assembly_modes,
    mechanism_suggest::suggest_virtual_joints,
    study::study,
    study::study_csv,
    study::study_parquet,
    cell::cell_files,
    cell::save_cell,
    cell_plan::plan,
    cell_samples::samples,
    cell_export::export,
    cell_station::station,
    cell_entry::entry,
    cell_parts::instructions,
    cell_parts::violations,
    cell_parts::overview,
    cell_parts::window,
    cell_parts::scene,
    cell_jog::jog,
    controller::controller,
    controller::host,
];

/// Methods of a described path.
fn methods<P: Path>() -> MethodFilter {
    let filters = P::methods().into_iter().map(|method| match method {
        HttpMethod::Get => MethodFilter::GET,
        HttpMethod::Post => MethodFilter::POST,
        HttpMethod::Put => MethodFilter::PUT,
        HttpMethod::Delete => MethodFilter::DELETE,
        HttpMethod::Options => MethodFilter::OPTIONS,
        HttpMethod::Head => MethodFilter::HEAD,
        HttpMethod::Patch => MethodFilter::PATCH,
        HttpMethod::Trace => MethodFilter::TRACE,
    });
    filters.reduce(MethodFilter::or).expect("a described path has a method")
}

/// The OpenAPI description of the server from its types, as JSON text: what the file `openapi.json` of this crate has to be.
#[must_use]
pub fn description() -> String {
    let text = described().to_pretty_json().expect("a description has string keys only");
    text + "\n"
}

/// All routes of the server, for requests on `port`.
pub(crate) fn router(state: AppState, port: u16) -> Router {
    api()
        .route(page::DESCRIPTION, get(file))
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

/// Serves a file.
async fn file(method: Method, uri: Uri, headers: HeaderMap) -> Response {
    page::answer(&method, uri.path(), &headers)
}

/// Serves a file of the page, or a problem for an unknown path of the API.
async fn fallback(method: Method, uri: Uri, headers: HeaderMap) -> Response {
    let path = uri.path();
    if path.starts_with("/api/") {
        let detail =
            format!("unknown path {path}; see /api/v1/openapi.json for the available paths");
        return Problem::request(StatusCode::NOT_FOUND, detail).into_response();
    }
    page::answer(&method, path, &headers)
}

async fn method_not_allowed(method: Method, uri: Uri) -> Problem {
    let detail = format!(
        "{} does not accept {method}; see /api/v1/openapi.json for its methods",
        uri.path()
    );
    Problem::request(StatusCode::METHOD_NOT_ALLOWED, detail)
}
