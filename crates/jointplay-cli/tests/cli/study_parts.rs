//! Studies in parts: any order of tasks gives the bytes of one run.

use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use serde_json::Value;

use crate::sandbox::{Sandbox, until_disturbed};

/// Three parts: 65,536, 65,536 and 28 samples, some without an answer.
const STUDY: &str = r#"kind = "study"
name = "parts"
virtualizations = ["polar", "planar"]
solver = "newton"
samples = 131100
seed = 4
quantities = ["tilt_error_urad", "q2_mm"]

[pose]
azimuth_deg = { uniform = [0, 360] }
tilt_deg = { normal = [0, 15] }

[tolerances]
socket_radius_mm = { normal = [0, 0.01] }
"#;

const FORMATS: &[&str] = if cfg!(feature = "parquet") { &["csv", "parquet"] } else { &["csv"] };

/// Runs a command that fails with this code and message.
#[track_caller]
fn fails(sandbox: &Sandbox, line: &str, code: i32, message: &str) {
    let run = sandbox.run(line);
    assert_eq!(run.code, code, "{line}: {}", run.stderr);
    assert!(run.stderr.contains(message), "{line}: {}", run.stderr);
}

/// The status as JSON, and whether the exit code agrees.
#[track_caller]
fn status(sandbox: &Sandbox, line: &str) -> Value {
    let run = sandbox.run(&format!("study --status --format json {line}"));
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(run.code, i32::from(report["missing"] != 0), "{}", run.stderr);
    report
}

fn bytes(sandbox: &Sandbox, name: &str) -> Vec<u8> {
    std::fs::read(sandbox.file(name)).unwrap()
}

#[test]
fn gathered_parts_are_the_run_on_one_machine() {
    let sandbox = Sandbox::new();
    sandbox.write("s.toml", STUDY);
    for ending in FORMATS {
        let whole = format!("study s.toml --out whole.{ending} --format json --quiet");
        let summary = sandbox.done(&whole);
        let parts = format!("s.toml --parts {ending} --part-format {ending}");
        let before = status(&sandbox, &parts);
        assert_eq!((&before["done"], &before["parts"]), (&0.into(), &3.into()));
        assert!(!sandbox.file(ending).exists());

        // The last task first; one task repeated; one with nothing to do.
        let run = |share: &str| -> Value {
            let line = format!("study {parts} --part {share} --quiet --format json");
            serde_json::from_str(&sandbox.done(&line)).unwrap()
        };
        assert_eq!(run("2/4")["computed"], 1);
        let found = status(&sandbox, &format!("--parts {ending}"));
        assert_eq!(found["missing_ranges"], serde_json::json!([[0, 1]]));
        assert_eq!(run("3/4")["parts"], 0);
        assert_eq!(run("0/2")["present"], 1);
        let line = format!("study --parts {ending} --gather table.{ending}");
        fails(&sandbox, &line, 1, "1 of 3 parts are missing, the first is part 1");
        assert!(!sandbox.file(&format!("table.{ending}")).exists());
        assert_eq!(run("1/2")["computed"], 1);
        assert_eq!(run("0/1")["computed"], 0);
        assert_eq!(status(&sandbox, &format!("--parts {ending}"))["missing"], 0);

        let names = sandbox.names(ending);
        let part = |k: u64, ending: &str| format!("part-{k:06}.{ending}");
        let mut expected: Vec<String> =
            (0..3).flat_map(|k| [part(k, ending), part(k, "json")]).collect();
        expected.push("study.json".to_owned());
        expected.sort();
        assert_eq!(names, expected);

        // The study file is not needed to gather.
        let gathered = sandbox.done(&format!("{line} --format json"));
        assert_eq!(gathered, summary);
        let (table, whole) = (format!("table.{ending}"), format!("whole.{ending}"));
        assert!(bytes(&sandbox, &table) == bytes(&sandbox, &whole), "{ending}");
        fails(&sandbox, &line, 2, "--force");
        sandbox.done(&format!("{line} --force"));
    }
}

/// Two parts, of 2048 and 1552 samples.
const MECHANISM: &str = r#"kind = "study"
mechanism = "slider-crank"
quantities = ["cylinder_um", "mobility"]

[drives]
"main bearing" = "0:359.9:0.1"
"#;

