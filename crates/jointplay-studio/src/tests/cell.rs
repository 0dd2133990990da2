//! The cell: its texts, plans and files.

use std::path::Path;

use arrow_ipc::reader::StreamReader;
use axum::Router;
use axum::body::Body;
use axum::http::{Method, Request, StatusCode, header};
use jointplay::format::robot;
use serde_json::{Value, json};

use super::{Answer, HOST, PORT, get, send_to, state};
use crate::cell_files::CellFiles;
use crate::session::WorkcellSession;

/// A short program.
pub(super) const SHORT: &str = "HOME\nGET LP1 SLOT 1 WITH A\nPUT LP1 SLOT 1 WITH A\n";

pub(super) fn server(files: CellFiles) -> Router {
    let mut state = state(robot::paper(), None).unwrap();
    state.cell = Some(WorkcellSession::new(files));
    crate::router::router(state, PORT)
}

pub(super) fn ask(server: &Router, method: Method, path: &str, body: &Value) -> Answer {
    let request = Request::builder().method(method).uri(format!("/api/v1/{path}"));
    let request =
        request.header(header::HOST, HOST).header(header::CONTENT_TYPE, "application/json");
    send_to(server.clone(), request.body(Body::from(body.to_string())).unwrap())
}

#[track_caller]
pub(super) fn plan(server: &Router, body: &Value) -> Value {
    let answer = ask(server, Method::POST, "cell/plan", body);
    assert_eq!(answer.status, StatusCode::OK, "{}", String::from_utf8_lossy(&answer.bytes));
    answer.json()
}

pub(super) fn fetch(server: &Router, path: &str) -> Answer {
    let request = Request::get(format!("/api/v1/{path}")).header(header::HOST, HOST);
    send_to(server.clone(), request.body(Body::empty()).unwrap())
}

/// Description and numbers of a window.
pub(super) fn window(server: &Router, key: &Value) -> (Value, Vec<f64>) {
    let answer = fetch(server, &format!("cell/windows/{}", key.as_str().unwrap()));
    assert_eq!(answer.status, StatusCode::OK, "{}", String::from_utf8_lossy(&answer.bytes));
    unpacked(&answer.bytes)
}

/// Unpacks a JSON text followed by numbers.
pub(super) fn unpacked(bytes: &[u8]) -> (Value, Vec<f64>) {
    let (length, rest) = bytes.split_at(4);
    let length = u32::from_le_bytes(length.try_into().unwrap()) as usize;
    let (text, numbers) = rest.split_at(length);
    let number = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().unwrap());
    (serde_json::from_slice(text).unwrap(), numbers.chunks_exact(8).map(number).collect())
}

/// The motions of a plan with a duration above zero, with their times since the start.
pub(super) fn steps(server: &Router, plan: &Value) -> Vec<Value> {
    let mut steps = Vec::new();
    for shown in plan["windows"].as_array().unwrap() {
        let (description, _) = window(server, &shown["key"]);
        let mut now = shown["start_s"].as_f64().unwrap();
        for step in description["steps"].as_array().unwrap() {
            let segment = &description["segments"][step["segment"].as_u64().unwrap() as usize];
            let (start, duration) = (now, segment["duration_s"].as_f64().unwrap());
            now += duration;
            if duration > 0.0 {
                let mut step = step.clone();
                (step["start_s"], step["end_s"]) = (start.into(), now.into());
                steps.push(step);
            }
        }
    }
    steps
}

#[test]
fn a_server_without_a_cell_returns_404() {
    let answer = get("/api/v1/cell");
    assert_eq!(answer.status, StatusCode::NOT_FOUND);
    assert!(answer.json()["detail"].as_str().unwrap().contains("--cell"));
    assert_eq!(get("/api/v1/robot").json()["cell"], false);
}

