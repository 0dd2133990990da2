//! Jogging of the robot of the cell.

use axum::Router;
use axum::http::{Method, StatusCode};
use serde_json::{Value, json};

use super::cell::{SHORT, ask, server, steps};
use crate::cell_files::CellFiles;

#[track_caller]
fn jog(server: &Router, mut body: Value) -> Value {
    body["program"] = SHORT.into();
    let answer = ask(server, Method::POST, "cell/jog", &body);
    assert_eq!(answer.status, StatusCode::OK, "{}", String::from_utf8_lossy(&answer.bytes));
    answer.json()
}

fn positions(document: &Value) -> Vec<f64> {
    let axes = document["axes"].as_array().unwrap();
    axes.iter().map(|axis| axis["position"].as_f64().unwrap()).collect()
}

#[test]
fn a_robot_whose_program_has_no_motion_is_jogged_from_home() {
    let server = server(CellFiles::example());
    for program in ["", "HOME\n", "SPEED 50 %\n"] {
        let answer = ask(&server, Method::POST, "cell/jog", &json!({ "program": program }));
        assert_eq!(answer.status, StatusCode::OK, "{program:?}");
        for axis in answer.json()["axes"].as_array().unwrap() {
            assert_eq!(axis["position"], axis["home"], "{program:?}");
        }
    }
}

#[test]
fn a_jog_starts_at_the_pose_of_the_program() {
    let server = server(CellFiles::example());
    let home = jog(&server, json!({}));
    assert_eq!(home["stopped"], Value::Null);
    for axis in home["axes"].as_array().unwrap() {
        assert_eq!(axis["position"], axis["home"]);
    }
    let names: Vec<&str> = home["frames"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["name"].as_str().unwrap())
        .collect();
    assert_eq!(names[..5], ["q1", "q2", "q3", "platform", "upper link 1"]);
    assert!(names.contains(&"wafer of LP1 1"));
    let plan = ask(&server, Method::POST, "cell/plan", &json!({ "program": SHORT })).json();
    let instruction_steps = steps(&server, &plan);
    let lifted = instruction_steps.iter().find(|step| step["loaded"] == json!([0]));
    let time = lifted.unwrap()["end_s"].as_f64().unwrap();
    let later = jog(&server, json!({ "time_s": time }));
    assert_eq!(later["effectors"][0]["loaded"], true);
    // The wafer moves with its effector.
    let place = |document: &Value| {
        let frames = document["frames"].as_array().unwrap();
        frames.iter().find(|one| one["name"] == "wafer of LP1 1").unwrap()["origin_m"].clone()
    };
    let mut to = positions(&later);
    to[3] += 0.1;
    let moved = jog(&server, json!({ "time_s": time, "to": { "kind": "axes", "positions": to } }));
    assert_ne!(place(&moved), place(&later));
}

#[test]
fn limits_stop_a_jog_with_reasons() {
    let server = server(CellFiles::example());
    let mut to = positions(&jog(&server, json!({})));
    to[4] = 3.0;
    let found = jog(&server, json!({ "to": { "kind": "axes", "positions": to } }));
    assert_eq!(found["axes"][4]["position"], found["axes"][4]["max"]);
    assert_eq!(
        (&found["stopped"]["kind"], &found["stopped"]["axes"]),
        (&"axis_limit".into(), &json!(["RA"]))
    );
    let why = found["stopped"]["reasons"][0].as_str().unwrap();
    assert!(why.contains("axis RA") && why.contains("80.0000°"), "{why}");
    let tilted =
        json!({ "kind": "platform", "height_m": 0.5, "about_x_rad": 0.05, "about_y_rad": 0.0 });
    let found = jog(&server, json!({ "to": tilted }));
    let platform = &found["platform"];
    let (tilt, most) =
        (platform["tilt_rad"].as_f64().unwrap(), platform["tilt_max_rad"].as_f64().unwrap());
    assert!((tilt - most).abs() < 1e-9, "{platform}");
    assert_eq!(found["stopped"]["kind"], "tilt_limit");
    let far = json!({ "kind": "slot", "radial_m": 1.0, "turn_rad": 0.0, "height_m": 0.0, "heading_rad": 0.0 });
    let found = jog(&server, json!({ "seen_from": { "station": "LP1", "slot": 3 }, "to": far }));
    assert_eq!(found["stopped"]["kind"], "out_of_reach", "{}", found["stopped"]);
    assert!(found["from_slot"]["radial_m"].as_f64().unwrap() < 1.0);
}

