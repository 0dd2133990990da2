//! Studies of any length: what they write, what they sum up, what they refuse.

use std::collections::BTreeMap;

use crate::sandbox::Sandbox;
use serde_json::Value;

/// A grid of six poses under two virtualizations.
pub(crate) const SMALL: &str = r#"kind = "study"
virtualizations = ["planar", "polar"]
quantities = ["q1_mm", "origin_x_um", "tilt_deg", "virtual_joints"]

[pose]
azimuth_deg = [20, 50.5]
tilt_deg = "-1:1:1"
height_mm = 480.1
"#;

/// Columns of a table by name.
pub(crate) fn columns(csv: &str) -> BTreeMap<String, Vec<String>> {
    let mut lines = csv.lines().map(|line| line.split(',').map(str::to_owned));
    let names: Vec<String> = lines.next().unwrap().collect();
    let mut columns: BTreeMap<String, Vec<String>> =
        names.iter().map(|name| (name.clone(), Vec::new())).collect();
    for line in lines {
        let cells: Vec<String> = line.collect();
        assert_eq!(cells.len(), names.len());
        for (name, cell) in names.iter().zip(cells) {
            columns.get_mut(name).unwrap().push(cell);
        }
    }
    columns
}

fn numbers(column: &[String]) -> Vec<f64> {
    column.iter().filter(|cell| !cell.is_empty()).map(|cell| cell.parse().unwrap()).collect()
}

