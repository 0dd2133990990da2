//! Stations and bodies of a cell file, added, duplicated and removed.

use axum::http::{Method, StatusCode};
use serde_json::{Value, json};

use super::cell::{ask, plan, server};
use crate::cell_files::CellFiles;

#[test]
fn entries_are_added_duplicated_and_removed_in_the_text() {
    let server = server(CellFiles::example());
    let names = |cell: &Value, list: &str| -> Vec<String> {
        let found = plan(&server, &json!({ "cell": cell, "program": "HOME\n" }));
        assert_eq!(found["diagnostics"], json!([]));
        let all = found[list].as_array().unwrap();
        all.iter().map(|one| one["name"].as_str().unwrap().to_owned()).collect()
    };
    let change = |body: &Value| {
        let answer = ask(&server, Method::POST, "cell/entry", body);
        assert_eq!(answer.status, StatusCode::OK, "{}", String::from_utf8_lossy(&answer.bytes));
        answer.json()
    };
    let added = change(&json!({ "action": "add", "list": "body", "position_m": [0.0, 0.9, 0.3] }));
    assert_eq!(added["name"], "body-1");
    assert!(names(&added["cell"], "bodies").contains(&"body-1".to_owned()));
    let twice = change(
        &json!({ "cell": added["cell"], "action": "duplicate", "list": "station", "name": "PM1" }),
    );
    assert_eq!(twice["name"], "PM2");
    assert!(names(&twice["cell"], "stations").contains(&"PM2".to_owned()));
    let filled = ask(
        &server,
        Method::POST,
        "cell/station",
        &json!({ "cell": twice["cell"], "station": "LP2", "wafers": { "slots": [2, 7] } }),
    );
    let filled = filled.json()["cell"].clone();
    let wafers = names(&filled, "wafers");
    let of_it: Vec<&String> = wafers.iter().filter(|name| name.contains("LP2")).collect();
    assert_eq!(of_it.len(), 2, "{wafers:?}");
    let removed =
        change(&json!({ "cell": filled, "action": "remove", "list": "station", "name": "PM2" }));
    assert_eq!(removed["name"], Value::Null);
    assert!(!removed["cell"].as_str().unwrap().contains("PM2"));
}

#[test]
fn unknown_and_missing_names_are_refused() {
    let server = server(CellFiles::example());
    for (body, expected) in [
        (json!({ "action": "remove", "list": "body" }), "needs a name"),
        (json!({ "action": "remove", "list": "station", "name": "LP9" }), "LP1"),
        (json!({ "action": "duplicate", "list": "body", "name": "walls" }), "wall"),
        (json!({ "action": "add", "list": "body", "position_m": [0.0, 1e9, 0.0] }), "1000"),
    ] {
        let answer = ask(&server, Method::POST, "cell/entry", &body);
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{body}");
        let detail = answer.json()["detail"].as_str().unwrap().to_owned();
        assert!(detail.contains(expected), "{detail}");
    }
}
