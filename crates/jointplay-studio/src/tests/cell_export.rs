//! Exports of the motion of a program as files.

use axum::http::{Method, StatusCode};
use serde_json::{Value, json};

use super::Answer;
use super::cell::{SHORT, ask, plan, server};
use crate::cell_files::CellFiles;

fn exported(request: &Value) -> Answer {
    ask(&server(CellFiles::example()), Method::POST, "cell/export", request)
}

#[track_caller]
fn text(answer: &Answer) -> String {
    assert_eq!(answer.status, StatusCode::OK, "{}", String::from_utf8_lossy(&answer.bytes));
    String::from_utf8(answer.bytes.clone()).unwrap()
}

/// The example cell with its wall in the path of the blades.
fn blocked() -> String {
    let (from, to) =
        ("position_mm = [100.0, -600.0, 500.0]", "position_mm = [-330.0, 330.0, 500.0]");
    assert!(jointplay::format::cell::EXAMPLE.contains(from));
    jointplay::format::cell::EXAMPLE.replace(from, to)
}

#[test]
fn samples_scene_and_controller_text_have_the_duration_of_the_plan() {
    let server = server(CellFiles::example());
    let duration = plan(&server, &json!({ "program": SHORT }))["report"]["duration_s"].clone();
    let duration = duration.as_f64().unwrap();
    let csv = exported(&json!({ "program": SHORT, "format": "csv", "rate_hz": 20.0 }));
    assert_eq!(csv.header("content-disposition"), "attachment; filename=\"example.csv\"");
    let csv = text(&csv);
    let last: Vec<&str> = csv.lines().last().unwrap().split(',').collect();
    assert!((last[0].parse::<f64>().unwrap() - duration).abs() < 1e-9, "{last:?}");
    assert_eq!(csv.lines().count(), 2 + (duration * 20.0).ceil() as usize);
    let scene = exported(&json!({ "program": SHORT, "format": "gltf", "rate_hz": 20.0 }));
    assert_eq!((scene.status, &scene.bytes[..4]), (StatusCode::OK, &b"glTF"[..]));
    for (dialect, ending) in [("neutral", "txt"), ("points", "pvt")] {
        let answer = exported(&json!({ "program": SHORT, "format": "text", "dialect": dialect }));
        let name = answer.header("content-disposition").to_owned();
        assert_eq!(name, format!("attachment; filename=\"example-{dialect}.{ending}\""));
        assert!(text(&answer).lines().count() > 10);
    }
}

#[test]
fn a_report_is_a_page_without_other_files() {
    let answer = exported(&json!({ "program": SHORT, "format": "report" }));
    assert_eq!(
        answer.header("content-disposition"),
        "attachment; filename=\"example-report.html\""
    );
    let page = text(&answer);
    assert!(page.contains("<svg") && page.contains("GET LP1 SLOT 1 WITH A"));
    assert!(!page.contains("<script") && !page.contains("src=\"http"));
}

/// Before, the report stated that the check had passed.
#[test]
fn a_report_on_a_program_that_only_waits_has_not_passed() {
    let page = text(&exported(&json!({ "program": "WAIT 2 s\n", "format": "report" })));
    assert!(page.contains("No motion: all axes stay at home") && !page.contains("Check passed"));
}

#[test]
fn a_motion_with_violations_is_exported_only_on_request_and_with_a_warning() {
    let request = json!({ "cell": blocked(), "program": SHORT, "format": "csv" });
    let refused = exported(&request);
    assert_eq!(refused.status, StatusCode::CONFLICT);
    assert_eq!(refused.json()["field"], "despite_errors");
    assert!(refused.json()["detail"].as_str().unwrap().contains("not safe to run"));
    let mut request = request;
    request["despite_errors"] = json!(true);
    let answer = exported(&request);
    let name = answer.header("content-disposition").to_owned();
    assert_eq!(name, "attachment; filename=\"example-not-safe-to-run.csv\"");
    assert!(text(&answer).lines().next().unwrap().contains("violations"));
    // A report states its violations, so that it needs no confirmation.
    let report = exported(&json!({ "cell": blocked(), "program": SHORT, "format": "report" }));
    assert!(text(&report).contains("wall"));
}

#[test]
fn bad_requests_name_their_field() {
    let answer = exported(&json!({ "program": SHORT, "format": "csv", "dialect": "points" }));
    assert_eq!(answer.json()["field"], "dialect", "it would have no effect");
    let answer = exported(&json!({ "program": "", "format": "csv" }));
    assert_eq!(answer.status, StatusCode::CONFLICT);
    let detail = answer.json()["detail"].as_str().unwrap().to_owned();
    assert!(detail.contains("the program contains no motion"), "{detail}");
    for (request, field, status) in [
        (json!({ "format": "csv", "rate_hz": 0.0 }), "rate_hz", 422),
        (json!({ "format": "csv", "rate_hz": 1e5 }), "rate_hz", 422),
        (json!({ "program": SHORT, "format": "text", "dialect": "vall" }), "dialect", 422),
    ] {
        let answer = exported(&request);
        assert_eq!((answer.status.as_u16(), &answer.json()["field"]), (status, &json!(field)));
    }
    let answer = exported(&json!({ "program": "GET LP9", "format": "csv" }));
    assert_eq!(answer.status, StatusCode::CONFLICT);
    assert!(answer.json()["detail"].as_str().unwrap().contains("LP9"));
    assert_eq!(exported(&json!({ "format": "pdf" })).status.as_u16() / 100, 4);
}

/// Minutes of motion: no samples are needed for lines of a controller, and too many for points or a scene.
#[test]
fn long_motions_are_limited_by_what_is_sampled() {
    let program = "REPEAT 200 AS n\nGET LP1 SLOT 1 WITH A\nPUT LP1 SLOT 1 WITH A\nEND\n";
    let text_of = |dialect: &str| {
        exported(
            &json!({ "program": program, "format": "text", "dialect": dialect, "rate_hz": 1e3 }),
        )
    };
    assert!(text(&text_of("neutral")).lines().count() > 1000);
    for answer in [
        text_of("points"),
        exported(&json!({ "program": program, "format": "gltf", "rate_hz": 1e3 })),
    ] {
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
        assert!(answer.json()["detail"].as_str().unwrap().contains("use a lower rate"));
    }
}
