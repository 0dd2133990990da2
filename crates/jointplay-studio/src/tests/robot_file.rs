//! The robot file: opening, changes of its numbers, requests about an edited robot, saving.

use std::collections::BTreeMap;

use axum::body::Body;
use axum::http::{Request, StatusCode, header};
use jointplay::format::robot::{self, PAPER};
use serde_json::{Value, json};

use super::{Answer, HOST, PORT, answered, get, refused, send_to, state};
use crate::robot_file::RobotFileOnDisk;
use crate::router;

const OPEN: &str = "/api/v1/robot/open";
const FILE: &str = "/api/v1/robot/file";

/// A robot as a stranger writes it: parameters, comments, inline tables, CRLF, a right-angled arrangement.
const STRANGE: &str = "kind = 'gpr'\r\nname = \"Prüfstand 3\" # ours\r\nlimb = [\r\n  { socket_radius_mm = 'r', socket_angle_deg = 0 }, # motor side\r\n  { socket_radius_mm = 'r', socket_angle_deg = 90 },\r\n  { socket_radius_mm = 120.5, socket_angle_deg = 225, base_point_mm = [-85, -85.5] },\r\n]\r\nlimits = { rod_mm = [ 200, 300 ], tilt_deg = 2 }\r\nworking.height_mm = 250 # middle\r\nball.clearance_radius_um = 30\r\n[parameters]\r\nr = 80\r\n";

fn open(text: &str, changes: Value) -> Value {
    answered(OPEN, &json!({ "robot": { "text": text }, "changes": changes }).to_string())
}

#[test]
fn an_opened_robot_has_its_numbers_parameters_and_expressions() {
    let opened = open(STRANGE, json!([]));
    assert_eq!(opened["text"], STRANGE);
    assert_eq!(opened["diagnostics"], json!([]));
    let robot = &opened["robot"];
    assert_eq!(robot["name"], "Prüfstand 3");
    assert_eq!(robot["limbs"][1]["socket_radius_m"], 0.08);
    assert_eq!(robot["limbs"][2]["base_point_m"], json!([-0.085, -0.0855]));
    assert_eq!(robot["ball_clearance_m"], 30e-6);
    assert_eq!(opened["parameters"], json!([{ "name": "r", "value": 80.0 }]));
    let expected = json!([
        { "dimension": "socket_radius", "limb": 0, "expression": "r" },
        { "dimension": "socket_radius", "limb": 1, "expression": "r" },
    ]);
    assert_eq!(opened["expressions"], expected);
}

#[test]
fn changes_keep_everything_else_of_the_text() {
    let changes = json!([
        { "dimension": "parameter", "name": "r", "value": 81.5 },
        { "dimension": "rod_max", "value": 0.31 },
        { "dimension": "working_height", "value": 0.26 },
        { "dimension": "ball_clearance", "value": 25e-6 },
        { "dimension": "socket_radius", "limb": 2, "value": 0.121 },
    ]);
    let opened = open(STRANGE, changes);
    let expected = STRANGE
        .replace("r = 80", "r = 81.5")
        .replace("200, 300 ", "200, 310.0 ")
        .replace("= 250", "= 260.0")
        .replace("= 30", "= 25.0")
        .replace("= 120.5", "= 121.0");
    let lines = |text: &str| text.replace("\r\n", "\n");
    assert_eq!(lines(opened["text"].as_str().unwrap()), lines(&expected));
    assert_eq!(opened["robot"]["limbs"][0]["socket_radius_m"], 0.0815);
}