#[test]
fn a_wafer_in_the_slot_teaches_the_station() {
    let server = server(CellFiles::example());
    let into = json!({ "kind": "slot", "radial_m": 0.0, "turn_rad": 0.0, "height_m": 0.0, "heading_rad": 0.0 });
    let found = jog(
        &server,
        json!({ "seen_from": { "station": "LP2", "slot": 4 }, "effector": "B", "to": into }),
    );
    assert_eq!(found["stopped"], Value::Null);
    let seen = &found["from_slot"];
    for value in ["radial_m", "turn_rad", "height_m"] {
        assert!(seen[value].as_f64().unwrap().abs() < 1e-10, "{seen}");
    }
    let here = seen["station_if_here"]["point_m"].as_array().unwrap();
    for (found, wanted) in here.iter().zip([-0.495, -0.495, 0.5]) {
        assert!((found.as_f64().unwrap() - wanted).abs() < 1e-10, "{seen}");
    }
    let tilt = seen["station_if_here"]["tilt_angle_rad"].as_f64().unwrap().to_degrees();
    assert!((tilt - 0.8).abs() < 1e-9, "{seen}");
    assert!(
        found["branches"].as_array().unwrap().iter().any(|branch| branch["selection"] == "chosen")
    );
    // In the base frame, 1 cm up.
    let effector = &found["effectors"][1];
    let mut center = effector["center_m"].clone();
    center[2] = (center[2].as_f64().unwrap() + 0.01).into();
    let up = json!({ "kind": "world", "center_m": center, "heading_rad": effector["heading_rad"],
        "about_x_rad": effector["about_x_rad"], "about_y_rad": effector["about_y_rad"] });
    let from = positions(&found);
    let raised = jog(&server, json!({ "from": from, "effector": "B", "to": up }));
    assert_eq!((&raised["stopped"], &raised["from_slot"]), (&Value::Null, &Value::Null));
    let found = raised["effectors"][1]["center_m"][2].as_f64().unwrap();
    assert!((found - center[2].as_f64().unwrap()).abs() < 1e-11);
}

#[test]
fn invalid_requests_name_their_field() {
    let server = server(CellFiles::example());
    for (body, field) in [
        (json!({ "from": [0.5] }), "from"),
        (json!({ "from": [0.5, 0.5, 0.5, 1e300, 0.0, 0.0] }), "from[3]"),
        (json!({ "effector": "C" }), "effector"),
        (json!({ "seen_from": { "station": "LP9", "slot": 1 } }), "seen_from.station"),
        (json!({ "seen_from": { "station": "LP1", "slot": 26 } }), "seen_from.slot"),
        (json!({ "to": { "kind": "fly" } }), "to.kind"),
        (json!({ "to": { "kind": "axes", "positions": [] } }), "to.positions"),
        (
            json!({ "to": { "kind": "platform", "height_m": 0.5, "about_x_rad": 1.6, "about_y_rad": 0 } }),
            "to.about_x_rad",
        ),
        (
            json!({ "to": { "kind": "slot", "radial_m": 0, "turn_rad": 0, "height_m": 0, "heading_rad": 0 } }),
            "seen_from",
        ),
        (
            json!({ "to": { "kind": "world", "center_m": [0, 0, 2000], "heading_rad": 0, "about_x_rad": 0, "about_y_rad": 0 } }),
            "to.center_m[2]",
        ),
    ] {
        let mut body = body;
        body["program"] = SHORT.into();
        let answer = ask(&server, Method::POST, "cell/jog", &body);
        assert_eq!(
            (answer.status, &answer.json()["field"]),
            (StatusCode::UNPROCESSABLE_ENTITY, &field.into()),
            "{body}"
        );
    }
    let unread = ask(&server, Method::POST, "cell/jog", &json!({ "cell": "kind = 3" }));
    assert_eq!(unread.status, StatusCode::CONFLICT);
}

