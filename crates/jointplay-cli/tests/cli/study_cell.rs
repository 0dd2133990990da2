//! Studies of cells, compared with `cell check` of each sample.

use std::fs;

use serde_json::Value;

use crate::sandbox::Sandbox;

const STUDY: &str = r#"kind = "study"
name = "aligner and speed"
cell = "mine.toml"
quantities = ["cycle_time_s", "min_distance_mm", "slip", "tilt", "play", "violations"]

[parameters]
aligner_x = [350, 345.5, 900]

[program_parameters]
pace = [100, 60]
"#;

const PROGRAM: &str = "\
PARAMETER pace = 80 FROM 10 TO 100
SPEED pace %
TRANSFER LP1 SLOT 2 TO ALIGN WITH A
HOME
";

/// A folder with the study, its cell and its program.
fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    let cell = include_str!("../../../jointplay-format/cells/example.toml");
    let cell = cell.replace("[350.0, 606.0, 600.0]", "[\"aligner_x\", 606.0, 600.0]");
    sandbox.write("mine.toml", &format!("{cell}\n[parameters]\naligner_x = 340\n"));
    sandbox.write("mine.program", PROGRAM);
    sandbox.write("s.toml", STUDY);
    sandbox
}

#[test]
fn rows_are_the_answers_of_cell_check() {
    let sandbox = sandbox();
    let summary: Value =
        serde_json::from_str(&sandbox.done("study s.toml --out t.csv --format json --quiet"))
            .unwrap();
    assert_eq!(summary["outcomes"][0]["reasons"]["out of reach"], 2);
    let table = sandbox.read("t.csv");
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = rows.next().unwrap();
    assert_eq!(names[1..4], ["aligner_x", "pace", "cycle_time_s"]);
    let rows: Vec<Vec<&str>> = rows.collect();
    assert_eq!(rows.len(), 6);
    for row in rows {
        let set = format!("cell.aligner_x={},pace={}", row[1], row[2]);
        let line = format!("cell check mine.toml --set {set} --format json");
        let check = sandbox.run(&line);
        if *row.last().unwrap() != "passed" {
            assert_eq!((check.code, row[3..10].concat().as_str()), (1, "out of reach"), "{row:?}");
            assert!(check.stderr.contains("does not reach"), "{}", check.stderr);
            continue;
        }
        let check: Value = serde_json::from_str(&check.stdout).unwrap();
        let most = |of: &dyn Fn(&Value) -> &Value| {
            let rows = check["instructions"].as_array().unwrap();
            rows.iter().filter_map(|row| of(row).as_f64()).fold(f64::MIN, f64::max)
        };
        let expected = [
            check["duration_s"].as_f64().unwrap(),
            check["distances"][0]["distance_mm"].as_f64().unwrap(),
            most(&|row| &row["slip"]["share"]),
            most(&|row| &row["tilt"]),
            most(&|row| &row["play"]),
            check["violations"].as_array().unwrap().len() as f64,
        ];
        for (name, (found, expected)) in names[3..].iter().zip(row[3..].iter().zip(expected)) {
            let found: f64 = found.parse().unwrap();
            // Conversion to millimetres may round the last digit.
            let error = (found - expected).abs();
            assert!(
                error <= 2.0 * f64::EPSILON * expected.abs(),
                "{set}: {name} {found} {expected}"
            );
        }
    }
}

#[test]
fn a_folder_of_parts_has_all_files_and_gives_the_same_table() {
    let sandbox = sandbox();
    let whole = sandbox.done("study s.toml --out whole.csv --threads 1 --format json --quiet");
    sandbox.done("study s.toml --parts run --part-format csv --part 1/2 --quiet");
    for name in ["s.toml", "mine.toml", "mine.program"] {
        fs::remove_file(sandbox.file(name)).unwrap();
    }
    sandbox.done("study --parts run --quiet");
    let gathered = sandbox.done("study --parts run --gather all.csv --format json --quiet");
    assert_eq!(sandbox.read("all.csv"), sandbox.read("whole.csv"));
    assert_eq!(gathered, whole);
    let manifest: Value = serde_json::from_str(&sandbox.read("run/study.json")).unwrap();
    assert_eq!(manifest["files"]["mine.program"], PROGRAM);
}
