//! Studies: complete, cancelled, and rejected.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use arrow_array::RecordBatch;
use arrow_array::cast::AsArray as _;
use arrow_array::types::{Float64Type, UInt8Type};
use arrow_ipc::reader::StreamReader;
use axum::body::Body;
use axum::http::{Request, StatusCode, header};
use http_body_util::BodyExt as _;
use jointplay::format::robot;
use jointplay::study::{Raster, simulate};
use jointplay::virtualization::{Polar, SolveOptions, Solver};
use tower::ServiceExt as _;

use super::{HOST, PORT, post, refused};
use crate::meshes::MeshFolder;
use crate::router;
use crate::state::AppState;
use crate::work::Deadlines;

const STUDY: &str = "/api/v1/study";
const PAPER: &str =
    r#"{"motion": {"kind": "raster"}, "model": {"virtualization": "polar", "solver": "newton"}}"#;

/// The batches of an Arrow stream.
#[track_caller]
fn batches(body: &str) -> Vec<RecordBatch> {
    let answer = post(STUDY, body);
    assert_eq!(answer.status, StatusCode::OK, "{}", String::from_utf8_lossy(&answer.bytes));
    assert_eq!(answer.header("content-type"), "application/vnd.apache.arrow.stream");
    let reader = StreamReader::try_new(answer.bytes.as_slice(), None).unwrap();
    reader.map(Result::unwrap).collect()
}

/// A column of all batches.
fn column(batches: &[RecordBatch], name: &str) -> Vec<f64> {
    let of = |batch: &RecordBatch| {
        batch.column_by_name(name).unwrap().as_primitive::<Float64Type>().values().to_vec()
    };
    batches.iter().flat_map(of).collect()
}

#[test]
fn a_raster_equals_the_study_of_the_library() {
    let found = batches(PAPER);
    let options = SolveOptions { solver: Solver::Newton, ..SolveOptions::default() };
    let gpr = robot::paper().gpr;
    let samples = simulate(&gpr, &Raster::paper(), &Polar, &options, &mut |_| ()).unwrap();
    let schema = found[0].schema();
    assert_eq!(schema.metadata()["samples"], "777");
    assert_eq!(schema.metadata()["solver"], "newton");
    assert_eq!(column(&found, "azimuth_rad"), samples.azimuth);
    assert_eq!(column(&found, "tilt_rad"), samples.tilt_angle);
    let near = |name: &str, expected: &[f64], size: f64| {
        let column = column(&found, name);
        assert_eq!(column.len(), expected.len());
        for (found, expected) in column.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12 * size, "{name}: {found} {expected}");
        }
    };
    near("q2_m", &samples.rods[1], 1.0);
    near("L23_m", &samples.sides[1], 1.0);
    near("l1_m", &samples.virtual_joints[0], 1.0);
    near("phi3_rad", &samples.virtual_joints[5], 1.0);
    near("origin_x_m", &samples.origin[0], 1.0);
    near("torsion_rad", &samples.torsion, 1.0);
    let status = found[0].column_by_name("status").unwrap().as_primitive::<UInt8Type>();
    assert!(status.values().iter().all(|&status| status == 0) && status.len() == 777);
}

#[test]
fn long_studies_are_streamed_in_batches_and_as_csv() {
    let body = r#"{"motion": {"kind": "serpentine", "azimuth_deg": {"from": 0, "to": 360, "step": 1},
        "tilt_deg": {"from": -2, "to": 2, "step": 0.2}}, "quantities": ["rods", "origin"]}"#;
    let found = batches(body);
    let rows: Vec<usize> = found.iter().map(RecordBatch::num_rows).collect();
    assert_eq!(rows, [4096, 7581 - 4096]);
    let tilt_angle = column(&found, "tilt_rad");
    assert_eq!(tilt_angle[20], tilt_angle[21], "a serpentine does not jump");
    let answer = post("/api/v1/study.csv", body);
    assert_eq!(answer.header("content-type"), "text/csv; charset=utf-8");
    let text = String::from_utf8(answer.bytes).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let schema = found[0].schema();
    let expected: Vec<&str> = schema.fields().iter().map(|field| field.name().as_str()).collect();
    assert_eq!(names, expected);
    let x = names.iter().position(|&name| name == "origin_x_m").unwrap();
    let values: Vec<f64> =
        lines.map(|line| line.split(',').nth(x).unwrap().parse().unwrap()).collect();
    assert_eq!(values, column(&found, "origin_x_m"), "to the bit, one heading only");
}