#[test]
fn an_arm_of_unknown_droop_is_rigid_and_can_be_jogged() {
    let folder = tempfile::tempdir().unwrap();
    let known = r#"droop = { kind = "cantilever", stiffness_n_m2 = 1500.0, mass_kg_m = 2.5 }"#;
    let table = r#"droop = { kind = "table", row = [
        { reach_mm = 400.0, empty_drop_mm = 0.1, empty_slope_mrad = 0.3, loaded_drop_mm = 0.15, loaded_slope_mrad = 0.4, load_g = 128.0 },
        { reach_mm = 750.0, empty_drop_mm = 0.3, empty_slope_mrad = 0.8, loaded_drop_mm = 0.45, loaded_slope_mrad = 1.1, load_g = 128.0 },
    ] }"#;
    let robot = jointplay::format::catalogue::find("dual-arm").unwrap().text;
    let cell = jointplay::format::cell::EXAMPLE;
    assert!(robot.contains(known));
    std::fs::write(folder.path().join("arm.toml"), robot.replacen(known, table, 1)).unwrap();
    let path = folder.path().join("cell.toml");
    std::fs::write(&path, cell.replace("\"dual-arm\"", "\"arm.toml\"")).unwrap();
    let server = server(CellFiles::open(&path).unwrap());
    // Retracted below the first row of the table: the arm is rigid, with a reason in mm.
    let home = jog(&server, json!({ "seen_from": { "station": "LP1", "slot": 1 } }));
    let unknown = home["effectors"][0]["droop_unknown"].as_str().unwrap();
    assert!(unknown.contains("4.318 mm") && unknown.contains("400.000 to 750.000 mm"), "{unknown}");
    assert_eq!(home["effectors"][1]["droop_unknown"], Value::Null);
    assert!(home["from_slot"]["radial_m"].as_f64().unwrap() < -0.5, "{}", home["from_slot"]);
    assert!(!home["frames"].as_array().unwrap().is_empty());
    // Into the slot, where the droop is known.
    let into = json!({ "kind": "slot", "radial_m": 0.0, "turn_rad": 0.0, "height_m": 0.0, "heading_rad": 0.0 });
    let there = jog(&server, json!({ "seen_from": { "station": "LP1", "slot": 1 }, "to": into }));
    assert_eq!(there["stopped"], Value::Null);
    assert_eq!(there["effectors"][0]["droop_unknown"], Value::Null);
    assert!(there["from_slot"]["height_m"].as_f64().unwrap().abs() < 1e-10);
    // Toward a position of unknown droop, the robot stops with a reason.
    let back = json!({ "kind": "slot", "radial_m": -0.6, "turn_rad": 0.0, "height_m": 0.0, "heading_rad": 0.0 });
    let stopped = jog(
        &server,
        json!({ "from": positions(&there), "seen_from": { "station": "LP1", "slot": 1 }, "to": back }),
    );
    assert_eq!(stopped["stopped"]["kind"], "droop", "{}", stopped["stopped"]);
}

/// Positions with the arm of A extended through the wall of the cell.
fn through_the_wall(home: &Value) -> Vec<f64> {
    let mut to = positions(home);
    (to[3], to[4]) = (-90_f64.to_radians(), 60_f64.to_radians());
    to
}

#[test]
fn every_pose_is_checked_and_a_contact_stops_a_jog() {
    let server = server(CellFiles::example());
    let home = jog(&server, json!({}));
    assert_eq!(home["check"]["violations"], json!([]));
    assert_eq!(home["check"]["in_contact"], json!([]));
    let distances = home["check"]["distances"].as_array().unwrap();
    let apart: Vec<f64> = distances.iter().map(|one| one["distance_m"].as_f64().unwrap()).collect();
    assert!(!apart.is_empty() && apart.windows(2).all(|two| two[0] <= two[1]), "{apart:?}");
    let to = through_the_wall(&home);
    let through = json!({ "to": { "kind": "axes", "positions": to } });
    let found = jog(&server, through.clone());
    assert_eq!((&found["stopped"], positions(&found)), (&Value::Null, to.clone()));
    let touching = found["check"]["in_contact"].as_array().unwrap();
    for name in ["wall", "blade-A"] {
        assert!(touching.contains(&json!({ "kind": "body", "name": name })), "{found}");
    }
    let violation = &found["check"]["violations"][0];
    assert_eq!((&violation["kind"], &violation["is_contact"]), (&"collision".into(), &true.into()));
    let message = violation["message"].as_str().unwrap();
    assert!(message.contains("penetration depth") || message.contains("touch"), "{message}");
    // The same jog with a stop at contact.
    let mut before = through;
    before["stop_at_contact"] = true.into();
    let stopped = jog(&server, before);
    assert_eq!(stopped["stopped"]["kind"], "contact", "{}", stopped["stopped"]);
    let names = &stopped["stopped"]["contact"];
    assert_eq!(names.as_array().unwrap().len(), 2);
    let reason = stopped["stopped"]["reasons"][0].as_str().unwrap();
    assert!(
        reason.contains(names[0].as_str().unwrap()) && reason.ends_with("would touch"),
        "{reason}"
    );
    assert_eq!(stopped["check"]["in_contact"], json!([]));
    let nearest = stopped["check"]["distances"][0]["distance_m"].as_f64().unwrap();
    assert!(nearest > 0.0 && nearest < 1e-6, "{nearest}");
    // On the straight line of all axes.
    let (start, end) = (positions(&home), positions(&stopped));
    let share = |axis: usize| (end[axis] - start[axis]) / (to[axis] - start[axis]);
    assert!((share(3) - share(4)).abs() < 1e-12 && share(3) > 0.1 && share(3) < 1.0);
    // A jog out of a contact is not stopped.
    let back = json!({
        "from": to, "to": { "kind": "axes", "positions": start }, "stop_at_contact": true,
    });
    assert_eq!(positions(&jog(&server, back)), start);
}

