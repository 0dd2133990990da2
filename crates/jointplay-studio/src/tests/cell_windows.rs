//! Long programs: windows of the motion, paged lists, cancelled plans.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use axum::Router;
use axum::body::Body;
use axum::http::{Method, Request, StatusCode, header};
use jointplay::format::robot;
use serde_json::{Value, json};
use tower::ServiceExt as _;

use super::cell::{SHORT, ask, fetch, plan, server, unpacked, window};
use super::{HOST, PORT, send_to, state};
use crate::cell_files::CellFiles;
use crate::session::WorkcellSession;

/// The plan of a cell whose wall is in the path of the arms, with messages in the unit of a header.
fn blocked(server: &Router, unit: &str) -> Value {
    let cell = cell().replace("[100.0, -600.0, 500.0]", "[-330.0, 330.0, 500.0]");
    let request = Request::post("/api/v1/cell/plan")
        .header(header::HOST, HOST)
        .header(header::CONTENT_TYPE, "application/json")
        .header("length-unit", unit)
        .body(Body::from(json!({ "cell": cell, "program": SHORT }).to_string()));
    send_to(server.clone(), request.unwrap()).json()
}

#[test]
fn violations_of_plans_and_windows_are_in_the_unit_of_the_request() {
    let server = server(CellFiles::example());
    let depth = |unit: &str, name: &str| {
        let found = blocked(&server, unit);
        let messages = |list: &Value| -> Vec<String> {
            list.as_array().unwrap().iter().map(|one| one["message"].to_string()).collect()
        };
        let report = &found["report"];
        let listed = messages(&report["violations"]);
        let windows = keys(&found);
        let in_windows: Vec<String> = windows
            .iter()
            .flat_map(|key| messages(&window(&server, key).0["violations"]))
            .collect();
        let collision = listed.iter().find(|one| one.contains("blade-A and wall collide")).unwrap();
        assert!(in_windows.contains(collision), "{in_windows:?}");
        let (_, rest) = collision.split_once("penetration depth of ").unwrap();
        let (number, found_unit) = rest.trim_end_matches('"').split_once(' ').unwrap();
        assert_eq!(found_unit, name, "{collision}");
        let unit = report["violation_groups"].as_array().unwrap().iter().map(|one| &one["unit"]);
        assert!(unit.clone().any(|one| one == name), "{report}");
        number.parse::<f64>().unwrap()
    };
    let [mm, inches] = [depth("mm", "mm"), depth("in", "in")];
    assert!((mm / 25.4 - inches).abs() < 1e-4, "{mm} mm, {inches} in");
}

/// All entities of a list of violations.
fn entities(violations: &Value) -> BTreeSet<String> {
    let violations = violations.as_array().unwrap().iter();
    violations.flat_map(|one| one["entities"].as_array().unwrap()).map(Value::to_string).collect()
}