#[test]
fn a_mechanism_in_parts_is_the_run_on_one_machine() {
    let sandbox = Sandbox::new();
    sandbox.write("m.toml", MECHANISM);
    let summary = sandbox.done("study m.toml --out whole.csv --threads 1 --format json --quiet");
    let summary: Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(
        (&summary["samples"], &summary["outcomes"][0]["solved"]),
        (&3600.into(), &3600.into())
    );
    for share in ["1/2", "0/2"] {
        sandbox.done(&format!("study m.toml --parts run --part-format csv --part {share} --quiet"));
    }
    let report = status(&sandbox, "--parts run");
    assert_eq!((&report["done"], &report["parts"]), (&2.into(), &2.into()));
    let gathered = sandbox.done("study --parts run --gather table.csv --format json --quiet");
    assert_eq!(serde_json::from_str::<Value>(&gathered).unwrap(), summary);
    assert!(bytes(&sandbox, "table.csv") == bytes(&sandbox, "whole.csv"));
}

#[test]
fn a_folder_takes_one_study() {
    let sandbox = Sandbox::new();
    let small = STUDY.replace("131100", "70000");
    sandbox.write("s.toml", &small);
    let run = "study s.toml --parts run --part-format csv --part 1/2 --quiet";
    sandbox.done(run);
    // What changes no number is the same study.
    sandbox.write("s.toml", &format!("# a comment\n{}", small.replace("\"parts\"", "\"another\"")));
    sandbox.done(run);
    for (from, to, difference) in [
        ("seed = 4", "seed = 5", "seed: 4 in the study that was started, 5 in this file"),
        ("70000", "70001", "samples: 70000 in the study that was started, 70001 in this file"),
        ("0.01]", "0.02]", "socket_radius_mm: normal [0, 0.01] in the study that was started"),
        ("\"q2_mm\"", "\"q2_um\"", "columns: "),
    ] {
        sandbox.write("s.toml", &small.replace(from, to));
        fails(&sandbox, run, 2, difference);
        fails(&sandbox, "study s.toml --parts run --status", 2, difference);
    }
    sandbox.write("s.toml", &small);
    fails(
        &sandbox,
        "study --parts run --part 0/3 --part-format parquet",
        2,
        "parts are csv tables",
    );
    fails(
        &sandbox,
        "study --parts run --gather t.parquet",
        2,
        "the parts are csv tables; choose a name that ends in .csv",
    );
    fails(&sandbox, "study --parts run --gather t.xlsx", 2, "ends in .csv or .parquet");
    fails(&sandbox, "study --parts none --status", 2, "has no study.json");
    // Not another study into a folder whose name is misspelt.
    fails(&sandbox, "study --parts none", 2, "has no study.json");
    assert!(!sandbox.path().join("none").exists());
    fails(&sandbox, "study --parts run --part 2/2", 2, "a share is K/N");
    fails(&sandbox, "study --parts run --part 1", 2, "a share is K/N");
    fails(&sandbox, "study --parts run --out t.csv", 2, "cannot be used with");
    fails(&sandbox, "study --part 0/2", 2, "--parts");
    fails(&sandbox, "study --parts s.toml", 2, "s.toml");
    assert_eq!(sandbox.names("run").len(), 3);

    let described = sandbox.read("run/study.json");
    let version = format!("\"jointplay\": \"{}\"", env!("CARGO_PKG_VERSION"));
    sandbox.write("run/study.json", &described.replace(&version, "\"jointplay\": \"9.9.9\""));
    fails(&sandbox, "study --parts run --status", 2, "jointplay 9.9.9 began this study");
    sandbox.write("run/study.json", &described.replace("seed = 4", "seed = 6"));
    fails(&sandbox, "study --parts run --status", 2, "its digest is not that of the study in it");
    sandbox.write("run/study.json", &described[..described.len() / 2]);
    fails(&sandbox, "study --parts run --status", 2, "no JSON at line");
}