#[test]
fn errors_of_a_text_have_their_lines_and_changes_of_expressions_are_refused() {
    let broken = PAPER.replacen("socket_angle_deg = 120.0", "socket_angle_deg = 0.0", 1);
    let opened = open(&broken, json!([]));
    assert_eq!(opened["robot"], Value::Null);
    let found = &opened["diagnostics"][0];
    assert_eq!(found["line"], 14, "{found}");
    assert!(found["message"].as_str().unwrap().contains("lie on one line"));
    let many = PAPER.replacen("tilt_deg = 1.5", "tilt_deg = 95", 1).replacen("93.218", "-1", 1);
    assert_eq!(open(&many, json!([]))["diagnostics"].as_array().unwrap().len(), 1);
    // A change that makes the text invalid is an error of the text, not of the request.
    let limits = open(PAPER, json!([{ "dimension": "rod_min", "value": 0.8 }]));
    assert_eq!(limits["robot"], Value::Null);
    assert_eq!(limits["diagnostics"][0]["line"], 26);
    let change = |text: &str, change: Value| {
        json!({ "robot": { "text": text }, "changes": [change] }).to_string()
    };
    let radius = json!({ "dimension": "socket_radius", "limb": 0, "value": 0.1 });
    refused(OPEN, &change(STRANGE, radius), 422, Some("changes"), "is the expression \"r\"");
    let far = json!({ "dimension": "socket_radius", "limb": 3, "value": 0.1 });
    refused(OPEN, &change(PAPER, far), 422, Some("changes[0].limb"), "limbs 0 to 2");
    let nameless = json!({ "dimension": "parameter", "value": 0.1 });
    refused(OPEN, &change(PAPER, nameless), 422, Some("changes[0].name"), "missing");
    let unknown = json!({ "dimension": "parameter", "name": "q", "value": 0.1 });
    refused(OPEN, &change(PAPER, unknown), 422, Some("changes"), "parameter \"q\" is not known");
    let many = json!({ "robot": { "text": PAPER }, "changes": vec![json!({ "dimension": "rod_min", "value": 0.3 }); 65] });
    refused(OPEN, &many.to_string(), 422, Some("changes"), "65 changes");
}

#[test]
fn requests_about_an_edited_robot_use_its_text() {
    let tilt = json!({ "kind": "tilt", "azimuth_rad": 0.4, "tilt_rad": 0.02 });
    let pose = |robot: Option<Value>| {
        let mut body = json!({ "command": tilt, "models": [{ "virtualization": "planar" }] });
        if let Some(robot) = robot {
            body["robot"] = robot;
        }
        answered("/api/v1/pose", &body.to_string())
    };
    let strange = json!({ "text": STRANGE, "parameters": { "r": 95.0 } });
    let own = pose(Some(strange.clone()));
    assert_eq!(own["axis_height_m"].as_f64().map(|height| (height * 1e9).round()), Some(0.25e9));
    let clearance = &own["models"][0]["answer"]["clearance"];
    assert_eq!(clearance["available_m"], 30e-6);
    let displacements = clearance["displacements_m"].as_array().unwrap();
    let largest = displacements.iter().map(|one| one.as_f64().unwrap()).fold(0.0, f64::max);
    assert_eq!(clearance["upper_bound_m"].as_f64(), Some(largest));
    assert_eq!(clearance["is_sufficient"], largest <= 30e-6);
    assert_eq!(pose(None)["axis_height_m"].as_f64().map(|h| (h * 1e9).round()), Some(0.5e9));
    // The same through another endpoint.
    let rods = &own["rods_m"];
    let forward = json!({ "robot": strange, "rods_m": rods, "ignore_limits": true });
    let forward = answered("/api/v1/forward", &forward.to_string());
    assert!((forward["platform"]["axis_height_mm"].as_f64().unwrap() - 250.0).abs() < 1e-9);
    let broken = json!({ "command": tilt, "robot": { "text": "kind = 'gpr'" } });
    refused("/api/v1/pose", &broken.to_string(), 422, Some("robot.text"), "line 1");
    let unknown =
        json!({ "command": tilt, "robot": { "text": PAPER, "parameters": { "r": 1.0 } } });
    refused("/api/v1/pose", &unknown.to_string(), 422, Some("robot.text"), "parameter");
}

