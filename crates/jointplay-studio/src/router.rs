//! Which path is answered by what, and the OpenAPI description.

use std::sync::Arc;

use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::{StatusCode, Uri, header};
use axum::middleware;
use axum::response::IntoResponse;
use axum::routing::get;
use jointplay::format::robot::Robot;
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::body::LARGEST_BODY;
use crate::cell::Desk;
use crate::guard::{self, Guard};
use crate::meshes::Folder;
use crate::page;
use crate::problem::Problem;
use crate::routes::{
    cell, cell_jog, cell_parts, compare, forward, inverse, mesh, mobility, pose, robot,
    sensitivity, study,
};
use crate::work::{Patience, Work};

/// What all requests share.
#[derive(Clone)]
pub(crate) struct App {
    pub(crate) robot: Arc<Robot>,
    pub(crate) work: Work,
    pub(crate) folder: Folder,
    /// The cell that is shown beside the robot.
    pub(crate) desk: Option<Desk>,
}

impl App {
    pub(crate) fn new(robot: Robot, folder: Folder, patience: Patience) -> Self {
        // Each endpoint checks the limits, or computes beyond them where it is asked to.
        let robot = Robot { gpr: robot.gpr.without_limit_checks(), ..robot };
        Self { robot: Arc::new(robot), work: Work::new(patience), folder, desk: None }
    }
}

#[derive(OpenApi)]
#[openapi(
    info(
        title = "jointplay studio",
        description = "The three-rod robot of this server: poses, models, mobility, sensitivity, studies.\n\nUnits are SI, and each name carries its own: `rods_m`, `yaw_rad`; documents of the command line keep their mm and degrees. Every error is a problem document (RFC 9457) that names the field.",
        license(name = "MIT OR Apache-2.0", identifier = "MIT OR Apache-2.0")
    ),
    tags((name = "studio"))
)]
struct Description;

fn api() -> OpenApiRouter<App> {
    OpenApiRouter::with_openapi(Description::openapi())
        .routes(routes!(robot::robot))
        .routes(routes!(mesh::base_mesh))
        .routes(routes!(mesh::platform_mesh))
        .routes(routes!(pose::pose))
        .routes(routes!(forward::forward))
        .routes(routes!(inverse::inverse))
        .routes(routes!(mobility::mobility))
        .routes(routes!(sensitivity::sensitivity))
        .routes(routes!(compare::compare))
        .routes(routes!(study::study))
        .routes(routes!(study::study_csv))
        .routes(routes!(study::study_parquet))
        .routes(routes!(cell::cell_files, cell::save_cell))
        .routes(routes!(cell::plan))
        .routes(routes!(cell::samples))
        .routes(routes!(cell::station))
        .routes(routes!(cell_parts::instructions))
        .routes(routes!(cell_parts::violations))
        .routes(routes!(cell_parts::overview))
        .routes(routes!(cell_parts::window))
        .routes(routes!(cell_parts::scene))
        .routes(routes!(cell_jog::jog))
}

/// The OpenAPI description of the server, as JSON text.
#[must_use]
pub fn description() -> String {
    let described = api().into_openapi();
    let text = described.to_pretty_json().expect("a description has string keys only");
    text + "\n"
}

/// Everything that the server answers on a port.
pub(crate) fn router(app: App, port: u16) -> Router {
    let (router, _) = api().split_for_parts();
    let described = description();
    let describe =
        || async move { ([(header::CONTENT_TYPE, "application/json")], described).into_response() };
    router
        .route("/api/v1/openapi.json", get(describe))
        .fallback(fallback)
        .method_not_allowed_fallback(wrong_method)
        .layer(DefaultBodyLimit::max(LARGEST_BODY))
        .layer(middleware::from_fn_with_state(
            Guard::new(port, app.work.patience.request),
            guard::check,
        ))
        .with_state(app)
}

/// Whatever is no endpoint: a file of the page, or nothing.
async fn fallback(method: axum::http::Method, uri: Uri) -> axum::response::Response {
    let path = uri.path();
    if path.starts_with("/api/") {
        let detail = format!("there is no {path}; /api/v1/openapi.json describes what there is");
        return Problem::request(StatusCode::NOT_FOUND, detail).into_response();
    }
    page::answer(&method, path)
}

async fn wrong_method(method: axum::http::Method, uri: Uri) -> Problem {
    let detail =
        format!("{} does not take {method}; /api/v1/openapi.json says what it takes", uri.path());
    Problem::request(StatusCode::METHOD_NOT_ALLOWED, detail)
}
