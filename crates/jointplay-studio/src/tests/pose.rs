//! Poses compared with the library.

use jointplay::format::robot;
use jointplay::gpr::{AxisHeight, CenterHeight};
use jointplay::spatial::Tilt;
use jointplay::virtualization::{Metric, Offset, Planar, Polar, SolveOptions, Solver};
use serde_json::Value;

use super::{answered, refused};

const POSE: &str = "/api/v1/pose";

#[track_caller]
fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn a_pose_equals_that_of_the_library() {
    let gpr = robot::paper().gpr.without_limit_checks();
    let tilt = Tilt { azimuth: 0.3, angle: 0.026 };
    let rods = gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
    let document = answered(
        POSE,
        r#"{"command": {"kind": "tilt", "azimuth_rad": 0.3, "tilt_rad": 0.026},
            "models": [{"virtualization": "polar", "solver": "newton", "metric": "radius"}, {}]}"#,
    );
    assert_eq!(numbers(&document["rods_m"]), rods);
    assert!((document["tilt"]["angle_rad"].as_f64().unwrap() - 0.026).abs() < 1e-15);
    assert!((document["axis_height_m"].as_f64().unwrap() - 0.5).abs() < 1e-15);
    assert_eq!(document["limits_broken"], Value::Array(vec![]));

    let options = SolveOptions {
        solver: Solver::Newton,
        metric: Metric::PlatformRadius,
        ..SolveOptions::default()
    };
    let pose = gpr.forward(rods, &Polar, &options).unwrap();
    let answer = &document["models"][0]["answer"];
    assert_eq!(numbers(&answer["virtual_joints"]), pose.solution.virtual_joints.to_vec());
    assert_eq!(numbers(&answer["center_shift_m"]), pose.center_shift().as_slice());
    assert_eq!(answer["characteristic_length_m"], 0.093218);
    let play = gpr.tilt_play(tilt, AxisHeight(0.5), &Polar, &options).unwrap();
    let found = answer["play"]["bounds"][1]["upper_m"].as_f64().unwrap();
    assert!((found / play.at_midpoint.bounds.upper - 1.0).abs() < 1e-9);
    assert_eq!(answer["augmented"]["rank"], 12);

    let pose = gpr.forward(rods, &Planar, &SolveOptions::default()).unwrap();
    let answer = &document["models"][1]["answer"];
    assert_eq!(numbers(&answer["virtual_joints"]), pose.solution.virtual_joints.to_vec());
    assert_eq!(answer["solver"], "closed-form");
    assert_eq!(document["mobility"]["instantaneous"], 1, "up and down");
}

#[test]
fn three_kinds_of_commands_give_the_same_pose() {
    let tilt = Tilt { azimuth: -2.0, angle: 0.02 };
    let (about_x, about_y) = tilt.about_x_and_y();
    let first = answered(
        POSE,
        r#"{"command": {"kind": "tilt", "azimuth_rad": -2, "tilt_rad": 0.02, "height": {"kind": "axis", "value_m": 0.4}}}"#,
    );
    let by_turns = format!(
        r#"{{"command": {{"kind": "tilt_xy", "about_x_rad": {about_x}, "about_y_rad": {about_y}, "height": {{"kind": "axis", "value_m": 0.4}}}}}}"#
    );
    let by_rods = format!(r#"{{"command": {{"kind": "rods", "rods_m": {}}}}}"#, first["rods_m"]);
    for body in [by_turns, by_rods] {
        let document = answered(POSE, &body);
        for (a, b) in numbers(&document["rods_m"]).iter().zip(numbers(&first["rods_m"])) {
            assert!((a - b).abs() < 1e-15, "{body}");
        }
        assert!((document["axis_height_m"].as_f64().unwrap() - 0.4).abs() < 1e-15, "{body}");
    }
}

#[test]
fn a_centre_height_refers_to_the_first_model() {
    let gpr = robot::paper().gpr.without_limit_checks();
    let tilt = Tilt { azimuth: 0.0, angle: 0.026 };
    let options = SolveOptions { solver: Solver::Newton, ..SolveOptions::default() };
    let pose = gpr.inverse_for_center(tilt, CenterHeight(0.5), &Offset, &options).unwrap();
    let document = answered(
        POSE,
        r#"{"command": {"kind": "tilt", "azimuth_rad": 0, "tilt_rad": 0.026, "height": {"kind": "center", "value_m": 0.5}},
            "models": [{"virtualization": "offset", "solver": "newton"}, {}]}"#,
    );
    assert_eq!(numbers(&document["rods_m"]), pose.rods);
    let origin = numbers(&document["models"][0]["answer"]["pose"]["origin_m"]);
    assert!((origin[2] - 0.5).abs() < 1e-15);
}