/// Writes a study, runs it, and gives its summary and table.
#[track_caller]
fn studied(sandbox: &Sandbox, text: &str, flags: &str) -> (Value, String) {
    sandbox.write("s.toml", text);
    let run = sandbox.run(&format!("study s.toml --out t.csv --force --format json {flags}"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    (serde_json::from_str(&run.stdout).unwrap(), sandbox.read("t.csv"))
}

#[test]
fn the_first_try_needs_nothing() {
    let sandbox = Sandbox::new();
    let run = sandbox.run("study");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(sandbox.names("."), ["center-shift.csv"]);
    assert_eq!(sandbox.read("center-shift.csv").lines().count(), 2233);
    // One line only, since standard error is no terminal.
    assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    assert!(run.stderr.contains("2232 samples in"), "{}", run.stderr);

    let mut settings = insta::Settings::clone_current();
    // What is zero but for round-off differs from machine to machine, and so does whether it is zero.
    settings.add_filter(r"-?\d\.\d+e-\d+", "[small]");
    settings.add_filter(r"(?m) 0( |$)", " [small]$1");
    settings.add_filter(r" +(\[small\])", " $1");
    settings.bind(|| insta::assert_snapshot!("study", run.stdout));
}

#[test]
fn standard_output_takes_the_table() {
    let sandbox = Sandbox::new();
    sandbox.write("s.toml", SMALL);
    let (summary, csv) = studied(&sandbox, SMALL, "");
    let run = sandbox.run("study s.toml --out - --format json --quiet");
    assert_eq!((run.code, run.stdout), (0, csv.clone()));
    assert_eq!(serde_json::from_str::<Value>(&run.stderr).unwrap(), summary);
    let run = sandbox.run("study s.toml --out -");
    assert_eq!((run.code, run.stdout), (0, csv));
    assert!(run.stderr.contains("median"), "{}", run.stderr);
    assert_eq!(sandbox.names("."), ["s.toml", "t.csv"]);
    assert_eq!(sandbox.run("study s.toml --out - --resume").code, 2);
}

#[test]
fn an_example_is_a_study_of_ones_own() {
    let sandbox = Sandbox::new();
    sandbox.write("mine.toml", &sandbox.done("study --example"));
    assert_eq!(sandbox.run("study mine.toml").code, 0);
    assert_eq!(sandbox.run("study center-shift").code, 0);
    assert_eq!(sandbox.read("mine.csv"), sandbox.read("center-shift.csv"));
    let text = sandbox.done("study tolerances --example");
    assert!(text.contains("[tolerances]"));
    let document = sandbox.json("study tolerances --example");
    assert_eq!(document, serde_json::json!({ "name": "tolerances", "text": text }));
}

#[test]
fn a_row_equals_the_inverse_kinematics() {
    let sandbox = Sandbox::new();
    let (_, csv) = studied(&sandbox, SMALL, "");
    let header = csv.lines().next().unwrap();
    assert_eq!(
        header,
        "sample,azimuth_deg,tilt_deg,height_mm,q1_mm,\
         planar_origin_x_um,planar_tilt_deg,planar_u1_mm,planar_u2_mm,planar_u3_mm,\
         planar_v1_mm,planar_v2_mm,planar_v3_mm,planar_status,\
         polar_origin_x_um,polar_tilt_deg,polar_l1_mm,polar_l2_mm,polar_l3_mm,\
         polar_phi1_deg,polar_phi2_deg,polar_phi3_deg,polar_status"
    );
    let table = columns(&csv);
    assert_eq!(table["sample"], ["0", "1", "2", "3", "4", "5"]);
    assert_eq!(table["azimuth_deg"][3], "50.5");
    assert_eq!(table["height_mm"][0], "480.1");
    for model in ["planar", "polar"] {
        for (row, sample) in table["sample"].iter().enumerate() {
            let at = |name: &str| -> &str { &table[name][row] };
            let (azimuth, tilt_angle) = (at("azimuth_deg"), at("tilt_deg"));
            let pose = sandbox.json(&format!(
                "inverse --azimuth-deg {azimuth} --tilt-deg {tilt_angle} --height-mm 480.1 --virtualization {model}"
            ));
            let near = |cell: &str, expected: &Value, scale: f64| {
                let (found, expected) = (cell.parse::<f64>().unwrap(), expected.as_f64().unwrap());
                assert!((found - expected * scale).abs() < 1e-9, "{found} {expected}");
            };
            near(at("q1_mm"), &pose["q_mm"][0], 1.0);
            near(at(&format!("{model}_origin_x_um")), &pose["platform"]["origin_mm"][0], 1e3);
            let joint = if model == "planar" { ("u2_mm", "u_mm") } else { ("phi2_deg", "phi_deg") };
            near(at(&format!("{model}_{}", joint.0)), &pose["virtual_joints"][joint.1][1], 1.0);
            assert_eq!(at(&format!("{model}_status")), "solved", "sample {sample}");
        }
    }
}

#[test]
fn a_summary_is_that_of_its_table() {
    let sandbox = Sandbox::new();
    let text = r#"kind = "study"
samples = 3001
seed = 11
quantities = ["center_shift_um", "tilt_error_urad", "socket_angle_2_deg"]
virtualizations = ["offset"]
[pose]
tilt_x_deg = { normal = [0.1, 0.5] }
tilt_y_deg = { uniform = [-1, 1] }
[tolerances]
socket_angle_deg = { normal = [0, 0.01] }
base_x_mm = { uniform = [-0.02, 0.03] }
"#;
    let (summary, csv) = studied(&sandbox, text, "");
    let table = columns(&csv);
    assert_eq!(summary["samples"], 3001);
    assert_eq!(summary["percentiles_from"], 3001);
    assert_eq!(summary["columns"].as_array().unwrap().len(), 6);
    for column in summary["columns"].as_array().unwrap() {
        let name = column["name"].as_str().unwrap();
        let mut values = numbers(&table[name]);
        values.sort_by(f64::total_cmp);
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let size = values[0].abs().max(values[3000].abs());
        let near = |found: &Value, expected: f64| {
            let found = found.as_f64().unwrap();
            assert!((found - expected).abs() <= 1e-9 * size, "{name}: {found} {expected}");
        };
        near(&column["min"], values[0]);
        near(&column["max"], values[3000]);
        near(&column["mean"], mean);
        near(&column["standard_deviation"], variance.sqrt());
        near(&column["percentiles"]["p5"], values[150]);
        near(&column["percentiles"]["p50"], values[1500]);
        near(&column["percentiles"]["p99"], values[2970]);
    }
}

#[test]
fn the_same_study_gives_the_same_bytes_on_any_number_of_threads() {
    let sandbox = Sandbox::new();
    let text = sandbox.done("study tolerances --example");
    let (_, first) = studied(&sandbox, &text, "--threads 1");
    for threads in [2, 5] {
        let (_, again) = studied(&sandbox, &text, &format!("--threads {threads}"));
        assert!(first == again, "{threads} threads");
    }
    let (_, other) = studied(&sandbox, &text.replace("seed = 1", "seed = 2"), "");
    assert_ne!(first, other);
}

#[test]
fn samples_without_an_answer_are_empty_and_counted() {
    let sandbox = Sandbox::new();
    let text = r#"kind = "study"
samples = 400
virtualizations = ["polar"]
solver = "newton"
quantities = ["origin_x_um"]
[pose]
azimuth_deg = 0
tilt_deg = { normal = [0, 60] }
"#;
    let (summary, csv) = studied(&sandbox, text, "");
    let table = columns(&csv);
    let failed = table["polar_status"].iter().filter(|status| *status != "solved").count();
    assert!(failed > 20 && failed < 380, "{failed}");
    for (status, cell) in table["polar_status"].iter().zip(&table["polar_origin_x_um"]) {
        assert_eq!(status != "solved", cell.is_empty());
    }
    let model = &summary["outcomes"][0];
    assert_eq!(model["failed"], failed);
    let steep =
        table["polar_status"].iter().filter(|status| *status == "tilt angle of 90° or more");
    assert_eq!(model["reasons"]["tilt angle of 90° or more"], steep.count());

    // None at all: the table is written, and the answer is no.
    sandbox.write("none.toml", &text.replace("normal = [0, 60]", "normal = [0, 1e300]"));
    let wild = sandbox.run("study none.toml");
    assert_eq!(wild.code, 2);
    let expected = "none.toml:8:27: `tilt_deg` is 1e300, but has to be from -89.999 to 89.999";
    assert!(wild.stderr.contains(expected), "{}", wild.stderr);
    sandbox.write("none.toml", &text.replace("normal = [0, 60]", "uniform = [89.95, 89.99]"));
    let none = sandbox.run("study none.toml");
    assert_eq!(none.code, 1, "{}", none.stderr);
    assert!(none.stderr.contains("no sample could be solved"), "{}", none.stderr);
    assert_eq!(sandbox.read("none.csv").lines().count(), 401);
}

#[test]
fn a_dry_run_estimates_the_run() {
    let sandbox = Sandbox::new();
    let dry = sandbox.json("study tolerances --dry-run");
    assert!(sandbox.names(".").is_empty());
    sandbox.run("study tolerances");
    let csv = sandbox.read("tolerances.csv");
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    assert_eq!(dry["samples"].as_u64().unwrap() as usize, csv.lines().count() - 1);
    let names: Vec<&str> =
        dry["columns"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    assert_eq!(names, header);
    let expected = dry["expected_bytes"].as_f64().unwrap();
    assert!((expected / csv.len() as f64 - 1.0).abs() < 0.02, "{expected} {}", csv.len());
    assert!(sandbox.done("study tolerances --dry-run").contains("10000 samples, nothing computed"));

    // Too many to compute, but their size can be estimated.
    sandbox.write(
        "huge.toml",
        &SMALL
            .replace("\"-1:1:1\"", "{ uniform = [-1, 1] }")
            .replace("quant", "samples = 4000000000000000000\nquant"),
    );
    assert!(sandbox.done("study huge.toml --dry-run").contains(" years"));
}

#[test]
fn a_table_that_is_there_is_replaced_only_on_request() {
    let sandbox = Sandbox::new();
    sandbox.write("s.toml", SMALL);
    sandbox.write("s.csv", "mine");
    let refused = sandbox.run("study s.toml");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("--force"), "{}", refused.stderr);
    assert_eq!(sandbox.read("s.csv"), "mine");
    assert_eq!(sandbox.run("study s.toml --force").code, 0);
    assert_eq!(sandbox.read("s.csv").lines().count(), 7);
    assert_eq!(sandbox.names("."), ["s.csv", "s.toml"]);
}

#[test]
fn robot_files_are_next_to_their_study() {
    let sandbox = Sandbox::new();
    let robot = sandbox.done("catalogue show gpr");
    sandbox.write("mine.toml", &robot.replacen("height_mm = 500.0", "height_mm = 400.0", 1));
    let text =
        SMALL.replace("height_mm = 480.1\n", "").replacen("virt", "robot = \"mine.toml\"\nvirt", 1);
    let (summary, csv) = studied(&sandbox, &text, "");
    assert_eq!(columns(&csv)["height_mm"][0], "400.0");
    assert_eq!(summary["mechanism"], "GPR of the paper");
    for (robot, message) in [
        ("../mine.toml", "must be in the folder of the input file"),
        ("/mine.toml", "must be in the folder of the input file"),
        ("none.toml", "cannot read"),
        ("delta", "of the kind \\\"mechanism\\\""),
        ("gps", "not in the catalogue"),
    ] {
        sandbox.write("s.toml", &text.replace("mine.toml", robot));
        let refused = sandbox.run("study s.toml --format json");
        assert_eq!(refused.code, 2);
        assert!(refused.stderr.contains(message), "{robot}: {}", refused.stderr);
    }
}

#[test]
fn usage_errors_are_reported() {
    let sandbox = Sandbox::new();
    sandbox.write("s.toml", &SMALL.replace("origin_x_um", "origin_x_deg"));
    let refused = sandbox.run("study s.toml");
    assert_eq!(refused.code, 2);
    let expected = "error: s.toml:3:24: `origin_x` needs a unit: origin_x_mm, origin_x_um, origin_x_nm, origin_x_m
  |
3 | quantities = [\"q1_mm\", \"origin_x_deg\", \"tilt_deg\", \"virtual_joints\"]
  |                        ^^^^^^^^^^^^^^\n";
    assert_eq!(refused.stderr, expected);
    sandbox.write("s.toml", SMALL);
    for (line, message) in [
        ("study s.toml --out t.xlsx", "ends in .csv or .parquet"),
        ("study s.toml --resume", "nothing to resume"),
        ("study tolerences", "did you mean `tolerances`?"),
        ("study none.toml", "cannot read none.toml"),
        ("study s.toml --threads 0", "the number of threads must be from 1 to 1024"),
        ("study s.toml --threads 1000000", "the number of threads must be from 1 to 1024"),
        ("study s.toml --threads many", "the number of threads must be from 1 to 1024"),
        ("study s.toml --out no/folder.csv", "cannot write no/folder.csv.part"),
        ("study s.toml --resume --force", "cannot be used with"),
    ] {
        let refused = sandbox.run(line);
        assert_eq!(refused.code, 2, "{line}");
        assert!(refused.stderr.contains(message), "{line}: {}", refused.stderr);
    }
    assert_eq!(sandbox.names("."), ["s.toml"]);
}

#[test]
fn a_study_larger_than_the_disk_is_refused_before_it_starts() {
    let sandbox = Sandbox::new();
    let text = SMALL.replace("azimuth_deg = [20, 50.5]", "azimuth_deg = { uniform = [0, 360] }");
    // More than any disk holds.
    sandbox.write(
        "s.toml",
        &text.replace("kind = \"study\"", "kind = \"study\"\nsamples = 3000000000000000"),
    );
    let refused = sandbox.run("study s.toml --out t.csv");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("the table needs about"), "{}", refused.stderr);
    assert!(
        refused.stderr.contains("are free in .: reduce the number of samples"),
        "{}",
        refused.stderr
    );
    assert_eq!(sandbox.names("."), ["s.toml"]);
    sandbox.done("study s.toml --out t.csv --dry-run");
}

#[test]
fn a_study_starts_no_more_threads_than_it_has_blocks_of_samples() {
    let sandbox = Sandbox::new();
    sandbox.write("s.toml", SMALL);
    let expected = sandbox.run("study s.toml --out one.csv --threads 1");
    assert_eq!(expected.code, 0, "{}", expected.stderr);
    // A thousand threads would need more address space than this leaves.
    let line = "ulimit -v 2000000; exec \"$0\" study s.toml --out many.csv --threads 1024";
    let run = std::process::Command::new("bash")
        .args(["-c", line, env!("CARGO_BIN_EXE_jointplay")])
        .current_dir(sandbox.path())
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert_eq!(sandbox.read("one.csv"), sandbox.read("many.csv"));
}
