//! Mesh files are served from the folder of the robot file only.

use std::path::Path;

use axum::Router;
use axum::body::Body;
use axum::http::{Request, StatusCode, header};
use jointplay::format::robot::{self, Robot};

use super::{Answer, HOST, PORT, get, send_to, state};

fn with_mesh(path: &str) -> Robot {
    let kind = format!("kind = \"gpr\"\nbase_mesh = \"{path}\"");
    robot::parse(&robot::PAPER.replacen("kind = \"gpr\"", &kind, 1)).unwrap()
}

fn ask(router: Router, path: &str) -> Answer {
    let request = Request::get(path).header(header::HOST, HOST).body(Body::empty());
    send_to(router, request.unwrap())
}

#[test]
fn a_mesh_is_served() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("shapes")).unwrap();
    std::fs::write(folder.path().join("shapes/base.stl"), "solid base").unwrap();
    let state = state(with_mesh("shapes/base.stl"), Some(folder.path())).unwrap();
    let server = || crate::router::router(state.clone(), PORT);
    let robot = ask(server(), "/api/v1/robot").json();
    assert_eq!(robot["base_mesh"]["url"], "/api/v1/meshes/base");
    assert_eq!(robot["base_mesh"]["format"], "stl");
    assert!(robot["platform_mesh"].is_null());
    let mesh = ask(server(), "/api/v1/meshes/base");
    assert_eq!(
        (mesh.header("content-type"), mesh.bytes.as_slice()),
        ("model/stl", &b"solid base"[..])
    );
    assert_eq!(ask(server(), "/api/v1/meshes/platform").status, StatusCode::NOT_FOUND);
    // It has grown since the start.
    let grown = std::fs::File::create(folder.path().join("shapes/base.stl")).unwrap();
    grown.set_len(50_000_001).unwrap();
    assert_eq!(ask(server(), "/api/v1/meshes/base").status, StatusCode::NOT_FOUND);
    std::fs::remove_file(folder.path().join("shapes/base.stl")).unwrap();
    assert_eq!(ask(server(), "/api/v1/meshes/base").status, StatusCode::NOT_FOUND);
}

#[track_caller]
fn refused(path: &str, folder: Option<&Path>, why: &str) {
    let Err(error) = state(with_mesh(path), folder) else { panic!("{path} is served") };
    let shown = error.with_excerpt("my.toml");
    assert!(shown.starts_with("my.toml:7:13: the mesh") && shown.contains(why), "{shown}");
}

#[test]
fn a_missing_mesh_is_an_error_at_the_start() {
    assert_eq!(get("/api/v1/meshes/base").status, StatusCode::NOT_FOUND);
    let folder = tempfile::tempdir().unwrap();
    refused("base.stl", Some(folder.path()), "cannot be read");
    refused("base.stl", None, "was not read from a file");
    std::fs::create_dir(folder.path().join("folder.stl")).unwrap();
    refused("folder.stl", Some(folder.path()), "not a file");
    let large = std::fs::File::create(folder.path().join("large.stl")).unwrap();
    large.set_len(50_000_001).unwrap();
    refused("large.stl", Some(folder.path()), "limit of 50000000 bytes");
}

#[cfg(unix)]
#[test]
fn symbolic_links_cannot_leave_the_folder() {
    let (folder, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let secret = elsewhere.path().join("secret.stl");
    std::fs::write(&secret, "secret").unwrap();
    let link = folder.path().join("base.stl");
    std::os::unix::fs::symlink(&secret, &link).unwrap();
    refused("base.stl", Some(folder.path()), "leads out of the folder");
    std::os::unix::fs::symlink(elsewhere.path(), folder.path().join("shapes")).unwrap();
    refused("shapes/secret.stl", Some(folder.path()), "leads out of the folder");
    // Neither if the file is replaced by a link while the server runs.
    std::fs::remove_file(&link).unwrap();
    std::fs::write(&link, "own").unwrap();
    let state = state(with_mesh("base.stl"), Some(folder.path())).unwrap();
    std::fs::remove_file(&link).unwrap();
    std::os::unix::fs::symlink(&secret, &link).unwrap();
    let mesh = ask(crate::router::router(state, PORT), "/api/v1/meshes/base");
    assert_eq!(mesh.status, StatusCode::NOT_FOUND);
}