#[test]
fn a_wait_of_zero_duration_is_not_a_step() {
    let server = server(CellFiles::example());
    let waits = |program: &str| {
        let found = plan(&server, &json!({ "program": program }));
        let (report, steps) = (&found["report"], steps(&server, &found));
        assert_eq!(report["steps"], steps.len());
        let path = format!("cell/plans/{}/instructions/0", found["key"].as_str().unwrap());
        let rows = fetch(&server, &path).json()["instructions"].clone();
        let counted = rows.as_array().unwrap().iter();
        let counted = counted.map(|row| row["steps"].as_u64().unwrap()).sum::<u64>();
        assert_eq!(counted, steps.len() as u64);
        let lasts = |step: &&Value| step["end_s"].as_f64() > step["start_s"].as_f64();
        assert_eq!(steps.iter().filter(lasts).count(), steps.len());
        steps.iter().filter(|step| step["phase"] == "wait").count()
    };
    let there = "HOME\nTRANSFER LP1 SLOT 1 TO ALIGN WITH A\n";
    assert_eq!(waits(&format!("{there}GET ALIGN WITH A\n")), 1);
    // The aligner operates after the motion.
    assert_eq!(waits(&format!("{there}WAIT 60 s\nGET ALIGN WITH A\n")), 1);
    assert_eq!(waits(&format!("{there}WAIT 0 s\n")), 0);
}

#[test]
fn a_program_that_only_waits_has_not_passed() {
    let server = server(CellFiles::example());
    for (program, result) in
        [("WAIT 2 s\n", "no_motion"), ("HOME\n", "no_motion"), (SHORT, "passed")]
    {
        let found = plan(&server, &json!({ "program": program }));
        assert_eq!(found["report"]["result"], result, "{program}");
    }
}

#[test]
fn a_plan_has_report_windows_and_scene() {
    let server = server(CellFiles::example());
    let found = plan(&server, &json!({ "program": SHORT }));
    assert_eq!(found["diagnostics"], json!([]));
    assert_eq!(found["report"]["result"], "passed", "{}", found["report"]["violations"]);
    let (report, steps) = (&found["report"], steps(&server, &found));
    assert_eq!(report["steps"], steps.len());
    let end = steps.last().unwrap()["end_s"].as_f64().unwrap();
    assert!((end - report["duration_s"].as_f64().unwrap()).abs() < 1e-9, "{end}");
    assert!(steps.iter().any(|step| step["phase"] == "lift" && step["loaded"] == json!([0])));
    assert_eq!(
        found["stations"][1]["tilt_angle_deg"].as_f64().map(|tilt| (tilt * 1e9).round() / 1e9),
        Some(0.8)
    );
    let shown = fetch(&server, &format!("cell/scenes/{}", found["scene"].as_str().unwrap()));
    assert_eq!(
        (shown.header("content-type"), &shown.bytes[..4]),
        ("model/gltf-binary", &b"glTF"[..])
    );
    let rows = |peaks: bool| {
        let body = json!({ "program": SHORT, "rate_hz": 10, "peaks": peaks });
        let answer = ask(&server, Method::POST, "cell/samples", &body);
        let read = StreamReader::try_new(answer.bytes.as_slice(), None).unwrap();
        let batches: Vec<_> = read.map(Result::unwrap).collect();
        assert!(batches[0].column_by_name("A_z_mm").is_some());
        batches.iter().map(arrow_array::RecordBatch::num_rows).sum::<usize>()
    };
    let duration = report["duration_s"].as_f64().unwrap();
    let even = rows(false);
    assert!((even as f64 - duration * 10.0 - 1.0).abs() <= 1.0, "{even} rows of {duration} s");
    assert!(rows(true) > even + 2 * steps.len(), "bends and peaks besides");
    let chosen = |columns: Value| {
        let body = json!({ "program": SHORT, "columns": columns, "from_s": 1.0, "to_s": 2.0 });
        ask(&server, Method::POST, "cell/samples", &body)
    };
    let answer = chosen(json!(["A_tilt", "time"]));
    let mut read = StreamReader::try_new(answer.bytes.as_slice(), None).unwrap();
    let batch = read.next().unwrap().unwrap();
    let names: Vec<&str> =
        batch.schema_ref().fields().iter().map(|one| one.name().as_str()).collect();
    assert_eq!((names, batch.num_rows()), (vec!["A_tilt_deg", "time_s"], 26));
    let answer = chosen(json!(["lift"]));
    assert_eq!(
        (answer.status, &answer.json()["field"]),
        (StatusCode::UNPROCESSABLE_ENTITY, &"columns".into())
    );
    let none = chosen(json!([]));
    assert_eq!(
        (none.status, &none.json()["field"]),
        (StatusCode::UNPROCESSABLE_ENTITY, &"columns".into())
    );
}