#[test]
fn violations_name_their_entities_with_kinds() {
    let server = server(CellFiles::example());
    // The wall is in the path of the arms; a zone has the name of the wall.
    let zone = "\n[[zone]]\nname = \"wall\"\nrule = \"keep-out\"\nposition_mm = [2000, 0, 0]\nbox = { size_mm = [10, 10, 10] }\n";
    let cell = cell().replace("[100.0, -600.0, 500.0]", "[-330.0, 330.0, 500.0]") + zone;
    let found = plan(&server, &json!({ "cell": cell, "program": SHORT }));
    assert_eq!(found["diagnostics"], json!([]));
    let [wall, zone] =
        ["body", "zone"].map(|kind| json!({ "kind": kind, "name": "wall" }).to_string());
    let groups = entities(&found["report"]["violation_groups"]);
    let listed = entities(&found["report"]["violations"]);
    let in_windows: BTreeSet<String> = keys(&found)
        .iter()
        .flat_map(|key| entities(&window(&server, key).0["violations"]))
        .collect();
    assert_eq!(listed, in_windows);
    for found in [&groups, &listed] {
        assert!(found.contains(&wall) && !found.contains(&zone), "{found:?}");
    }
    // Texts have the kind of entities whose name is not unique, and of no others.
    let report = &found["report"];
    let messages =
        report["violations"].as_array().unwrap().iter().map(|one| one["message"].to_string());
    assert!(messages.clone().any(|one| one.contains("blade-A and body wall collide")), "{report}");
    let nearest: Vec<String> =
        report["nearest"].as_array().unwrap().iter().map(|one| one["bodies"].to_string()).collect();
    assert!(nearest.contains(&r#"["blade-A","body wall"]"#.to_owned()), "{nearest:?}");
}

/// A program that transfers a wafer forth and back `count` times.
fn long(lines: usize) -> String {
    let mut text = String::from("HOME\n");
    for line in 0..lines {
        let stations = if line % 2 == 0 { ["LP1", "LP2"] } else { ["LP2", "LP1"] };
        writeln!(text, "TRANSFER {} SLOT 1 TO {} SLOT 1 WITH A", stations[0], stations[1]).unwrap();
    }
    text
}

/// The example cell with a free slot for this program.
fn cell() -> String {
    jointplay::format::cell::EXAMPLE.to_owned()
}

fn keys(plan: &Value) -> Vec<Value> {
    plan["windows"].as_array().unwrap().iter().map(|window| window["key"].clone()).collect()
}

#[test]
fn an_edit_of_one_line_keeps_the_keys_of_other_windows() {
    let server = server(CellFiles::example());
    let text = long(200);
    let first = plan(&server, &json!({ "cell": cell(), "program": text }));
    assert_eq!(first["diagnostics"], json!([]));
    let known: BTreeSet<String> = keys(&first).iter().map(Value::to_string).collect();
    assert!(keys(&first).len() >= 15, "{}", keys(&first).len());
    let mut lines: Vec<&str> = text.lines().collect();
    lines.insert(100, "WAIT 1 s");
    let second = plan(&server, &json!({ "cell": cell(), "program": lines.join("\n") }));
    let unknown = keys(&second).iter().filter(|key| !known.contains(&key.to_string())).count();
    assert!((1..=2).contains(&unknown), "{unknown} of {}", keys(&second).len());
    // A comment changes line numbers only, which are not part of the windows.
    lines.insert(50, "# Half of it.");
    let third = plan(&server, &json!({ "cell": cell(), "program": lines.join("\n") }));
    let listed: BTreeSet<String> = keys(&second).iter().map(Value::to_string).collect();
    let unknown = keys(&third).iter().filter(|key| !listed.contains(&key.to_string())).count();
    assert!(unknown <= 1, "{unknown}: the one in which the remark is");
    // The contents for a key do not depend on the plan.
    let same = keys(&third).last().unwrap().clone();
    assert_eq!(keys(&second).last().unwrap(), &same);
    let answer = fetch(&server, &format!("cell/windows/{}", same.as_str().unwrap()));
    assert!(answer.header("cache-control").contains("immutable"));
}

#[test]
fn a_long_plan_is_small_and_its_lists_are_paged() {
    let server = server(CellFiles::example());
    let body = json!({ "cell": cell(), "program": long(400) });
    let answer = ask(&server, Method::POST, "cell/plan", &body);
    let (short, found) = (answer.bytes.len(), answer.json());
    let body = json!({ "cell": cell(), "program": long(800) });
    let longer = ask(&server, Method::POST, "cell/plan", &body);
    let a_line = (longer.bytes.len() - short) as f64 / 400.0;
    assert!(a_line < 30.0, "{a_line} bytes a line");
    assert!(short < 60_000, "{short}");
    // HOME at the home position is not a motion.
    assert_eq!(found["instructions"], 400);
    assert_eq!(found["report"]["instructions"], json!([]));
    let page = |list: &str, number: &str| {
        let key = found["key"].as_str().unwrap();
        fetch(&server, &format!("cell/plans/{key}/{list}/{number}"))
    };
    let last = page("instructions", "3").json();
    assert_eq!(last["total"], 400);
    assert_eq!(last["instructions"].as_array().unwrap().len(), 100);
    assert_eq!(last["instructions"][99]["number"], 401);
    assert_eq!(page("instructions", "9").json()["instructions"], json!([]));
    assert_eq!(page("violations", "0").json(), json!({ "total": 0, "violations": [] }));
    for invalid in ["-1", "x", "1.5"] {
        assert_eq!(page("instructions", invalid).status, StatusCode::NOT_FOUND, "{invalid}");
    }
    for path in ["cell/plans/none/instructions/0", "cell/windows/none", "cell/scenes/none"] {
        assert_eq!(fetch(&server, path).status, StatusCode::NOT_FOUND, "{path}");
    }
    let windows = keys(&found).len();
    let asked = json!({ "plan": found["key"], "windows": [0, windows - 1] });
    let (described, numbers) = unpacked(&ask(&server, Method::POST, "cell/overview", &asked).bytes);
    assert_eq!((&described, numbers.len()), (&json!({ "windows": 2, "axes": 6 }), 2 * 6 * 7));
    let asked = json!({ "plan": found["key"], "windows": [windows] });
    assert_eq!(ask(&server, Method::POST, "cell/overview", &asked).json()["field"], "windows[0]");
    let asked = json!({ "plan": found["key"], "windows": vec![0; windows + 1] });
    assert_eq!(ask(&server, Method::POST, "cell/overview", &asked).json()["field"], "windows");
}

#[test]
fn an_overview_bounds_all_values_of_its_window() {
    let server = server(CellFiles::example());
    let found = plan(&server, &json!({ "program": SHORT }));
    let (description, numbers) = window(&server, &found["windows"][0]["key"]);
    let asked = json!({ "plan": found["key"], "windows": [0] });
    let (_, bounds) = unpacked(&ask(&server, Method::POST, "cell/overview", &asked).bytes);
    let mut moving = [0.0; 6];
    for step in description["steps"].as_array().unwrap() {
        let segment = &description["segments"][step["segment"].as_u64().unwrap() as usize];
        for axis in segment["moving"].as_array().unwrap() {
            moving[axis.as_u64().unwrap() as usize] += segment["duration_s"].as_f64().unwrap();
        }
        for (axis, bounds) in bounds.chunks_exact(7).enumerate() {
            let place =
                &description["channels"][segment["channels"][axis].as_u64().unwrap() as usize];
            let [from, count] = [0, 1].map(|k| place[k].as_u64().unwrap() as usize);
            let values = &numbers[from + count..from + 2 * count];
            let rates = &numbers[from + 2 * count..from + 3 * count];
            for (values, [least, most]) in
                [(values, [bounds[0], bounds[1]]), (rates, [bounds[2], bounds[3]])]
            {
                for value in values {
                    assert!(
                        (least - 1e-6..=most + 1e-6).contains(value),
                        "{axis}: {value} {least} {most}"
                    );
                }
            }
        }
    }
    for (axis, moving) in moving.iter().enumerate() {
        assert!((bounds[7 * axis + 6] - moving).abs() < 1e-9, "{axis}");
    }
}

#[test]
fn changed_lines_replace_complete_texts() {
    let server = server(CellFiles::example());
    let first = plan(&server, &json!({ "program": "HOME\nWAIT 1 s\nHOME\n" }));
    let lines = json!({ "from": 1, "count": 1, "lines": ["WAIT 2 s", "WAIT 3 s"] });
    let since = json!({ "since": { "plan": first["key"], "program": lines } });
    let second = plan(&server, &since);
    let whole = plan(&server, &json!({ "program": "HOME\nWAIT 2 s\nWAIT 3 s\nHOME\n" }));
    assert_eq!((&second["key"], &second["report"]), (&whole["key"], &whole["report"]));
    assert_eq!(second["report"]["duration_s"], 5.0);
    let planned_since =
        |since: Value| ask(&server, Method::POST, "cell/plan", &json!({ "since": since }));
    let beyond = planned_since(
        json!({ "plan": first["key"], "program": { "from": 4, "count": 1, "lines": [] } }),
    );
    assert_eq!(
        (beyond.status, &beyond.json()["field"]),
        (StatusCode::UNPROCESSABLE_ENTITY, &"since.program".into())
    );
    let huge = planned_since(
        json!({ "plan": first["key"], "program": { "from": 1, "count": usize::MAX, "lines": [] } }),
    );
    assert_eq!(huge.status, StatusCode::UNPROCESSABLE_ENTITY);
    let unknown = planned_since(json!({ "plan": "none" }));
    assert_eq!((unknown.status, &unknown.json()["field"]), (StatusCode::CONFLICT, &"since".into()));
    // The robot is jogged in a kept plan.
    let jog =
        ask(&server, Method::POST, "cell/jog", &json!({ "plan": second["key"], "time_s": 4.0 }));
    assert_eq!(jog.status, StatusCode::OK);
    assert_eq!(
        ask(&server, Method::POST, "cell/jog", &json!({ "plan": "none" })).status,
        StatusCode::NOT_FOUND
    );
}

#[test]
fn samples_of_a_long_motion_are_requested_in_ranges() {
    let server = server(CellFiles::example());
    let program = "HOME\nWAIT 86400 s\nHOME\n";
    let all = ask(&server, Method::POST, "cell/samples", &json!({ "program": program }));
    assert_eq!(
        (all.status, &all.json()["field"]),
        (StatusCode::UNPROCESSABLE_ENTITY, &"to_s".into())
    );
    let stretch = json!({ "program": program, "from_s": 100.0, "to_s": 110.0 });
    let some = ask(&server, Method::POST, "cell/samples", &stretch);
    assert_eq!(some.status, StatusCode::OK);
    let read = arrow_ipc::reader::StreamReader::try_new(some.bytes.as_slice(), None).unwrap();
    let rows: usize = read.map(|batch| batch.unwrap().num_rows()).sum();
    assert_eq!(rows, 251);
}

#[test]
fn planning_stops_when_the_client_disconnects() {
    let mut state = state(robot::paper(), None).unwrap();
    let session = WorkcellSession::new(CellFiles::example());
    state.cell = Some(session.clone());
    let work = state.work.clone();
    let server = crate::router::router(state, PORT);
    let body = json!({ "cell": cell(), "program": long(8_000) }).to_string();
    let request = Request::post("/api/v1/cell/plan").header(header::HOST, HOST);
    let request = request.header(header::CONTENT_TYPE, "application/json");
    let request = request.body(Body::from(body)).unwrap();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(async {
        let asked = tokio::spawn(server.oneshot(request));
        while work.running() == 0 {
            tokio::task::yield_now().await;
        }
        // The client disconnects.
        asked.abort();
        assert!(asked.await.is_err());
        while work.running() > 0 {
            tokio::task::yield_now().await;
        }
    });
    assert_eq!(session.plan_keys(), Vec::<String>::new(), "it was stopped before it was done");
    let plan = session.plan(cell(), SHORT.to_owned(), &|| false).unwrap();
    assert!(plan.report.is_some());
}