#[test]
fn parquet_is_returned_or_the_missing_support_reported() {
    let answer = post("/api/v1/study.parquet", PAPER);
    if cfg!(feature = "parquet") {
        assert_eq!(answer.status, StatusCode::OK);
        assert!(answer.bytes.starts_with(b"PAR1") && answer.bytes.ends_with(b"PAR1"));
        let long = r#"{"motion": {"kind": "raster", "azimuth_deg": {"from": 0, "to": 360, "step": 0.01}}}"#;
        refused("/api/v1/study.parquet", long, 422, Some("motion"), "at most 500000");
    } else {
        assert_eq!(answer.status, StatusCode::NOT_IMPLEMENTED);
        assert!(answer.json()["detail"].as_str().unwrap().contains("--features parquet"));
    }
}

#[test]
fn key_poses_have_their_durations() {
    let body = r#"{"motion": {"kind": "keys", "rate_hz": 50, "keys": [
        {"about_x_rad": 0, "about_y_rad": 0, "duration_s": 0},
        {"about_x_rad": 0, "about_y_rad": 0.02, "axis_height_m": 0.6, "duration_s": 2}]},
        "quantities": []}"#;
    let found = batches(body);
    let (time, height) = (column(&found, "time_s"), column(&found, "axis_height_m"));
    assert_eq!((time.len(), time[0], time[100]), (101, 0.0, 2.0));
    assert_eq!((height[0], height[100]), (0.5, 0.6));
    assert_eq!(found[0].num_columns(), 5, "what is commanded, and the status");
}

#[test]
fn samples_without_a_solution_are_marked() {
    let body = r#"{"motion": {"kind": "raster", "azimuth_deg": {"from": 0, "to": 0, "step": 1},
        "tilt_deg": {"from": 0, "to": 80, "step": 10}}, "model": {"virtualization": "polar"}, "quantities": ["origin"]}"#;
    let found = batches(body);
    let status = found[0].column_by_name("status").unwrap().as_primitive::<UInt8Type>();
    let words: Vec<String> =
        serde_json::from_str(&found[0].schema().metadata()["statuses"]).unwrap();
    assert_eq!((status.value(0), words[0].as_str()), (0, "solved"));
    let last = status.len() - 1;
    assert_ne!(status.value(last), 0);
    assert!(column(&found, "origin_x_m")[last].is_nan());
}