#[test]
fn planning_after_a_station_change_reuses_results() {
    let session = WorkcellSession::new(CellFiles::example());
    let program = "HOME\nTRANSFER LP1 SLOT 1 TO ALIGN WITH A\nTRANSFER ALIGN TO PM1 WITH A\n";
    let texts = CellFiles::example().into_texts();
    session.plan(texts.0.clone(), program.to_owned(), &|| false).unwrap();
    assert_eq!(session.reuse().hits, 0);
    let moved = texts.0.replace("[800.0, 0.0, 620.18]", "[800.0, 0.0, 620.178]");
    let plan = session.plan(moved, program.to_owned(), &|| false).unwrap();
    assert!(plan.report.is_some());
    let reuse = session.reuse();
    assert!(reuse.hits > reuse.misses && reuse.misses > 0, "{reuse:?}");
}

/// A file that the cell names was changed: its text did not.
#[test]
fn a_plan_is_that_of_the_present_robot_file() {
    let folder = tempfile::tempdir().unwrap();
    let robot = jointplay::format::catalogue::find("dual-arm").unwrap().text;
    let write = |text: &str| std::fs::write(folder.path().join("arms.toml"), text).unwrap();
    write(robot);
    let path = folder.path().join("own.toml");
    let (cell, _) = CellFiles::example().into_texts();
    let named = cell.replace("robot = \"dual-arm\"", "robot = \"arms.toml\"");
    assert_ne!(named, cell);
    std::fs::write(&path, named).unwrap();
    let server = server(CellFiles::open(&path).unwrap());
    let body = json!({ "program": "TRANSFER LP1 SLOT 1 TO ALIGN WITH A\nHOME\n" });
    let first = plan(&server, &body);
    assert_eq!(first["report"]["result"], "passed", "{first}");
    assert_eq!(plan(&server, &body)["key"], first["key"]);

    let slower = robot.replace("velocity_deg_s = 150.0", "velocity_deg_s = 15.0");
    assert_ne!(slower, robot);
    write(&slower);
    let second = plan(&server, &body);
    assert_ne!(second["key"], first["key"]);
    let duration = |found: &Value| found["report"]["duration_s"].as_f64().unwrap();
    assert!(duration(&second) > 1.5 * duration(&first), "{second}");
    std::fs::remove_file(folder.path().join("arms.toml")).unwrap();
    let third = plan(&server, &body);
    assert_eq!(third["report"], Value::Null);
    assert_ne!(third["diagnostics"], json!([]));
}

#[test]
fn all_errors_are_reported_with_their_positions() {
    let server = server(CellFiles::example());
    let invalid = "HOME\nGET LP9 SLOT 1 WITH A\nFLY\n";
    let found = plan(&server, &json!({ "program": invalid }));
    assert_eq!(found["report"], Value::Null);
    // A syntax error does not hide an unknown name.
    for (problem, [line, column]) in
        found["diagnostics"].as_array().unwrap().iter().zip([[2, 5], [3, 1]])
    {
        assert_eq!(
            (&problem["source"], &problem["line"], &problem["column"]),
            (&"program".into(), &line.into(), &column.into())
        );
    }
    assert_eq!(found["diagnostics"].as_array().unwrap().len(), 2);
    let found = plan(&server, &json!({ "program": invalid.replace("FLY\n", "") }));
    let first = &found["diagnostics"][0];
    assert_eq!(
        (&first["line"], &first["column"], &first["width"]),
        (&2.into(), &5.into(), &3.into())
    );
    assert!(first["message"].as_str().unwrap().contains("LP9"), "{first}");
    // The scene of the cell is available while the program has errors.
    let shown = fetch(&server, &format!("cell/scenes/{}", found["scene"].as_str().unwrap()));
    assert_eq!((shown.status, &shown.bytes[..4]), (StatusCode::OK, &b"glTF"[..]));
    let answer = ask(&server, Method::POST, "cell/samples", &json!({ "program": invalid }));
    assert_eq!(answer.status, StatusCode::CONFLICT);
    let found = plan(&server, &json!({ "cell": "kind = \"cell\"\nsize = 3\n" }));
    assert!(
        found["diagnostics"]
            .as_array()
            .unwrap()
            .iter()
            .any(|one| one["source"] == "cell" && one["line"] == 2)
    );
    assert_eq!((&found["stations"], &found["report"]), (&json!([]), &Value::Null));
}

