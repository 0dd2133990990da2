//! The simulated controller: its hosts, and their robots at the present time.

use std::time::{Duration, Instant};

use axum::Router;
use axum::http::{Method, StatusCode};
use jointplay::format::{cell, robot};
use jointplay::interop::host::{HostLanguage, HostSession};
use serde_json::{Value, json};

use super::cell::{ask, fetch};
use super::{PORT, get, state};
use crate::cell_files::CellFiles;
use crate::controller::ControllerMonitor;
use crate::session::WorkcellSession;

fn server(monitor: &ControllerMonitor) -> Router {
    let mut state = state(robot::paper(), None).unwrap();
    state.cell = Some(WorkcellSession::new(CellFiles::example()));
    state.controller = Some(monitor.clone());
    crate::router::router(state, PORT)
}

fn positions(document: &Value) -> Vec<f64> {
    let axes = document["axes"].as_array().unwrap();
    axes.iter().map(|axis| axis["position"].as_f64().unwrap()).collect()
}

#[test]
fn a_server_without_a_controller_returns_404() {
    assert_eq!(get("/api/v1/controller").status, StatusCode::NOT_FOUND);
    assert_eq!(get("/api/v1/robot").json()["controller"], false);
}

#[test]
fn the_robot_of_a_host_is_where_its_motion_is_planned_at_this_time() {
    let monitor = ControllerMonitor::new("127.0.0.1:7000".to_owned(), "neutral".to_owned(), 0.5);
    let server = server(&monitor);
    assert_eq!(fetch(&server, "controller").json()["hosts"], json!([]));
    assert_eq!(fetch(&server, "controller/hosts/1").status, StatusCode::NOT_FOUND);

    let language = HostLanguage::neutral();
    let cell = cell::read(cell::EXAMPLE, &mut |_| Err("no files".to_owned())).unwrap();
    let mut session = HostSession::new(&language, cell, 0.5).unwrap();
    session.receive(b"GET LP1 3 A", 0.0).unwrap();
    // A connection two seconds ago: one second of the motion has passed, and little more.
    let start = Instant::now().checked_sub(Duration::from_secs(2)).unwrap();
    let place = monitor.connect("127.0.0.1:50000".to_owned(), start, session.snapshot());
    let found = fetch(&server, "controller").json();
    assert_eq!(found["speed"], 0.5);
    let host = json!({ "number": 1, "peer": "127.0.0.1:50000", "command": "GET LP1 3 A" });
    assert_eq!(found["hosts"], json!([host]));
    let moving = fetch(&server, "controller/hosts/1").json();
    let elapsed = moving["elapsed_s"].as_f64().unwrap();
    assert!(elapsed >= 1.0);
    assert_eq!(moving["events"][0]["outcome"], "accepted");
    let program = json!({ "program": "GET LP1 SLOT 3 WITH A\n", "time_s": elapsed });
    let planned = ask(&server, Method::POST, "cell/jog", &program).json();
    assert_eq!(positions(&moving), positions(&planned));
    assert_eq!(moving["frames"], planned["frames"]);
    assert!(
        moving["resting"]
            .as_array()
            .unwrap()
            .contains(&json!({ "wafer": "wafer of LP1 4", "station": "LP1", "slot": 4 }))
    );

    session.advance(session.next_event().unwrap()).unwrap();
    session.receive(b"GET LP1 3 B", 100.0).unwrap();
    place.update(session.snapshot());
    let rest = fetch(&server, "controller/hosts/1").json();
    assert_eq!(rest["command"], Value::Null);
    assert_eq!(rest["effectors"][0], json!({ "name": "A", "loaded": true }));
    let refused = rest["events"].as_array().unwrap().last().unwrap();
    assert_eq!((&refused["outcome"], &refused["reason"]), (&json!("refused"), &json!("invalid")));
    assert!(refused["message"].as_str().unwrap().contains("slot 3 of LP1 is empty"));
    drop(place);
    assert_eq!(fetch(&server, "controller").json()["hosts"], json!([]));
}