#[test]
fn invalid_studies_name_their_field() {
    let bad = |motion: &str, field: &str, detail: &str| {
        refused(STUDY, &format!(r#"{{"motion": {motion}}}"#), 422, Some(field), detail);
    };
    bad("1", "motion", "expected an object with a `kind`");
    bad(
        r#"{"kind": "spiral"}"#,
        "motion.kind",
        r#"one of "raster", "serpentine", "keys", got "spiral""#,
    );
    let steps = |name: &str, from: f64, to: f64, step: f64| {
        format!(r#"{{"kind": "raster", "{name}": {{"from": {from}, "to": {to}, "step": {step}}}}}"#)
    };
    bad(&steps("azimuth_deg", 0.0, 360.0, 7.0), "motion.azimuth_deg", "miss 360");
    bad(&steps("tilt_deg", 2.0, -2.0, 0.1), "motion.tilt_deg", "does not lead");
    bad(&steps("tilt_deg", 0.0, 90.0, 10.0), "motion.tilt_deg", "must be between -π/2 and π/2");
    bad(&steps("azimuth_deg", 0.0, 360.0, 1e-9), "motion.azimuth_deg", "at most 1000000");
    let long = r#"{"kind": "raster", "azimuth_deg": {"from": 0, "to": 360, "step": 0.001}}"#;
    bad(long, "motion", "at most 5000000 are allowed");
    let keys = |keys: &str| format!(r#"{{"kind": "keys", "rate_hz": 10, "keys": {keys}}}"#);
    let key = r#"{"about_x_rad": 0, "about_y_rad": 0, "duration_s": 0}"#;
    bad(&keys("[]"), "motion", "at least two");
    bad(&keys(&format!("[{key}, {key}]")), "motion", "duration of a key pose is 0");
    bad(&keys(&format!("[{key}, 3]")), "motion.keys[1]", "expected an object");
    let steep = key.replacen('0', "2", 1);
    bad(
        &keys(&format!("[{key}, {steep}]")),
        "motion.keys[1].about_x_rad",
        "must be between -π/2 and π/2",
    );
    let long = key.replace(r#""duration_s": 0"#, r#""duration_s": 1e300"#);
    bad(&keys(&format!("[{key}, {long}]")), "motion", "at most 5000000");
    let body = r#"{"motion": {"kind": "raster"}, "quantities": ["rods", "colour"]}"#;
    refused(STUDY, body, 422, Some("quantities[1]"), "got \"colour\"");
    let body = r#"{"motion": {"kind": "raster"}, "model": {"characteristic_length_m": 0}}"#;
    refused(
        STUDY,
        body,
        422,
        Some("model.characteristic_length_m"),
        "must be within 1e-12 to 1e6 m",
    );
}

/// A study of two million samples.
fn long_study() -> Request<Body> {
    let body = r#"{"motion": {"kind": "raster", "azimuth_deg": {"from": 0, "to": 360, "step": 0.01},
        "tilt_deg": {"from": -2, "to": 2, "step": 0.1}}}"#;
    Request::post(STUDY)
        .header(header::HOST, HOST)
        .header(header::CONTENT_TYPE, "application/json")
        .body(Body::from(body))
        .unwrap()
}

#[test]
fn a_study_ends_when_the_client_disconnects() {
    let state = super::state(robot::paper(), None).unwrap();
    let router = router::router(state.clone(), PORT);
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(async {
        let ask = || router.clone().oneshot(long_study());
        let mut running = Vec::new();
        for _ in 0..4 {
            running.push(ask().await.unwrap());
        }
        let turned_away = ask().await.unwrap();
        assert_eq!(turned_away.status(), StatusCode::SERVICE_UNAVAILABLE);
        // Other requests do not wait for studies.
        let robot = Request::get("/api/v1/robot").header(header::HOST, HOST).body(Body::empty());
        assert_eq!(router.clone().oneshot(robot.unwrap()).await.unwrap().status(), StatusCode::OK);
        let mut first = running.remove(0);
        assert!(first.body_mut().frame().await.unwrap().is_ok());
        drop(first);
        let mut again = ask().await.unwrap();
        for _ in 0..200 {
            if again.status() == StatusCode::OK {
                break;
            }
            tokio::time::sleep(std::time::Duration::from_millis(50)).await;
            again = ask().await.unwrap();
        }
        assert_eq!(again.status(), StatusCode::OK, "its place is free again");
        // The shutdown truncates the streams; a truncated stream must not look complete.
        state.work.stop();
        let cut = again.into_body().collect().await;
        assert!(cut.is_err());
    });
}

/// A server of the robot of the paper with short deadlines.
fn impatient(deadlines: Deadlines) -> AppState {
    let robot = robot::paper();
    let folder = MeshFolder::of(None, &robot).unwrap();
    AppState::new(robot, folder, deadlines)
}

#[test]
fn deadlines_end_long_computations() {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(async {
        let short = Duration::from_millis(20);
        let hurried = impatient(Deadlines { request: short, ..Deadlines::default() });
        // All workers are busy until the answer: the request exceeds its deadline.
        let workers = std::thread::available_parallelism().unwrap().get();
        let answered = Arc::new(AtomicBool::new(false));
        for _ in 0..workers {
            let (work, answered) = (hurried.work.clone(), Arc::clone(&answered));
            let busy = move || {
                let start = Instant::now();
                while !answered.load(Ordering::Relaxed) && start.elapsed().as_secs() < 60 {
                    std::thread::sleep(Duration::from_millis(5));
                }
                Ok(())
            };
            tokio::spawn(async move { work.run(busy).await.is_ok() });
        }
        let start = Instant::now();
        while hurried.work.running() < workers {
            assert!(start.elapsed().as_secs() < 60, "not all workers are busy");
            tokio::task::yield_now().await;
        }
        let pose = r#"{"command": {"kind": "rods", "rods_m": [0.5, 0.5, 0.5]}}"#;
        let ask = Request::post("/api/v1/pose")
            .header(header::HOST, HOST)
            .header(header::CONTENT_TYPE, "application/json")
            .body(Body::from(pose));
        let answer = router::router(hurried, PORT).oneshot(ask.unwrap()).await.unwrap();
        answered.store(true, Ordering::Relaxed);
        assert_eq!(answer.status(), StatusCode::SERVICE_UNAVAILABLE);
        let problem = answer.into_body().collect().await.unwrap().to_bytes();
        assert!(String::from_utf8_lossy(&problem).contains("longer than 0.02 s"), "{problem:?}");

        // The response has started: it is truncated, and must not look complete.
        let hurried = impatient(Deadlines { study: Duration::ZERO, ..Deadlines::default() });
        let answer = router::router(hurried, PORT).oneshot(long_study()).await.unwrap();
        assert_eq!(answer.status(), StatusCode::OK);
        let cut = answer.into_body().collect().await.unwrap_err();
        assert!(cut.to_string().contains("longer than 0 s"), "{cut}");
    });
}