#[test]
fn editing_a_station_preserves_comments() {
    let server = server(CellFiles::example());
    let change = json!({ "station": "LP2", "tilt": { "azimuth_rad": 0.0, "angle_rad": 0.01 }, "position_m": [-0.5, -0.495, 0.5] });
    let answer = ask(&server, Method::POST, "cell/station", &change);
    assert_eq!(answer.status, StatusCode::OK, "{}", String::from_utf8_lossy(&answer.bytes));
    let text = answer.json()["cell"].as_str().unwrap().to_owned();
    assert!(text.contains("# The misaligned one"), "comments stay");
    let found = plan(&server, &json!({ "cell": text, "program": "HOME\n" }));
    let station = &found["stations"][1];
    assert!((station["position_mm"][0].as_f64().unwrap() + 500.0).abs() < 1e-9, "{station}");
    assert!((station["tilt_angle_deg"].as_f64().unwrap() - 0.01_f64.to_degrees()).abs() < 1e-9);
    let unknown =
        ask(&server, Method::POST, "cell/station", &json!({ "station": "LP9", "heading_rad": 0 }));
    assert_eq!(
        (unknown.status, &unknown.json()["field"]),
        (StatusCode::UNPROCESSABLE_ENTITY, &"station".into())
    );
    let far = ask(
        &server,
        Method::POST,
        "cell/station",
        &json!({ "station": "LP2", "position_m": [0, 1e9, 0] }),
    );
    assert_eq!(far.json()["field"], "position_m[1]");
}

#[test]
fn texts_are_saved_to_their_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, jointplay::format::cell::EXAMPLE).unwrap();
    let server = server(CellFiles::open(&path).unwrap());
    let shown = send_to(
        server.clone(),
        Request::get("/api/v1/cell").header(header::HOST, HOST).body(Body::empty()).unwrap(),
    );
    assert_eq!(
        (&shown.json()["file"], &shown.json()["program"]),
        (&"mine.toml".into(), &"".into())
    );
    let texts = json!({ "cell": jointplay::format::cell::EXAMPLE, "program": SHORT });
    let kept = ask(&server, Method::PUT, "cell", &texts);
    assert_eq!((kept.status, &kept.json()["program"]), (StatusCode::OK, &SHORT.into()));
    assert_eq!(std::fs::read_to_string(folder.path().join("mine.program")).unwrap(), SHORT);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "no other file is left");
    let kept = ask(&self::server(CellFiles::example()), Method::PUT, "cell", &texts);
    assert_eq!(kept.status, StatusCode::CONFLICT);
    assert!(kept.json()["detail"].as_str().unwrap().contains("jointplay cell example"));
}