#[test]
fn only_requested_parts_are_computed() {
    let body = r#"{"command": {"kind": "rods", "rods_m": [0.5, 0.5, 0.5]}, "mobility": false, "bounds": false}"#;
    let document = answered(POSE, body);
    assert_eq!(document["mobility"], Value::Null);
    assert_eq!(document["models"][0]["answer"]["play"], Value::Null);
    let document = answered(POSE, r#"{"command": {"kind": "rods", "rods_m": [0.5, 0.5, 0.5]}}"#);
    let mobility = &document["mobility"];
    let found = ["kutzbach", "instantaneous", "finite"].map(|key| mobility[key].as_i64().unwrap());
    assert_eq!(found, [0, 3, 1], "level is infinitesimally mobile");
}

#[test]
fn a_pose_beyond_the_limits_lists_them() {
    let document =
        answered(POSE, r#"{"command": {"kind": "tilt", "azimuth_rad": 0, "tilt_rad": 0.03}}"#);
    let broken = &document["limits_broken"][0];
    assert_eq!(broken["limb"], Value::Null);
    assert_eq!(broken["found"], 0.03);
    assert!(broken["message"].as_str().unwrap().starts_with("the tilt is 1.718873°"));
    let document = answered(POSE, r#"{"command": {"kind": "rods", "rods_m": [0.2, 0.2, 0.2]}}"#);
    assert_eq!(document["limits_broken"][2]["limb"], 2);
}

#[test]
fn a_motion_stops_at_the_limits() {
    let document = answered(
        POSE,
        r#"{"command": {"kind": "rods", "rods_m": [0.52, 0.5, 0.5]}, "from_rods_m": [0.5, 0.5, 0.5]}"#,
    );
    assert_eq!(document["limits_broken"], Value::Array(vec![]));
    let tilt_angle = document["tilt"]["angle_rad"].as_f64().unwrap();
    assert!((tilt_angle - 1.5_f64.to_radians()).abs() < 1e-12, "{tilt_angle}");
    let rods: Vec<f64> = serde_json::from_value(document["rods_m"].clone()).unwrap();
    assert!(rods[0] > 0.503 && rods[0] < 0.51 && rods[1..] == [0.5, 0.5], "{rods:?}");
    let why = document["stopped_by"][0]["message"].as_str().unwrap();
    assert!(why.starts_with("the tilt is"), "{why}");
    let body = |from: &str| {
        format!(
            r#"{{"command": {{"kind": "rods", "rods_m": [0.501, 0.5, 0.5]}}, "from_rods_m": {from}}}"#
        )
    };
    let reached = answered(POSE, &body("[0.5, 0.5, 0.5]"));
    assert_eq!(
        (&reached["rods_m"][0], &reached["stopped_by"]),
        (&0.501.into(), &Value::Array(vec![]))
    );
    refused(POSE, &body("[1e9, 0.5, 0.5]"), 422, Some("from_rods_m[0]"), "within ±1000 m");
}

#[test]
fn a_motion_from_beyond_the_limits_is_not_stopped() {
    let body = |to: &str| {
        format!(
            r#"{{"command": {{"kind": "rods", "rods_m": {to}}}, "from_rods_m": [0.9, 0.5, 0.5]}}"#
        )
    };
    let back = answered(POSE, &body("[0.501, 0.5, 0.5]"));
    assert_eq!(
        (&back["rods_m"][0], &back["limits_broken"]),
        (&0.501.into(), &Value::Array(vec![]))
    );
    let on = answered(POSE, &body("[0.52, 0.5, 0.5]"));
    assert_eq!((&on["rods_m"][0], &on["stopped_by"]), (&0.52.into(), &Value::Array(vec![])));
    assert_eq!(on["limits_broken"].as_array().unwrap().len(), 1);
}

#[test]
fn a_model_without_a_solution_has_a_reason() {
    let document = answered(
        POSE,
        r#"{"command": {"kind": "tilt", "azimuth_rad": 0, "tilt_rad": 1.2},
            "models": [{"virtualization": "polar"}, {}]}"#,
    );
    assert_eq!(document["models"][0]["answer"], Value::Null);
    let why = document["models"][0]["problem"].as_str().unwrap();
    assert!(why.contains("turn the platform over"), "{why}");
    assert!(document["models"][1]["answer"].is_object());
}

#[test]
fn invalid_requests_name_their_field() {
    let bad =
        |body: &str, field: Option<&str>, detail: &str| refused(POSE, body, 422, field, detail);
    bad("[]", None, "expected an object");
    bad("{}", None, "missing field `command`");
    bad(r#"{"command": 3}"#, Some("command"), "expected an object with a `kind`");
    bad(r#"{"command": {}}"#, Some("command"), r#"known: "tilt", "tilt_xy", "rods""#);
    let kinds = r#"expected one of "tilt", "tilt_xy", "rods", got "tolt""#;
    bad(r#"{"command": {"kind": "tolt"}}"#, Some("command.kind"), kinds);
    let tilt = |fields: &str| format!(r#"{{"command": {{"kind": "tilt", {fields}}}}}"#);
    bad(&tilt(r#""azimuth_rad": 1"#), Some("command"), "missing field `tilt_rad`");
    bad(
        &tilt(r#""azimuth_rad": "a", "tilt_rad": 0"#),
        Some("command.azimuth_rad"),
        "expected a number, got \"a\"",
    );
    bad(
        &tilt(r#""azimuth_rad": 1e9, "tilt_rad": 0"#),
        Some("command.azimuth_rad"),
        "within ±1000 rad",
    );
    bad(
        &tilt(r#""azimuth_rad": 0, "tilt_rad": 1.6"#),
        Some("command.tilt_rad"),
        "must be between -π/2 and π/2",
    );
    let high = r#""azimuth_rad": 0, "tilt_rad": 0, "height": {"kind": "axis", "value_m": 1e4}"#;
    bad(&tilt(high), Some("command.height.value_m"), "within ±1000 m");
    let array = r#""azimuth_rad": 0, "tilt_rad": 0, "height": ["axis", 0.5]"#;
    bad(&tilt(array), Some("command.height"), "expected an object");
    let turns = r#"{"command": {"kind": "tilt_xy", "about_x_rad": 1.5, "about_y_rad": 1.5}}"#;
    bad(turns, Some("command"), "must be between -π/2 and π/2");
    let rods = |rods: &str| format!(r#"{{"command": {{"kind": "rods", "rods_m": {rods}}}}}"#);
    bad(&rods("[0.5, 0.5]"), Some("command.rods_m"), "expected a list of 3, got a list of 2");
    bad(&rods("[0.5, 0.5, 2000]"), Some("command.rods_m[2]"), "got 2e3 m");
    let model = |model: &str| {
        format!(r#"{{"command": {{"kind": "rods", "rods_m": [1, 1, 1]}}, "models": {model}}}"#)
    };
    bad(&model("[]"), Some("models"), "1 to 16 are allowed");
    bad(&model("[[]]"), Some("models[0]"), "expected an object");
    bad(&model(r#"[{}, {"solver": "x"}]"#), Some("models[1].solver"), "\"closed-form\"");
    bad(&model(r#"[{"colour": 1}]"#), Some("models[0].colour"), "unknown field");
    let length = r#"[{}, {"characteristic_length_m": 0}]"#;
    bad(&model(length), Some("models[1].characteristic_length_m"), "must be within 1e-12 to 1e6 m");
    refused(POSE, "{", 400, None, "not valid JSON");
    // Before, the last one was used.
    refused(POSE, r#"{"command": 1, "command": 2}"#, 400, None, "\"command\" is given twice");
    let deep = "[".repeat(100_000);
    refused(POSE, &format!("{{\"command\": {deep}"), 400, None, "recursion limit exceeded");
    let meant = "unknown field `comand` (did you mean `command`?)";
    refused(POSE, r#"{"comand": 1}"#, 422, Some("comand"), meant);
    refused(
        POSE,
        r#"{"command": {"kind": "rods", "rods_m": [1e999, 1, 1]}}"#,
        400,
        None,
        "not valid JSON",
    );
}