#[test]
fn nearest_points_are_on_both_bodies_at_the_reported_distance() {
    let server = server(CellFiles::example());
    let home = jog(&server, json!({}));
    let (start, to) = (positions(&home), through_the_wall(&home));
    let stop = json!({ "to": { "kind": "axes", "positions": to }, "stop_at_contact": true });
    let end = positions(&jog(&server, stop));
    let mut on_the_wall = 0;
    for share in [0.0, 0.3, 0.6, 0.8, 0.9, 0.94, 0.97, 0.985, 0.995] {
        let at: Vec<f64> = start.iter().zip(&end).map(|(a, b)| a + share * (b - a)).collect();
        let found = jog(&server, json!({ "to": { "kind": "axes", "positions": at } }));
        for pair in found["check"]["distances"].as_array().unwrap() {
            let point = |k: usize| -> Vec<f64> {
                serde_json::from_value(pair["nearest_points_m"][k].clone()).unwrap()
            };
            let (first, second) = (point(0), point(1));
            let apart = first.iter().zip(&second).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            assert!((apart - pair["distance_m"].as_f64().unwrap()).abs() < 1e-6, "{pair}");
            let bodies = pair["entities"].as_array().unwrap();
            if let Some(k) = bodies.iter().position(|one| one["name"] == "wall") {
                on_the_wall += 1;
                // The box of the file: its point is on the surface.
                let [center, half] = [[0.1, -0.6, 0.5], [0.3, 0.01, 0.5]];
                let off: Vec<f64> =
                    (0..3).map(|i| (point(k)[i] - center[i]).abs() - half[i]).collect();
                let farthest = off.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                assert!(farthest.abs() < 1e-7, "{pair}");
            }
        }
    }
    assert!(on_the_wall > 3, "{on_the_wall}");
}

#[test]
fn teaching_in_contact_requires_a_confirmation_and_adds_a_comment() {
    let server = server(CellFiles::example());
    let home = jog(&server, json!({}));
    let teach = |at: Vec<f64>, confirm: bool, cell: Option<&str>| {
        let mut body = json!({
            "station": "LP2",
            "position_m": [-0.495, -0.495, 0.501],
            "taught_by": {
                "program": SHORT, "positions": at, "slot": 4, "confirm_contact": confirm,
            },
        });
        if let Some(cell) = cell {
            body["cell"] = cell.into();
        }
        ask(&server, Method::POST, "cell/station", &body)
    };
    let through = through_the_wall(&home);
    let refused = teach(through.clone(), false, None);
    assert_eq!(refused.status, StatusCode::CONFLICT);
    let problem = refused.json();
    assert_eq!(problem["field"], "taught_by.confirm_contact");
    let detail = problem["detail"].as_str().unwrap();
    assert!(detail.contains("wall") && detail.contains("confirm"), "{detail}");
    let taught = teach(through, true, None);
    assert_eq!(taught.status, StatusCode::OK);
    let taught = taught.json();
    let text = taught["cell"].as_str().unwrap();
    let (above, _) = text.split_once("name = \"LP2\"").unwrap();
    let note = above.lines().rev().find(|line| line.starts_with('#')).unwrap();
    assert!(note.starts_with("# Taught in contact: ") && note.contains("wall"), "{note}");
    assert!(!taught["contacts"].as_array().unwrap().is_empty());
    assert!(text.contains("[-495.0, -495.0, 501.0]"), "{text}");
    // Teaching without a contact removes the comment; all other lines are unchanged.
    let again = teach(positions(&home), false, Some(text)).json();
    let clean = again["cell"].as_str().unwrap();
    assert_eq!((clean.contains("Taught in contact"), &again["contacts"]), (false, &json!([])));
    assert_eq!(clean.lines().count() + 1, text.lines().count());
}