#[test]
fn files_changed_on_disk_are_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, jointplay::format::cell::EXAMPLE).unwrap();
    let server = server(CellFiles::open(&path).unwrap());
    let read = || {
        let request = Request::get("/api/v1/cell").header(header::HOST, HOST);
        send_to(server.clone(), request.body(Body::empty()).unwrap()).json()
    };
    let version = read()["version"].clone();
    let other = format!("# Mine.\n{}", jointplay::format::cell::EXAMPLE);
    std::fs::write(&path, &other).unwrap();
    let text = jointplay::format::cell::EXAMPLE.replace("-495.0, 495.0", "-494.0, 495.0");
    let mut texts = json!({ "cell": text, "program": SHORT, "replaces": version });
    let refused = ask(&server, Method::PUT, "cell", &texts);
    assert_eq!(
        (refused.status, &refused.json()["field"]),
        (StatusCode::CONFLICT, &"replaces".into())
    );
    let why = refused.json()["detail"].as_str().unwrap().to_owned();
    assert!(why.contains("mine.toml") && why.contains("changed"), "{why}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), other);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "neither is written");
    // After reloading, saving is allowed; without a version it always is.
    let again = read();
    assert_eq!(again["cell"], other);
    texts["replaces"] = again["version"].clone();
    let kept = ask(&server, Method::PUT, "cell", &texts);
    assert_eq!((kept.status, &kept.json()["cell"]), (StatusCode::OK, &text.clone().into()));
    std::fs::write(path.with_extension("program"), "HOME\n").unwrap();
    texts["replaces"] = kept.json()["version"].clone();
    assert_eq!(
        ask(&server, Method::PUT, "cell", &texts).json()["field"],
        "replaces",
        "the program counts too"
    );
    texts.as_object_mut().unwrap().remove("replaces");
    assert_eq!(ask(&server, Method::PUT, "cell", &texts).status, StatusCode::OK);
    assert_eq!(std::fs::read_to_string(path.with_extension("program")).unwrap(), SHORT);
}

#[test]
fn both_files_are_written_or_neither() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, jointplay::format::cell::EXAMPLE).unwrap();
    let server = server(CellFiles::open(&path).unwrap());
    // A folder in place of the program file.
    std::fs::create_dir_all(path.with_extension("program").join("full")).unwrap();
    let texts = json!({ "cell": "kind = \"cell\"\n", "program": SHORT });
    let refused = ask(&server, Method::PUT, "cell", &texts);
    assert_eq!(refused.status, StatusCode::CONFLICT);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), jointplay::format::cell::EXAMPLE);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "no other file is left");
}

#[test]
fn a_station_is_taught_by_points_and_tilted_by_rotation_vector() {
    let server = server(CellFiles::example());
    let points = [[-0.4, -0.495, 0.501], [-0.6, -0.495, 0.499], [-0.495, -0.4, 0.5]];
    let change = json!({ "station": "LP2", "taught": { "points_m": points, "threshold_m": 1e-4 } });
    let answer = ask(&server, Method::POST, "cell/station", &change);
    assert_eq!(answer.status, StatusCode::OK, "{}", String::from_utf8_lossy(&answer.bytes));
    let text = answer.json()["cell"].clone();
    let found = plan(&server, &json!({ "cell": text, "program": "HOME\n" }));
    let station = &found["stations"][1];
    assert_eq!(
        (&station["from"], &station["plane"]["result"]),
        (&"taught".into(), &"untested".into())
    );
    assert_eq!(station["taught_m"], json!(points));
    assert_eq!(station["freedoms"], json!(["x", "y", "heading"]));
    assert!((station["about_y_rad"].as_f64().unwrap() + 0.01).abs() < 1e-5, "{station}");
    let tilted = json!({ "cell": text, "station": "LP2", "tilt_xy": { "about_x_rad": 0.003, "about_y_rad": -0.004 } });
    let text = ask(&server, Method::POST, "cell/station", &tilted).json()["cell"].clone();
    let found = plan(&server, &json!({ "cell": text, "program": "HOME\n" }));
    let station = &found["stations"][1];
    assert!((station["about_x_rad"].as_f64().unwrap() - 0.003).abs() < 1e-15, "{station}");
    assert_eq!(station["freedoms"].as_array().unwrap().len(), 6);
    let none = json!({ "station": "LP2", "taught": { "points_m": [], "threshold_m": 0 } });
    let refused = ask(&server, Method::POST, "cell/station", &none);
    assert_eq!(refused.json()["field"], "taught.threshold_m");
}