#[test]
fn parts_that_changed_are_refused_and_computed_again() {
    let sandbox = Sandbox::new();
    sandbox.write("s.toml", STUDY);
    sandbox.done("study s.toml --out whole.csv --quiet");
    sandbox.done("study s.toml --parts run --part-format csv --quiet");
    let (table, record) = ("run/part-000001.csv", "run/part-000001.json");
    let (whole, first) = (sandbox.read(table), sandbox.read(record));
    let gather = "study --parts run --gather t.csv";
    let version = format!("\"jointplay\": \"{}\"", env!("CARGO_PKG_VERSION"));
    let changed: Vec<(&str, String, String)> = vec![
        (table, whole[..whole.len() - 1].to_owned(), "is not the table that was written".into()),
        (table, whole.replacen('1', "2", 1), "is not the table that was written".into()),
        (record, sandbox.read("run/part-000000.json"), "belongs to part 0".into()),
        (record, first.replace("\"digest\": \"", "\"digest\": \"0"), "belongs to part 1".into()),
        (record, first[..40].to_owned(), "part-000001.json was not written by jointplay".into()),
        (record, first.replace("65536", "65535"), "totals are not those of this part".into()),
        (record, first.replace(&version, "\"jointplay\": \"9.9.9\""), "by jointplay 9.9.9".into()),
        (record, first.replace("000001.csv", "000001.parquet"), "names the table part-".into()),
    ];
    for (file, contents, message) in changed {
        sandbox.write(file, &contents);
        fails(&sandbox, gather, 2, &message);
        assert!(!sandbox.file("t.csv").exists());
        sandbox.write(table, &whole);
        sandbox.write(record, &first);
    }
    // Either file is enough to delete.
    for file in [table, record] {
        std::fs::remove_file(sandbox.file(file)).unwrap();
        assert_eq!(status(&sandbox, "--parts run")["missing_ranges"], serde_json::json!([[1, 1]]));
        sandbox.done("study --parts run --quiet");
    }
    sandbox.done(gather);
    assert!(sandbox.read("t.csv") == sandbox.read("whole.csv"));
}

/// Before, the whole file was read into memory, whatever its length.
#[cfg(unix)]
#[test]
fn a_part_that_never_ends_is_refused() {
    let sandbox = Sandbox::new();
    sandbox.write("s.toml", &STUDY.replace("131100", "9"));
    sandbox.done("study s.toml --parts run --part-format csv --quiet");
    std::fs::remove_file(sandbox.file("run/part-000000.csv")).unwrap();
    std::os::unix::fs::symlink("/dev/zero", sandbox.file("run/part-000000.csv")).unwrap();
    let message = "part-000000.csv is too large: at most 67108864 bytes";
    fails(&sandbox, "study --parts run --gather t.csv", 2, message);
    assert!(!sandbox.file("t.csv").exists());
}

#[test]
fn mechanisms_are_computed_on_one_kind_of_processor() {
    let sandbox = Sandbox::new();
    sandbox
        .write("s.toml", &STUDY.replace("131100", "9").replace("\"q2_mm\"", "\"sensitivity_1\""));
    sandbox.done("study s.toml --parts any --part-format csv --quiet");
    let described: Value = serde_json::from_str(&sandbox.read("any/study.json")).unwrap();
    assert!(described["instructions"].is_null(), "{described}");

    sandbox.write("m.toml", MECHANISM);
    sandbox.done("study m.toml --parts run --part-format csv --quiet");
    let described: Value = serde_json::from_str(&sandbox.read("run/study.json")).unwrap();
    let here = described["instructions"].as_str().unwrap();
    let other = sandbox.read("run/study.json").replacen(here, "abacus", 1);
    sandbox.write("run/study.json", &other);
    let expected = format!("begun with the instruction set abacus, and this processor has {here}");
    fails(&sandbox, "study --parts run --gather t.csv", 2, &expected);
}

#[cfg(unix)]
#[test]
fn tasks_that_are_killed_leave_complete_parts() {
    until_disturbed(500_000, tasks_killed_and_repeated);
}

/// Kills two tasks that compute the same parts, and computes what is missing; false where one ended before.
#[cfg(unix)]
fn tasks_killed_and_repeated(samples: u64) -> bool {
    let sandbox = Sandbox::new();
    let text = STUDY.replace("131100", &samples.to_string());
    sandbox.write("s.toml", &text.replace("normal = [0, 15]", "uniform = [0, 5]"));
    let finished = |folder: &Path| {
        let names = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let records =
            names.filter(|entry| entry.file_name().to_string_lossy().starts_with("part-"));
        records.filter(|entry| entry.path().extension().is_some_and(|end| end == "json")).count()
    };
    let line = "study s.toml --parts run --part-format csv --quiet";
    let start = || {
        let mut command = sandbox.command(line);
        command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    };
    let mut killed = [start(), start()];
    while finished(&sandbox.file("run")) < 2 {
        if killed.iter_mut().all(|task| task.try_wait().unwrap().is_some()) {
            break;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    killed.iter_mut().for_each(|task| task.kill().unwrap());
    let ended = killed.map(|mut task| task.wait().unwrap());
    if ended.iter().any(std::process::ExitStatus::success) {
        return false;
    }
    for mut task in [start(), start()] {
        assert!(task.wait().unwrap().success());
    }
    sandbox.done("study s.toml --parts run --gather t.csv --quiet");
    sandbox.done("study s.toml --out whole.csv --quiet");
    assert!(sandbox.read("t.csv") == sandbox.read("whole.csv"));
    true
}
