//! Studies that are interrupted, killed or out of disk, and taken up again.

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::sandbox::{Sandbox, until_disturbed};

/// Thirteen chunks, the last one not full; on most machines, several times the half second between markers on one core.
const SAMPLES: u64 = 800_000;

const STUDY: &str = r#"kind = "study"
samples = 800000
seed = 5
quantities = ["origin_x_um"]
virtualizations = ["planar"]
[pose]
azimuth_deg = { uniform = [0, 360] }
tilt_deg = { uniform = [0, 1.5] }
[tolerances]
socket_radius_mm = { normal = [0, 0.01] }
"#;

/// The study with this number of samples.
fn study(samples: u64) -> String {
    STUDY.replace("800000", &samples.to_string())
}

fn sandbox(samples: u64) -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("s.toml", &study(samples));
    sandbox
}

/// Table and summary of a run that nothing disturbs.
fn undisturbed(sandbox: &Sandbox, table: &str) -> (Vec<u8>, String) {
    let run = sandbox.run(&format!("study s.toml --out whole-{table} --format json"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    (std::fs::read(sandbox.file(&format!("whole-{table}"))).unwrap(), run.stdout)
}

/// Options of a run to disturb, so that it is slow.
const DISTURBED: &str = "--threads 1";

fn start(sandbox: &Sandbox, line: &str) -> Child {
    sandbox.command(line).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

/// A marker with another number.
fn with(marker: &str, key: &str, number: u64) -> String {
    let start = marker.find(&format!("\"{key}\": ")).unwrap() + key.len() + 4;
    let end = start + marker[start..].find(',').unwrap();
    format!("{}{number}{}", &marker[..start], &marker[end..])
}

/// Number of chunks in the marker.
fn marked(sandbox: &Sandbox, table: &str) -> u64 {
    let text =
        std::fs::read_to_string(sandbox.file(&format!("{table}.part.json"))).unwrap_or_default();
    let marker: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    marker["chunks"].as_u64().unwrap_or_default()
}

/// Waits until more chunks are marked than these; false where the run has ended before.
fn await_more(sandbox: &Sandbox, table: &str, chunks: u64, child: &mut Child) -> bool {
    let patience = Instant::now();
    while marked(sandbox, table) <= chunks {
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        assert!(patience.elapsed() < Duration::from_secs(120), "nothing is marked");
        std::thread::sleep(Duration::from_millis(5));
    }
    true
}

/// Ends the table of an interrupted run, and holds it to one that was not.
#[track_caller]
fn finish(sandbox: &Sandbox, table: &str, expected: &(Vec<u8>, String)) {
    let run = sandbox.run(&format!("study s.toml --out {table} --resume --format json"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(std::fs::read(sandbox.file(table)).unwrap() == expected.0, "{table} differs");
    assert_eq!(run.stdout, expected.1, "the summary of {table} differs");
    let left: Vec<String> =
        sandbox.names(".").into_iter().filter(|name| name.contains(".part")).collect();
    assert!(left.is_empty(), "{left:?}");
}

/// A wait below 200 ms that differs from call to call, by the fraction of the present second.
fn moment() -> Duration {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap();
    Duration::from_millis(u64::from(now.subsec_micros()) % 200)
}

/// Kills up to five runs of a study, and resumes it; false where none was killed before its end.
fn killed_and_taken_up(samples: u64, table: &str) -> bool {
    let sandbox = sandbox(samples);
    let mut kills = 0;
    // From the start, before the first marker, and then from the last one.
    for run in 0..5 {
        let resume = if sandbox.file(&format!("{table}.part.json")).exists() {
            "--resume"
        } else {
            "--force"
        };
        let mut child =
            start(&sandbox, &format!("study s.toml --out {table} {resume} {DISTURBED}"));
        if run > 0 {
            await_more(&sandbox, table, marked(&sandbox, table), &mut child);
        }
        std::thread::sleep(moment());
        // The run may end before the signal: only its status decides whether it was killed.
        child.kill().unwrap();
        kills += u32::from(!child.wait().unwrap().success());
        if sandbox.file(table).exists() {
            break;
        }
    }
    if kills == 0 {
        return false;
    }
    let expected = undisturbed(&sandbox, table);
    if !sandbox.file(table).exists() {
        assert!(sandbox.file(&format!("{table}.part.json")).exists(), "nothing is marked");
        finish(&sandbox, table, &expected);
    }
    assert!(std::fs::read(sandbox.file(table)).unwrap() == expected.0);
    true
}

/// Interrupts a run of a study by a signal, and resumes it; false where it ended before.
fn interrupted_and_taken_up(samples: u64, table: &str, signal: &str) -> bool {
    let sandbox = sandbox(samples);
    let mut child = start(&sandbox, &format!("study s.toml --out {table} {DISTURBED}"));
    if !await_more(&sandbox, table, 0, &mut child) {
        return false;
    }
    send(signal, &child);
    let output = child.wait_with_output().unwrap();
    if output.status.success() {
        return false;
    }
    let expected = undisturbed(&sandbox, table);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert!(stderr.contains(&format!("of {samples} samples are in")), "{stderr}");
    assert!(stderr.contains("--resume"), "{stderr}");
    assert!(!sandbox.file(table).exists());
    let part = std::fs::read(sandbox.file(&format!("{table}.part"))).unwrap();
    let done = usize::try_from(marked(&sandbox, table)).unwrap() * 65_536;
    assert!(done > 0);
    if table.ends_with(".csv") {
        // A table of what is done: whole rows, the first of those to come.
        assert!(expected.0.starts_with(&part) && part.ends_with(b"\n"));
        assert_eq!(part.iter().filter(|&&byte| byte == b'\n').count(), done + 1);
    } else {
        assert!(part.starts_with(b"PAR1") && part.ends_with(b"PAR1"));
    }
    let again = sandbox.run(&format!("study s.toml --out {table}"));
    assert_eq!(again.code, 2);
    assert!(again.stderr.contains("use --resume to continue it"), "{}", again.stderr);
    finish(&sandbox, table, &expected);
    true
}

#[test]
fn a_killed_run_resumes_from_its_last_marker() {
    until_disturbed(SAMPLES, |samples| killed_and_taken_up(samples, "t.csv"));
}

#[test]
fn an_interrupted_run_leaves_a_table_and_can_be_resumed() {
    for signal in ["-INT", "-TERM"] {
        until_disturbed(SAMPLES, |samples| interrupted_and_taken_up(samples, "t.csv", signal));
    }
}

#[cfg(feature = "parquet")]
#[test]
fn parquet_is_killed_interrupted_and_taken_up_too() {
    until_disturbed(SAMPLES, |samples| killed_and_taken_up(samples, "t.parquet"));
    until_disturbed(SAMPLES, |samples| interrupted_and_taken_up(samples, "t.parquet", "-INT"));
}

#[test]
fn a_full_disk_costs_nothing_that_was_done() {
    let sandbox = sandbox(SAMPLES);
    let expected = undisturbed(&sandbox, "t.csv");
    // In place of a full disk, files that may not grow: blocks of 512 bytes, some two chunks.
    let program = env!("CARGO_BIN_EXE_jointplay");
    let script =
        format!("trap '' XFSZ; ulimit -f 18500; exec '{program}' study s.toml --out t.csv");
    let output =
        Command::new("sh").args(["-c", &script]).current_dir(sandbox.path()).output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("cannot write t.csv.part"), "{stderr}");
    assert!(stderr.contains("with --resume continues"), "{stderr}");
    let part = std::fs::read(sandbox.file("t.csv.part")).unwrap();
    assert!(expected.0.starts_with(&part) && part.ends_with(b"\n"));
    assert!(marked(&sandbox, "t.csv") > 0);
    finish(&sandbox, "t.csv", &expected);
}

#[test]
fn a_table_of_another_study_is_not_gone_on_with() {
    until_disturbed(SAMPLES, killed_and_not_taken_up);
}

/// Kills a run, and resumes it with other files and markers; false where it ended before.
fn killed_and_not_taken_up(samples: u64) -> bool {
    let sandbox = sandbox(samples);
    let mut child = start(&sandbox, &format!("study s.toml --out t.csv {DISTURBED}"));
    if !await_more(&sandbox, "t.csv", 0, &mut child) {
        return false;
    }
    send("-STOP", &child);
    if child.try_wait().unwrap().is_some() || sandbox.file("t.csv").exists() {
        return false;
    }
    // A locked table is not touched.
    let meanwhile = sandbox.run("study s.toml --out t.csv --resume");
    assert_eq!(meanwhile.code, 2);
    assert!(meanwhile.stderr.contains("another run is writing t.csv.part"), "{}", meanwhile.stderr);
    let concurrent = sandbox.run("study s.toml --out t.csv");
    assert!(
        concurrent.stderr.contains("another run is writing t.csv.part"),
        "{}",
        concurrent.stderr
    );
    send("-KILL", &child);
    child.wait().unwrap();

    let (begun, another) = (study(samples), samples + 1);
    let refused = |study: &str, message: &str| {
        sandbox.write("s.toml", study);
        let run = sandbox.run("study s.toml --out t.csv --resume");
        assert_eq!(run.code, 2);
        assert!(run.stderr.contains(message), "{}", run.stderr);
    };
    refused(
        &begun.replace("seed = 5", "seed = 6"),
        "seed: 5 in the study that was started, 6 in this file",
    );
    refused(
        &study(another),
        &format!("samples: {samples} in the study that was started, {another} in this file"),
    );
    refused(
        &begun.replace("1.5]", "1.6]"),
        "tilt_deg: uniform [0, 1.5] in the study that was started, uniform [0, 1.6] in this file",
    );
    refused(
        &begun.replace("planar", "radial"),
        "virtualizations: planar in the study that was started, radial in this file",
    );
    let whole = sandbox.read("t.csv.part.json");
    sandbox.write("t.csv.part.json", &whole.replacen("\"jointplay\": \"", "\"jointplay\": \"9", 1));
    refused(&begun, "only the same version can continue it");
    sandbox.write("t.csv.part.json", &whole[..whole.len() / 2]);
    refused(&begun, "no marker of an interrupted study");
    // Totals of another study, which the summary would have to report, and lengths beyond any file.
    let columns = whole.find("\"columns\": [").unwrap() + "\"columns\": [".len();
    let after = columns + whole[columns..].find("\n    ]").unwrap();
    sandbox.write("t.csv.part.json", &format!("{}{}", &whole[..columns], &whole[after..]));
    refused(&begun, "its totals are not those of its chunks");
    sandbox.write("t.csv.part.json", &with(&whole, "chunks", u64::MAX));
    refused(&begun, "it counts more chunks than the study has");
    sandbox.write("t.csv.part.json", &with(&whole, "bytes", u64::MAX));
    refused(&begun, "bytes were written");
    sandbox.write("t.csv.part.json", &whole);
    std::fs::File::options()
        .write(true)
        .open(sandbox.file("t.csv.part"))
        .unwrap()
        .set_len(99)
        .unwrap();
    refused(&begun, "t.csv.part has 99 bytes");

    // A word of the file that changes no number does not matter; --force begins again.
    sandbox.write("s.toml", &study(1000));
    assert_eq!(sandbox.run("study s.toml --out t.csv --force").code, 0);
    assert_eq!(sandbox.read("t.csv").lines().count(), 1001);
    true
}

/// The most memory that a run takes at a time (kB), and how often it was read; the last reading is some milliseconds before the end.
#[cfg(target_os = "linux")]
fn peak(sandbox: &Sandbox, samples: u64) -> (u64, usize) {
    sandbox.write("m.toml", &study(samples));
    let mut child = start(sandbox, "study m.toml --out m.csv --force --threads 2");
    let (mut peak, mut readings) = (0, 0);
    while child.try_wait().unwrap().is_none() {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id()));
        let status_text = status.unwrap_or_default();
        let line = status_text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        if let Some(kilobytes) = line.and_then(|line| line.trim().split(' ').next()) {
            peak = peak.max(kilobytes.parse().unwrap());
            readings += 1;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    (peak, readings)
}

#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_length() {
    let sandbox = Sandbox::new();
    // Few readings of a short run would miss its peak.
    until_disturbed(200_000, |samples| {
        let (short, readings) = peak(&sandbox, samples);
        if readings < 20 {
            return false;
        }
        let (long, _) = peak(&sandbox, 5 * samples);
        assert!(short > 10_000, "{short} kB");
        assert!(long < short + short / 4, "{short} kB, {long} kB for five times {samples} samples");
        true
    });
}
