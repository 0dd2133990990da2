//! Tests of the server by requests.

mod cell;
mod cell_entry;
mod cell_export;
mod cell_jog;
mod cell_windows;
mod compression;
mod controller;
mod gallery;
mod mechanism;
mod mechanism_view;
mod meshes;
mod pose;
mod questions;
mod refusals;
mod robot_file;
mod studies;

use std::path::{Path, PathBuf};

use axum::Router;
use axum::body::Body;
use axum::http::{HeaderMap, Request, StatusCode, header};
use http_body_util::BodyExt as _;
use jointplay::format::robot::{self, Robot};
use serde_json::Value;
use tower::ServiceExt as _;

use crate::meshes::MeshFolder;
use crate::router;
use crate::state::AppState;
use crate::work::Deadlines;

const PORT: u16 = 4816;
const HOST: &str = "127.0.0.1:4816";

/// A folder of the repository; `None` in an archive of the crate, which has only what is published.
fn repository(folder: &str) -> Option<PathBuf> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    top.join("ARCHITECTURE.md").exists().then(|| top.join(folder))
}

/// A response.
struct Answer {
    status: StatusCode,
    headers: HeaderMap,
    bytes: Vec<u8>,
}

impl Answer {
    #[track_caller]
    fn json(&self) -> Value {
        serde_json::from_slice(&self.bytes).unwrap()
    }

    #[track_caller]
    fn header(&self, name: &str) -> &str {
        self.headers.get(name).map_or("", |value| value.to_str().unwrap())
    }
}

fn state(robot: Robot, folder: Option<&Path>) -> Result<AppState, robot::Error> {
    let folder = MeshFolder::of(folder, &robot)?;
    Ok(AppState::new(robot, folder, Deadlines::default()))
}

fn server() -> Router {
    router::router(state(robot::paper(), None).unwrap(), PORT)
}

/// Sends a request to a server of the robot of the paper.
fn send(request: Request<Body>) -> Answer {
    send_to(server(), request)
}

/// Sends a request to a server.
fn send_to(server: Router, request: Request<Body>) -> Answer {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(async {
        let response = server.oneshot(request).await.unwrap();
        let (head, body) = response.into_parts();
        let bytes = body.collect().await.unwrap().to_bytes().to_vec();
        Answer { status: head.status, headers: head.headers, bytes }
    })
}

fn get(path: &str) -> Answer {
    send(Request::get(path).header(header::HOST, HOST).body(Body::empty()).unwrap())
}

fn post(path: &str, body: &str) -> Answer {
    let request = Request::post(path)
        .header(header::HOST, HOST)
        .header(header::CONTENT_TYPE, "application/json")
        .body(Body::from(body.to_owned()));
    send(request.unwrap())
}

/// The document of a successful response.
#[track_caller]
fn answered(path: &str, body: &str) -> Value {
    let answer = post(path, body);
    assert_eq!(answer.status, StatusCode::OK, "{}", String::from_utf8_lossy(&answer.bytes));
    answer.json()
}

/// Sends a request that is answered with a problem document.
#[track_caller]
fn refused(path: &str, body: &str, status: u16, field: Option<&str>, detail: &str) {
    let answer = post(path, body);
    let text = String::from_utf8_lossy(&answer.bytes);
    assert_eq!(answer.status.as_u16(), status, "{body}: {text}");
    assert_eq!(answer.header("content-type"), "application/problem+json", "{body}");
    let problem = answer.json();
    assert_eq!(problem["status"], status, "{body}");
    assert_eq!(problem["field"].as_str(), field, "{body}: {text}");
    assert!(problem["detail"].as_str().unwrap().contains(detail), "{body}: {text}");
}

#[test]
fn the_robot_document_is_served() {
    let answer = get("/api/v1/robot");
    assert_eq!(answer.status, StatusCode::OK);
    let robot = answer.json();
    assert_eq!(robot["name"], "GPR of the paper");
    assert_eq!(robot["limbs"][2]["socket_radius_m"], 0.093218);
    assert_eq!(robot["limits"]["rod_max_m"], 0.754);
    let names: Vec<&str> = robot["virtualizations"]
        .as_array()
        .unwrap()
        .iter()
        .map(|virtualization| virtualization["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["radial", "polar", "offset", "planar"]);
    let slide = &robot["virtualizations"][1]["joints"][0];
    assert_eq!((&slide["symbol"], &slide["motion"]), (&"l".into(), &"linear".into()));
    assert_eq!(slide["nominal"], 0.093218, "a polar slide starts at the socket radius");
    let parquet = robot["series_formats"].as_array().unwrap().contains(&"parquet".into());
    assert_eq!(parquet, cfg!(feature = "parquet"), "only formats of this build are offered");
}

#[test]
fn the_description_is_served() {
    let answer = get("/api/v1/openapi.json");
    assert_eq!(answer.header("content-type"), "application/json");
    // Half a megabyte is no message.
    assert!(answer.bytes == router::description().into_bytes());
}

#[test]
fn the_page_is_part_of_the_crate() {
    let answer = get("/");
    assert_eq!(answer.status, StatusCode::OK);
    assert_eq!(answer.header("content-type"), "text/html; charset=utf-8");
    let text = String::from_utf8(answer.bytes.clone()).unwrap();
    // The script of the page is in the crate.
    let script = text.split("src=\"./").nth(1).and_then(|rest| rest.split('"').next());
    let script = get(&format!("/{}", script.expect("the page has a script")));
    assert_eq!(script.status, StatusCode::OK);
    assert_eq!(script.header("content-type"), "text/javascript; charset=utf-8");
    assert!(script.header("cache-control").contains("immutable"));
    assert!(answer.header("content-security-policy").starts_with("default-src 'none'"));
    assert_eq!(get("/assets/none.js").status, StatusCode::NOT_FOUND);
    assert_eq!(get("/../Cargo.toml").status, StatusCode::NOT_FOUND);
}