#[test]
fn a_rod_beyond_its_reach_slides_along_the_limits() {
    let pose = |rods: [f64; 3]| {
        let command = json!({ "kind": "rods", "rods_m": rods });
        answered("/api/v1/pose", &json!({ "command": command, "at_limits": "slide" }).to_string())
    };
    let within = pose([0.5005, 0.5, 0.5]);
    assert_eq!(within["rods_m"], json!([0.5005, 0.5, 0.5]));
    assert_eq!(within["stopped_by"], json!([]));
    let beyond = pose([0.51, 0.5, 0.5]);
    let rods: Vec<f64> =
        beyond["rods_m"].as_array().unwrap().iter().map(|rod| rod.as_f64().unwrap()).collect();
    // The limit of the tilt: the mean remains, and the first rod is as far above it as the tilt allows.
    assert!((rods.iter().sum::<f64>() - 1.51).abs() < 1e-12, "{rods:?}");
    let radius = robot::paper().gpr.platform().mean_radius();
    let above = rods[0] - 1.51 / 3.0;
    assert!((above - radius * 1.5_f64.to_radians().tan()).abs() < 1e-9, "{above}");
    assert_eq!(beyond["limits_broken"], json!([]));
    let held = &beyond["stopped_by"];
    assert_eq!((held.as_array().unwrap().len(), &held[0]["limb"]), (1, &Value::Null));
    assert!(held[0]["message"].as_str().unwrap().contains("its limit is 1.5°"), "{held}");
    let body = json!({ "command": { "kind": "rods", "rods_m": [1, 1, 1] }, "at_limits": "jump" });
    refused("/api/v1/pose", &body.to_string(), 422, Some("at_limits"), "jump");
}

#[test]
fn the_robot_file_is_saved_if_it_has_not_changed_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, PAPER).unwrap();
    let mut served = state(robot::paper(), None).unwrap();
    served.robot = served.robot.with_file(RobotFileOnDisk {
        name: "mine.toml".to_owned(),
        path: Some(path.clone()),
        text: PAPER.to_owned(),
        parameters: BTreeMap::new(),
    });
    let ask = |method: &str, body: Option<Value>| -> Answer {
        let request = Request::builder().method(method).uri(FILE).header(header::HOST, HOST);
        let request = request.header(header::CONTENT_TYPE, "application/json");
        let body = body.map_or_else(Body::empty, |body| Body::from(body.to_string()));
        send_to(router::router(served.clone(), PORT), request.body(body).unwrap())
    };
    let read = ask("GET", None).json();
    assert_eq!((&read["name"], &read["writable"]), (&"mine.toml".into(), &true.into()));
    assert_eq!(read["text"], PAPER);
    let edited = PAPER.replacen("tilt_deg = 1.5", "tilt_deg = 1.25", 1);
    let saved = ask("PUT", Some(json!({ "text": edited, "replaces": read["version"] })));
    assert_eq!(saved.status, StatusCode::OK);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), edited);
    // The saved robot is that of the server.
    assert_eq!(served.robot.robot().gpr.limits().tilt_max, 1.25_f64.to_radians());
    let outdated = ask("PUT", Some(json!({ "text": PAPER, "replaces": read["version"] })));
    assert_eq!(
        (outdated.status, &outdated.json()["field"]),
        (StatusCode::CONFLICT, &"replaces".into())
    );
    assert_eq!(std::fs::read_to_string(&path).unwrap(), edited);
    // A text with errors is saved, and the server keeps its robot.
    let broken = ask("PUT", Some(json!({ "text": "kind = " })));
    assert_eq!(broken.status, StatusCode::OK);
    assert_eq!(served.robot.robot().gpr.limits().tilt_max, 1.25_f64.to_radians());
    std::fs::remove_file(&path).unwrap();
    assert_eq!(ask("GET", None).status, StatusCode::CONFLICT);
}

#[test]
fn a_robot_that_is_no_file_has_a_text_and_is_not_saved() {
    let read = get(FILE).json();
    assert_eq!(read["writable"], false);
    let opened = open(read["text"].as_str().unwrap(), json!([]));
    assert_eq!(opened["robot"]["limbs"], get("/api/v1/robot").json()["limbs"]);
}