#[test]
fn the_parts_of_the_cell_are_listed() {
    let found = plan(&server(CellFiles::example()), &json!({ "program": "HOME\n" }));
    let robot = &found["robot"];
    assert_eq!(robot["axes"].as_array().unwrap().len(), 6);
    assert_eq!(robot["arms"][1]["links"][3], "lower link 4");
    assert_eq!(found["wafers"][24]["initial_location"], "LP1, slot 25");
    let bodies = found["bodies"].as_array().unwrap();
    let blade = bodies.iter().find(|body| body["name"] == "blade-A").unwrap();
    assert_eq!(blade["attached_to"], "upper link 4");
    assert_eq!(blade["shape"], json!({ "kind": "box", "half_m": [0.15, 0.11, 0.0015] }));
    assert_eq!(found["zones"][0]["rule"], "keep-out");
}

#[test]
fn an_invalid_cell_is_opened_and_its_errors_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("invalid.toml");
    std::fs::write(&path, "kind = \"cell\"\nsize = 3\n").unwrap();
    let files = CellFiles::open(&path).unwrap();
    let errors = files.errors();
    assert!(errors.iter().any(|one| one.contains("invalid.toml:2:1")), "{errors:?}");
    let server = server(files);
    let found = plan(&server, &json!({}));
    let first = &found["diagnostics"][0];
    assert_eq!((&first["source"], &found["robot"]), (&"cell".into(), &Value::Null), "{found}");
    let fixed =
        plan(&server, &json!({ "cell": jointplay::format::cell::EXAMPLE, "program": SHORT }));
    assert_eq!(fixed["report"]["result"], "passed");
    assert_eq!(CellFiles::example().errors(), Vec::<String>::new());
    assert!(CellFiles::open(Path::new("nowhere.toml")).unwrap_err().contains("nowhere.toml"));
}

#[test]
fn invalid_requests_name_their_field() {
    let server = server(CellFiles::example());
    let rate = ask(&server, Method::POST, "cell/samples", &json!({ "rate_hz": 0 }));
    assert_eq!(
        (rate.status, &rate.json()["field"]),
        (StatusCode::UNPROCESSABLE_ENTITY, &"rate_hz".into())
    );
    let extra = ask(&server, Method::POST, "cell/plan", &json!({ "programme": "" }));
    assert_eq!(extra.status, StatusCode::UNPROCESSABLE_ENTITY);
}

#[test]
fn a_plan_takes_values_of_parameters() {
    let server = server(CellFiles::example());
    let text = "PARAMETER lot = 2 FROM 1 TO 25\nPARAMETER pause = 1 s\nREPEAT lot AS n\n  GOTO LP1 SLOT n WITH A\n  WAIT pause s\nEND\n";
    let instructions = |parameters: Value| {
        let plan = plan(&server, &json!({ "program": text, "parameters": parameters }));
        assert_eq!(plan["diagnostics"], json!([]));
        plan["instructions"].as_u64().unwrap()
    };
    assert_eq!(instructions(json!({})), 4);
    assert_eq!(instructions(json!({ "lot": 3, "pause": "2 s" })), 6);
    assert_eq!(instructions(json!({ "lot": "1" })), 2);
    let refused = |path: &str, parameters: Value, message: &str| {
        let body = json!({ "program": text, "parameters": parameters });
        let answer = ask(&server, Method::POST, path, &body);
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
        let problem = answer.json();
        assert_eq!(problem["field"], "parameters");
        assert!(problem["detail"].as_str().unwrap().contains(message), "{problem}");
    };
    refused("cell/plan", json!({ "lott": 3 }), "`lott` is not known (did you mean `lot`?)");
    refused("cell/samples", json!({ "lot": 30 }), "has to be from 1 to 25");
    refused("cell/plan", json!({ "pause": 2 }), "has to be a number in s, as in `2 s`");
    let list = json!({ "program": text, "parameters": { "lot": [1] } });
    let problem = ask(&server, Method::POST, "cell/plan", &list).json();
    assert_eq!(problem["field"], "parameters.lot");
    // Before, this had the name of a type of Rust.
    assert_eq!(problem["detail"], "expected a number or a text, such as 5 or \"5 mm\"");
}
