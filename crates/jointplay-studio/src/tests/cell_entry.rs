//! Entries of a cell file, added, duplicated and removed.

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
        (json!({ "action": "add", "list": "effector" }), "needs an arm"),
        (json!({ "action": "add", "list": "effector", "arm": "uper" }), "upper"),
        (json!({ "action": "add", "list": "arm" }), "at most 2"),
        (json!({ "action": "remove", "list": "arm", "name": "uper" }), "upper"),
        (json!({ "action": "remove", "list": "effector", "name": "A" }), "at least one"),
    ] {
        let answer = ask(&server, Method::POST, "cell/entry", &body);
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{body}");
        let detail = answer.json()["detail"].as_str().unwrap().to_owned();
        assert!(detail.contains(expected), "{detail}");
    }
}

#[test]
fn arms_and_effectors_are_added_duplicated_and_removed() {
    let server = server(CellFiles::example());
    let change = |body: &Value| {
        let answer = ask(&server, Method::POST, "cell/entry", body);
        assert_eq!(answer.status, StatusCode::OK, "{}", String::from_utf8_lossy(&answer.bytes));
        answer.json()
    };
    // Names of arms and effectors; whether an arm can be added and removed, and effectors of the first one.
    let robot = |cell: &Value| {
        let found = plan(&server, &json!({ "cell": cell, "program": "HOME\n" }));
        assert_eq!(found["diagnostics"], json!([]));
        assert_eq!(found["violations"], 0);
        let robot = &found["robot"];
        let names = |key: &str| -> Vec<String> {
            let arms = robot["arms"].as_array().unwrap().iter();
            arms.map(|arm| arm[key].to_string().replace('"', "")).collect()
        };
        let arm = &robot["arms"][0];
        let allowed = [robot, arm].map(|it| [&it["add_refusal"], &it["remove_refusal"]]);
        let allowed = allowed.map(|two| two.map(Value::is_null));
        (names("name").join(" "), names("effectors").join(" "), allowed)
    };
    let names =
        |arms: &str, effectors: &str, allowed| (arms.to_owned(), effectors.to_owned(), allowed);
    let example = json!(jointplay::format::cell::EXAMPLE);
    assert_eq!(robot(&example), names("upper lower", "[A] [B]", [[false, true], [true, false]]));
    let one = change(&json!({ "action": "remove", "list": "arm", "name": "upper" }));
    assert_eq!(one["name"], Value::Null);
    assert_eq!(robot(&one["cell"]), names("lower", "[B]", [[true, false], [true, false]]));
    let two = change(
        &json!({ "cell": one["cell"], "action": "duplicate", "list": "arm", "name": "lower" }),
    );
    assert_eq!(two["name"], "lower2");
    assert_eq!(
        robot(&two["cell"]),
        names("lower lower2", "[B] [B2]", [[false, true], [true, false]])
    );
    let added = change(&json!({ "cell": one["cell"], "action": "add", "list": "arm" }));
    assert_eq!(added["name"], "arm-1");
    let blades =
        json!({ "cell": added["cell"], "action": "duplicate", "list": "effector", "name": "B" });
    let blades = change(&blades);
    assert_eq!(blades["name"], "B2");
    assert_eq!(
        robot(&blades["cell"]),
        names("lower arm-1", "[B,B2] [A]", [[false, true], [true, true]])
    );
    let blade = change(
        &json!({ "cell": blades["cell"], "action": "remove", "list": "effector", "name": "B2" }),
    );
    assert_eq!(blade["cell"], added["cell"]);
    let blade = change(
        &json!({ "cell": added["cell"], "action": "add", "list": "effector", "arm": "arm-1" }),
    );
    assert_eq!(blade["name"], "A2");
    assert_eq!(
        robot(&blade["cell"]),
        names("lower arm-1", "[B] [A,A2]", [[false, true], [true, false]])
    );
    let back = change(
        &json!({ "cell": added["cell"], "action": "remove", "list": "arm", "name": "arm-1" }),
    );
    assert_eq!(back["cell"], one["cell"]);
}

#[test]
fn arms_in_a_file_of_their_own_are_not_changed() {
    let folder = tempfile::tempdir().unwrap();
    let robot = jointplay::format::catalogue::find("radial-arm").unwrap().text;
    std::fs::write(folder.path().join("arm.toml"), robot).unwrap();
    let cell = "kind = \"cell\"\nname = \"x\"\nrobot = \"arm.toml\"\nwafer = { diameter_mm = 300, thickness_mm = 0.775, material = \"silicon\" }\nbudgets = { virtual_joint_norm_um = 60, min_distance_mm = 1, slot_min_distance_mm = 1, plane_urad = 20 }\nstation = [{ name = \"P\", position_mm = [600, 0, 560], heading_deg = -90, stroke = { below_mm = 4, above_mm = 3, speed_mm_s = 20 }, retract_mm = 10 }]\n";
    let path = folder.path().join("cell.toml");
    std::fs::write(&path, cell).unwrap();
    let server = server(CellFiles::open(&path).unwrap());
    let found = plan(&server, &json!({ "program": "HOME\n" }));
    assert_eq!(found["diagnostics"], json!([]));
    let reason = found["robot"]["add_refusal"].as_str().unwrap();
    assert!(reason.contains("\"arm.toml\""), "{reason}");
    let answer =
        ask(&server, Method::POST, "cell/entry", &json!({ "action": "add", "list": "arm" }));
    assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
    let detail = answer.json()["detail"].as_str().unwrap().to_owned();
    assert!(detail.contains(reason), "{detail}");
}
