//! Requests that correspond to commands; the equality of the results is tested by the command line.

use axum::body::Body;
use axum::http::{Request, header};

use super::{HOST, answered, refused, send};

const FORWARD: &str = "/api/v1/forward";

#[test]
fn a_pose_beyond_a_limit_is_rejected() {
    let rods = r#"{"rods_m": [0.5, 0.501, 0.8]}"#;
    refused(FORWARD, rods, 409, None, "rod 3 is 800.000000 mm long, its limits are 246 to 754 mm");
    let tilt = r#"{"command": {"kind": "tilt", "azimuth_rad": 0, "tilt_rad": 0.03}}"#;
    refused("/api/v1/inverse", tilt, 409, None, "\"ignore_limits\": true to ignore them");
    refused("/api/v1/sensitivity", tilt, 409, None, "the tilt is 1.718873°");
    let rods = r#"{"rods_m": [0.5, 0.51, 0.5]}"#;
    refused("/api/v1/mobility", rods, 409, None, "the tilt is");
    let tilts = r#"{"tilts_rad": [0, -0.03, 0.01]}"#;
    refused("/api/v1/compare", tilts, 409, None, "the tilt is 1.718873°");
    let tilts = r#"{"tilts_rad": [0, -0.03, 0.01], "ignore_limits": true}"#;
    let document = answered("/api/v1/compare", tilts);
    assert_eq!(document["limits_broken"].as_array().unwrap().len(), 1);
    assert_eq!(document["models"].as_array().unwrap().len(), 4);
}

#[test]
fn a_problem_lists_violated_limits() {
    let answer = super::post(FORWARD, r#"{"rods_m": [0.2, 0.2, 0.2]}"#);
    let problem = answer.json();
    assert_eq!(problem["kind"], "limits");
    assert_eq!(problem["limits_broken"][1]["limit"], "rod 2");
    assert_eq!(problem["limits_broken"][1]["min"], 246.0);
}

#[test]
fn a_request_without_a_solution_is_rejected() {
    let body = r#"{"command": {"kind": "tilt", "azimuth_rad": 0, "tilt_rad": 1.2}, "ignore_limits": true, "model": {"virtualization": "polar"}}"#;
    let answer = super::post("/api/v1/inverse", body);
    assert_eq!(answer.status.as_u16(), 409);
    assert_eq!(answer.json()["kind"], "unsolved");
}

#[test]
fn invalid_requests_name_their_field() {
    let bad = |path: &str, body: &str, field: &str, detail: &str| {
        refused(&format!("/api/v1/{path}"), body, 422, Some(field), detail);
    };
    bad("forward", r#"{"rods_m": [0.5, 0.5, 1e9]}"#, "rods_m[2]", "within ±1000 m");
    bad("forward", r#"{"rods_m": [1, 1, 1], "model": []}"#, "model", "expected an object");
    bad(
        "forward",
        r#"{"rods_m": [1, 1, 1], "model": {"metric": "mm"}}"#,
        "model.metric",
        "\"radius\"",
    );
    let length = r#"{"rods_m": [1, 1, 1], "model": {"characteristic_length_m": -1}}"#;
    bad("forward", length, "model.characteristic_length_m", "must be within 1e-12 to 1e6 m");
    bad("inverse", r#"{"command": {"kind": "level"}}"#, "command.kind", "got \"level\"");
    bad("mobility", r#"{"virtualization": "cubic"}"#, "virtualization", "\"radial\"");
    bad("mobility", r#"{"rods_m": [1, 1]}"#, "rods_m", "expected a list of 3, got a list of 2");
    bad("compare", r#"{"tilts_rad": []}"#, "tilts_rad", "1 to 10000 are allowed");
    bad("compare", r#"{"tilts_rad": [0, 2]}"#, "tilts_rad[1]", "must be between -π/2 and π/2");
    bad(
        "compare",
        r#"{"tilts_rad": [0], "axis_height_m": 1e9}"#,
        "axis_height_m",
        "within ±1000 m",
    );
    let length = r#"{"tilts_rad": [0], "characteristic_length_m": 0}"#;
    bad("compare", length, "characteristic_length_m", "must be within 1e-12 to 1e6 m");
    refused("/api/v1/sensitivity", "{}", 422, None, "missing field `command`");
}

#[test]
fn typed_lengths_and_angles_have_units_of_their_own() {
    let check = |text: &str, unit: &str, expected: f64| {
        let body = serde_json::json!({ "text": text, "unit": unit }).to_string();
        let found = answered("/api/v1/quantity", &body);
        let si = if ["mm", "in"].contains(&unit) { "m" } else { "rad" };
        assert_eq!(found["unit"], si, "{text} [{unit}]");
        let value = found["value"].as_f64().unwrap();
        assert!((value - expected).abs() <= 1e-15 * expected.abs(), "{text} [{unit}]: {value}");
    };
    check("1/3", "mm", 1e-3 / 3.0);
    check("0.5 mil", "mm", 12.7e-6);
    check("93.218", "mm", 0.093_218);
    check("2 * (3 + 1)", "in", 0.2032);
    check("12 µm", "in", 12e-6);
    check("−1.5°", "rad", (-1.5_f64).to_radians());
    check("250 µrad", "deg", 250e-6);
    check("atan(1/2)", "deg", 0.5_f64.atan());
    let refuse = |text: &str, unit: &str, detail: &str| {
        let body = serde_json::json!({ "text": text, "unit": unit }).to_string();
        refused("/api/v1/quantity", &body, 422, Some("text"), detail);
    };
    refuse("1 mm", "deg", "mm is a unit of lengths");
    refuse("1/0", "mm", "infinite");
    refuse("", "mm", "expected a number");
    refuse("1e999", "mm", "");
    refuse("(".repeat(90).as_str(), "mm", "");
    refuse("1+".repeat(200_000).as_str(), "mm", "400000 bytes, at most 1000");
    refuse("height", "mm", "unknown name `height`");
}

/// The detail of a pose far beyond the limits, in the unit of a header.
fn in_unit(unit: Option<&str>) -> (u16, String) {
    let body = r#"{"rods_m": [0.5, 0.6, 1.0], "model": {}}"#;
    let mut request = Request::post("/api/v1/forward")
        .header(header::HOST, HOST)
        .header(header::CONTENT_TYPE, "application/json");
    if let Some(unit) = unit {
        request = request.header("Length-Unit", unit);
    }
    let answer = send(request.body(Body::from(body)).unwrap());
    let detail = answer.json()["detail"].as_str().unwrap_or_default().to_owned();
    (answer.status.as_u16(), detail)
}

#[test]
fn lengths_in_messages_have_the_unit_of_the_request() {
    let contains = |unit: Option<&str>, status: u16, part: &str| {
        let (found, detail) = in_unit(unit);
        assert!(found == status && detail.contains(part), "{unit:?}: {found} {detail}");
    };
    contains(None, 409, "rod 3 is 1000.000000 mm long");
    contains(Some("mm"), 409, "rod 3 is 1000.000000 mm long");
    // 1000 mm / 25.4.
    contains(Some("in"), 409, "rod 3 is 39.370079 in long, its limits are ");
    contains(Some("cm"), 422, "unknown unit \"cm\" in the header length-unit; known: mm, in");
    let (_, detail) = in_unit(Some("in"));
    assert!(!detail.contains("mm"), "{detail}");
}
