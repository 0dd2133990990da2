//! Cells from outside: the example, what breaks it, and what is written.

use crate::sandbox::{Sandbox, without_round_off};
use serde_json::Value;

/// One wafer to the aligner and to the misaligned port.
pub(crate) const SMALL: &str = "HOME
TRANSFER LP1 SLOT 1 TO ALIGN WITH A
TRANSFER ALIGN TO LP2 SLOT 25 WITH A
HOME
";

/// A sandbox with the example's cell, changed, and a small program.
fn sandbox(changes: &[(&str, &str)]) -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.done("cell example --out .");
    let mut cell = sandbox.read("example.toml");
    for (from, to) in changes {
        assert!(cell.contains(from), "{from}");
        cell = cell.replace(from, to);
    }
    sandbox.write("example.toml", &cell);
    sandbox.write("example.program", SMALL);
    sandbox
}

/// The example's wall, moved into the path of the rotating arms.
const WALL: (&str, &str) =
    ("position_mm = [100.0, -600.0, 500.0]", "position_mm = [100.0, -350.0, 500.0]");

#[test]
fn the_first_try_needs_no_flag() {
    let report = Sandbox::new().json("cell check");
    assert_eq!(report["result"], "passed");
    assert_eq!(report["violations"], Value::Array(vec![]));
    assert!(report["wafers_per_hour"].as_f64().unwrap() > 10.0);
    assert_eq!(report["wafers"], 25);
    assert!(report["instructions"].as_array().unwrap().len() > 100);
    assert!(!report["assumed"].as_array().unwrap().is_empty());
    let jump = format!("{:.1} µm", report["compensated"]["jump_um"].as_f64().unwrap());
    let page = include_str!("../../../../docs/reference/exports.md");
    assert!(page.contains(&jump), "docs/reference/exports.md: {jump}");
}

#[test]
fn a_check_reads_well() {
    let sandbox = sandbox(&[]);
    without_round_off().bind(|| {
        insta::assert_snapshot!("cell_check", sandbox.done("cell check example.toml"));
        insta::assert_snapshot!("cell_teach", sandbox.done("cell teach example.toml"));
    });
}

#[test]
fn a_search_finds_a_faster_program_and_continues_after_an_interruption() {
    let sandbox = sandbox(&[]);
    let naive = "SPEED 95 %\nBLEND 1 mm\nHOME\nREPEAT 3 AS n\n  TRANSFER LP1 SLOT n TO ALIGN WITH A\n  TRANSFER ALIGN TO LP2 SLOT n WITH A\nEND\nHOME\n";
    sandbox.write("example.program", naive);
    let command = "cell optimise example.toml --rounds 2 --blend-mm 0,3 --speed-percent 100 --station-programs 4 --out found";
    let found = sandbox.json(command);
    assert!(found["evaluated"].as_u64().unwrap() <= 1 + 2 * 2 + 2 + 4, "{found}");
    let [given, best] = [&found["given"], &found["programs"][0]];
    let rate = |one: &Value| one["wafers_per_hour"].as_f64().unwrap();
    assert!(rate(best) > 1.1 * rate(given), "{found}");
    // Both programs are what `cell check` reports, the given one with its own speed and blends; the new one moves the same wafers.
    let as_given = sandbox.json("cell check example.toml example.program");
    assert_eq!(as_given["wafers_per_hour"], given["wafers_per_hour"]);
    let check = sandbox.json("cell check example.toml found/optimised-1.program");
    assert!((check["wafers_per_hour"].as_f64().unwrap() - rate(best)).abs() < 1e-9);
    assert_eq!((&check["wafers"], &check["result"]), (&Value::from(3), &Value::from("passed")));
    let last = |wafer: &Value| {
        let stay = wafer["stays"].as_array().unwrap().last().unwrap();
        (stay["place"].clone(), stay["slot"].clone())
    };
    let ends: Vec<_> = check["schedule"]["wafers"].as_array().unwrap().iter().map(last).collect();
    let expected: Vec<_> = (1..=3).map(|slot| (Value::from("LP2"), Value::from(slot))).collect();
    assert_eq!(ends, expected);
    // The log of a killed run, whose last line is cut off.
    let log = sandbox.read("found/evaluations.jsonl");
    let kept: String = log.split_inclusive('\n').take(3).collect();
    sandbox.write("found/evaluations.jsonl", &(kept + "{\"program\": \"HO"));
    assert_eq!(sandbox.json(command), found);
    assert_eq!(sandbox.read("found/evaluations.jsonl"), log);
    sandbox.write("example.program", SMALL);
    let refused = sandbox.run(command);
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("another cell, program or version"), "{}", refused.stderr);
    sandbox.write("example.program", "HOME\nWAIT 3 s\nTRANSFER LP1 SLOT 1 TO ALIGN WITH A\n");
    let refused = sandbox.run("cell optimise example.toml --out other");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("line 2: only programs of HOME"), "{}", refused.stderr);
}

#[test]
fn a_run_writes_report_samples_and_pictures() {
    let sandbox = sandbox(&[]);
    let text = sandbox.done("cell run example.toml --rate 50");
    let names = sandbox.names("cell-run");
    assert_eq!(
        names,
        ["gantt.png", "gantt.svg", "report.json", "samples.csv", "top.png", "top.svg"]
    );
    assert!(text.ends_with("6 files written into cell-run\n"), "{text}");
    let report: Value = serde_json::from_str(&sandbox.read("cell-run/report.json")).unwrap();
    let duration = report["duration_s"].as_f64().unwrap();
    let csv = sandbox.read("cell-run/samples.csv");
    let last = csv.lines().last().unwrap();
    assert_eq!(last.split(',').next().unwrap().parse::<f64>().unwrap(), duration);
    assert!(csv.starts_with("time_s,line,step,q1_mm,q1_mm_per_s,q1_mm_per_s2,"), "{csv:.100}");
    for text in ["LP2, 25 slots, 0.8°", "wafer centre of A", "reach of B"] {
        assert!(sandbox.read("cell-run/top.svg").contains(text), "{text}");
    }
    let gantt = sandbox.read("cell-run/gantt.svg");
    assert!(gantt.contains(">RA</text>") && gantt.contains("TRANSFER"), "{gantt}");
    // Once more on request only, and other files stay.
    sandbox.write("cell-run/a.txt", "mine");
    let refused = sandbox.run("cell run example.toml");
    assert_eq!(refused.code, 2);
    assert!(
        refused.stderr.contains("a.txt") && refused.stderr.contains("--force"),
        "{}",
        refused.stderr
    );
    sandbox.done("cell run example.toml --rate 50 --force");
    assert_eq!(sandbox.read("cell-run/a.txt"), "mine");
}

#[test]
fn a_collision_is_reported_with_line_and_time() {
    let sandbox = sandbox(&[WALL]);
    let run = sandbox.run("cell check example.toml");
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stderr.contains("not safe to run"), "{}", run.stderr);
    for part in ["not safe to run", "collision: ", "wall", "example.program:3:1: ", "^^^", " s\n"] {
        assert!(run.stdout.contains(part), "{part}: {}", run.stdout);
    }
    let refused = sandbox.run("cell export example.toml");
    assert_eq!(refused.code, 1);
    assert!(refused.stderr.contains("--despite-errors"), "{}", refused.stderr);
    assert!(!sandbox.file("cell-export").exists());
    // Repeated violations are listed under one excerpt, with their times.
    let report: Value =
        serde_json::from_str(&sandbox.run("cell check example.toml --format json").stdout).unwrap();
    let all = report["violations"].as_array().unwrap().len();
    let shown = refused.stderr.lines().filter(|line| line.ends_with('^')).count();
    assert!(1 < shown && shown < all, "{shown} {all}: {}", refused.stderr);
    let numbers: Vec<&str> =
        run.stdout.lines().filter(|line| line.contains("; first at ")).collect();
    assert!(!numbers.is_empty());
    for line in numbers {
        assert!(refused.stderr.contains(line), "{line}: {}", refused.stderr);
    }
    // One group for each pair, and all its violations by line, station and phase.
    let groups = report["violation_groups"].as_array().unwrap();
    let total: u64 = groups.iter().map(|group| group["count"].as_u64().unwrap()).sum();
    assert_eq!(total as usize, all);
    for group in groups {
        let occurrences = group["occurrences"].as_array().unwrap();
        let count: u64 = occurrences.iter().map(|one| one["count"].as_u64().unwrap()).sum();
        assert_eq!(count, group["count"].as_u64().unwrap());
    }
    let remedy = &report["remedies"][0];
    assert_eq!(remedy["name"], "wall");
    assert!(run.stdout.contains(remedy["message"].as_str().unwrap()), "{}", run.stdout);

    sandbox.done("cell export example.toml --despite-errors --rate 50");
    let names = sandbox.names("cell-export");
    assert!(names.iter().all(|name| name.to_lowercase().contains("not-safe")), "{names:?}");
    let text = sandbox.read("cell-export/example-not-safe-to-run-neutral.txt");
    assert!(text.starts_with("# NOT SAFE TO RUN: "), "{text:.200}");
    let csv = sandbox.read("cell-export/example-not-safe-to-run.csv");
    assert!(csv.lines().next().unwrap().ends_with(",violations"));

    // What is simulated is shown all the same, but without samples.
    assert_eq!(sandbox.run("cell run example.toml").code, 1);
    assert!(!sandbox.names("cell-run").contains(&"samples.csv".to_owned()));
    assert!(sandbox.read("cell-run/top.svg").contains(">violation</text>"));
}

#[test]
fn a_station_tilted_beyond_the_limit_is_refused_with_the_numbers() {
    let sandbox = sandbox(&[("angle_deg = 0.8", "angle_deg = 2.0")]);
    let run = sandbox.run("cell check example.toml");
    assert_eq!(run.code, 2, "{}", run.stdout);
    assert!(run.stderr.contains("example.toml:"), "{}", run.stderr);
    assert!(run.stderr.contains('2') && run.stderr.contains("1.5"), "{}", run.stderr);
}

#[test]
fn taught_points_determine_the_uncertainty_of_their_plane() {
    let sandbox = sandbox(&[]);
    // Noise as a shop measures it, on points that are near each other: their plane is not what it seems.
    let close = "--point-mm 620,500,620.0033 --point-mm 500,620,619.9967 --point-mm 380,500,620.0033 --point-mm 500,380,619.9967";
    let line = format!("cell teach example.toml --station ALIGN {close}");
    let no = sandbox.run(&format!("{line} --format json"));
    assert_eq!(no.code, 1, "{}", no.stderr);
    // Two more points, the best of which is on the circle of the others.
    assert!(
        no.stderr.contains("cannot be judged with 4 points: measure 2 more points"),
        "{}",
        no.stderr
    );
    let untested: Value = serde_json::from_str(&no.stdout).unwrap();
    let untested = &untested["stations"][0]["plane"];
    assert_eq!((&untested["result"], &untested["freedom"]), (&"untested".into(), &1.into()));
    let [x, y] = [0, 1].map(|k| untested["next"]["points_mm"][0][k].as_f64().unwrap() - 500.0);
    assert!((x.hypot(y) - 120.0).abs() < 1e-2, "{untested}");
    assert!(untested["uncertainty"]["tilt_95_urad"].as_f64().unwrap() > 500.0, "{untested}");
    let no = sandbox.run(&format!("{line} --point-mm 500,500,620 --noise-um 20 --format json"));
    assert_eq!(no.code, 1, "{}", no.stderr);
    assert!(no.stderr.contains("plane_urad"), "{}", no.stderr);
    let uncertain: Value = serde_json::from_str(&no.stdout).unwrap();
    let uncertain = &uncertain["stations"][0]["plane"];
    assert_eq!(uncertain["result"], "uncertain");
    // 200 draws gave 163 µrad rms, 281 µrad at 95 % and 10 µm of height rms.
    let known = |key: &str| uncertain["uncertainty"][key].as_f64().unwrap();
    assert!((known("tilt_rms_urad") / 163.0 - 1.0).abs() < 0.05, "{uncertain}");
    assert!((known("tilt_95_urad") / 281.0 - 1.0).abs() < 0.05, "{uncertain}");
    // 1.96 √(20²/5 + (117.85 µrad · 183.7 mm)²): the station is that far from the middle of the points.
    assert!((known("height_95_um") - 45.9).abs() < 0.5, "{uncertain}");
    assert!((known("tilt_expanded_urad") - 235.7).abs() < 0.5, "{uncertain}");
    // The noise that the message names is the largest with which these points suffice.
    let noise = uncertain["next"]["noise_um"].as_f64().unwrap();
    assert!((noise - 20.0 * 20.0 / 235.7).abs() < 1e-2, "{uncertain}");
}

#[test]
fn leveling_a_station_by_the_advised_angle_is_enough_and_less_is_not() {
    let checked = |tilt: f64| {
        let sandbox = sandbox(&[("angle_deg = 0.8", &format!("angle_deg = {tilt}"))]);
        sandbox.write("example.program", "HOME\nTRANSFER LP1 SLOT 1 TO LP2 SLOT 1 WITH A\nTRANSFER LP1 SLOT 25 TO LP2 SLOT 25 WITH B\n");
        sandbox.run("cell check example.toml")
    };
    let advised = |text: &str| -> f64 {
        let after = text.split("by at least ").nth(1).unwrap();
        after.split('°').next().unwrap().parse().unwrap()
    };
    // By the reader, beyond the platform's own limit, and by the planner, within it.
    for (tilt, code) in [(2.0, 2), (1.49, 1)] {
        let run = checked(tilt);
        assert_eq!(run.code, code, "{}", run.stderr);
        let by = advised(&run.stderr);
        assert!(by > tilt - 1.5 + 0.02, "{by}: {}", run.stderr);
        // It is leveled enough: what may be left is collisions, not the tilt.
        let leveled = checked(tilt - by);
        assert!(!leveled.stderr.contains("would have to tilt"), "{by}: {}", leveled.stderr);
        let short = checked(tilt - 0.98 * by);
        assert!(short.stderr.contains("by at least"), "{by}: {}", short.stderr);
    }
}

#[test]
fn a_line_of_no_length_takes_no_time() {
    let sandbox = sandbox(&[]);
    let duration = |moves: &str| {
        sandbox.write("example.program", &format!("GET LP1 SLOT 1 WITH A\n{moves}HOME\n"));
        let run = sandbox.run("cell check example.toml --format json");
        assert!(run.code < 2 && run.stderr.lines().count() < 3, "{moves}: {}", run.stderr);
        let report: Value = serde_json::from_str(&run.stdout).unwrap();
        report["duration_s"].as_f64().unwrap()
    };
    let without = duration("");
    for by in ["Z 0 mm", "X 0 mm Y 0 mm", "X 5e-324 mm", "Z -1e-15 mm", "Y 1e-10 mm"] {
        let with = duration(&format!("MOVE LINE WITH A BY {by}\n"));
        assert!((with - without).abs() < 1e-9, "{by}: {with} {without}");
    }
    assert!(duration("MOVE LINE WITH A BY Z 1e-6 mm\n") > without);
}

#[test]
fn no_message_is_that_of_a_library() {
    // Displacements and limits of all sizes: each has an answer in own words.
    for (acceleration, jerk) in [("1e-12", "8000.0"), ("800.0", "1e-12"), ("1e9", "1e9")] {
        let sandbox = sandbox(&[("robot = \"dual-arm\"", "robot = \"odd.toml\"")]);
        let text = include_str!("../../../jointplay-format/robots/dual-arm.toml");
        let line = text.lines().find(|line| line.starts_with("loaded") && line.contains("deg_s2"));
        let odd = line.unwrap();
        let number = |key: &str| {
            let after = odd.split(&format!("{key} = ")).nth(1).unwrap();
            format!("{key} = {}", after.split([',', ' ']).next().unwrap())
        };
        let changed = odd
            .replace(
                &number("acceleration_deg_s2"),
                &format!("acceleration_deg_s2 = {acceleration}"),
            )
            .replace(&number("jerk_deg_s3"), &format!("jerk_deg_s3 = {jerk}"));
        assert_ne!(odd, changed);
        sandbox.write("odd.toml", &text.replace(odd, &changed));
        let run = sandbox.run("cell check example.toml");
        for words in ["inp.", "dof", "Calculator", "panicked", "allocation"] {
            assert!(!run.stderr.contains(words), "{words}: {}", run.stderr);
        }
        assert!([1, 2].contains(&run.code), "{}", run.stderr);
    }
}

/// The example's robot, the loaded speeding up of its first motor changed.
#[cfg(target_os = "linux")]
fn slow(acceleration: &str) -> Sandbox {
    let sandbox = sandbox(&[("robot = \"dual-arm\"", "robot = \"slow.toml\"")]);
    let text = include_str!("../../../jointplay-format/robots/dual-arm.toml");
    let line = text.lines().find(|line| line.starts_with("loaded") && line.contains("deg_s2"));
    let line = line.unwrap();
    let old = line.split("acceleration_deg_s2 = ").nth(1).unwrap().split(',').next().unwrap();
    let changed = line.replace(
        &format!("acceleration_deg_s2 = {old}"),
        &format!("acceleration_deg_s2 = {acceleration}"),
    );
    sandbox.write("slow.toml", &text.replace(line, &changed));
    sandbox.write("example.program", "HOME\nGET LP1 SLOT 3 WITH A\nPUT ALIGN WITH A\nHOME\n");
    sandbox
}

/// Runs a command that may take so much memory (kB).
#[cfg(target_os = "linux")]
fn within_memory(sandbox: &Sandbox, kilobytes: u32, line: &str) -> std::process::Output {
    let command = format!("ulimit -v {kilobytes}; exec \"$0\" {line}");
    let run = std::process::Command::new("sh")
        .args(["-c", &command, env!("CARGO_BIN_EXE_jointplay")])
        .current_dir(sandbox.file(""))
        .output();
    run.unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_duration() {
    // 29 minutes of motion at 1000 samples a second; all at once they took 590 MB, at 100 Hz 60 MB more.
    let sandbox = slow("1e-4");
    let run = within_memory(&sandbox, 450_000, "cell check example.toml --format json");
    let stderr = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{stderr}");
    let report: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert!(report["duration_s"].as_f64().unwrap() > 1500.0);
    assert!(report["samples"].as_u64().unwrap() > 1_000_000);
    let run = within_memory(
        &sandbox,
        450_000,
        "cell export example.toml --to csv,solidworks,text --dialect points",
    );
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert!(sandbox.read("cell-export/example.csv").lines().count() > 150_000);
}

#[cfg(target_os = "linux")]
#[test]
fn a_body_of_a_kilometre_is_checked_in_seconds_of_work() {
    // Bounds of how far its far end moves asked for 20 s of work on these few motions.
    let forearm = "name = \"forearm-A\"\non = { arm = \"upper\", link = 3 }\nposition_mm = [115.0, 0.0, 0.0]\nbox = { size_mm = [";
    let long = format!("{forearm}1e6, ");
    let sandbox = sandbox(&[(&format!("{forearm}270.0, "), &long)]);
    let command = "ulimit -t 10; exec \"$0\" cell check example.toml";
    let run = std::process::Command::new("sh")
        .args(["-c", command, env!("CARGO_BIN_EXE_jointplay")])
        .current_dir(sandbox.file(""))
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("violations, not safe to run"), "{stderr}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_motion_longer_than_a_day_is_refused_before_it_is_sampled() {
    for acceleration in ["1e-8", "1e-10", "1e-12"] {
        let sandbox = slow(acceleration);
        let run = within_memory(&sandbox, 450_000, "cell check example.toml");
        let stderr = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(1), "{stderr}");
        assert!(stderr.contains("one day") && stderr.contains("example.program:"), "{stderr}");
    }
}

/// The example cell with another robot, without the bodies on links of the arms.
fn with_robot(sandbox: &Sandbox, robot: &str) -> String {
    let text = sandbox.read("example.toml").replace("\"dual-arm\"", &format!("\"{robot}\""));
    let links = ["on = { arm = \"upper\"", "on = { arm = \"lower\""];
    let mut blocks: Vec<&str> = text.split("\n[[").collect();
    blocks.retain(|block| !links.iter().any(|link| block.contains(link)));
    let kept = blocks.join("\n[[");
    let mut lines: Vec<&str> = Vec::new();
    let mut within_pairs = false;
    for line in kept.lines() {
        within_pairs |= line.starts_with("may_touch");
        if !within_pairs {
            lines.push(line);
        }
        within_pairs &= !line.starts_with(']');
    }
    lines.join("\n")
}

#[test]
fn every_robot_of_the_catalogue_runs_in_the_example_cell_and_a_blocked_line_names_its_remedies() {
    let sandbox = sandbox(&[]);
    for robot in jointplay::format::cell::robot::names() {
        sandbox.write("one.toml", &with_robot(&sandbox, robot));
        sandbox.write(
            "one.program",
            "TRANSFER LP1 SLOT 3 TO ALIGN WITH A\nTRANSFER ALIGN TO PM1 WITH A\nTRANSFER PM1 TO LP2 SLOT 3 WITH A\n",
        );
        let run = sandbox.run("cell check one.toml");
        // Where the folded arm sweeps through a zone of the example, the answer is no, and the lot is planned all the same.
        assert!(run.code <= 1 && run.stdout.contains("wafers"), "{robot}: {}", run.stderr);
    }
    let line = with_robot(&sandbox, "scara-3r")
        .replace("retract_mm = 10.0", "retract_mm = 10.0\napproach = \"line\"");
    sandbox.write("one.toml", &line);
    let run = sandbox.run("cell check one.toml");
    assert_eq!(run.code, 1, "{}", run.stderr);
    for words in ["% along the line", "approach = \"radial\"", "retract_mm = "] {
        assert!(run.stderr.contains(words), "{words}: {}", run.stderr);
    }
}

#[test]
fn collisions_are_listed_in_groups_worst_first() {
    let sandbox = Sandbox::new();
    sandbox.done("cell example --out .");
    let text = sandbox.read("example.toml");
    sandbox.write("example.toml", &text.replace(WALL.0, "position_mm = [100.0, -300.0, 500.0]"));
    let run = sandbox.run("cell check example.toml");
    let shown = run.stdout.split("violations by cause\n").nth(1).unwrap();
    let shown = shown.split("by line, ").next().unwrap();
    assert!(shown.lines().count() < 100, "{shown}");
    assert!(shown.contains(", 25 wafers; first at "), "{shown}");
    assert!(shown.contains("elsewhere"), "{shown}");
    let json = sandbox.run("cell check example.toml --format json");
    let report: Value = serde_json::from_str(&json.stdout).unwrap();
    let all = report["violations"].as_array().unwrap();
    assert!(all.len() > 500, "{}", all.len());
    let deepest = all
        .iter()
        .filter(|one| one["kind"] == "collision")
        .map(|one| one["worst"].as_f64().unwrap())
        .fold(0.0, f64::min);
    // The first group is the deepest collision of all.
    let first = shown.split("a penetration depth of ").nth(1).unwrap();
    let depth: f64 = first.split(' ').next().unwrap().parse().unwrap();
    assert!((depth + deepest).abs() < 1e-3, "{depth} {deepest}: {first}");
}

#[test]
fn a_loaded_move_that_would_be_too_fast_is_slowed_until_the_wafer_stays() {
    let sandbox = sandbox(&[("robot = \"dual-arm\"", "robot = \"fast.toml\"")]);
    let fast = include_str!("../../../jointplay-format/robots/dual-arm.toml").replace(
        "loaded = { velocity_deg_s = 150.0, acceleration_deg_s2 = 400.0, jerk_deg_s3 = 4000.0 }",
        "loaded = { velocity_deg_s = 300.0, acceleration_deg_s2 = 1200.0, jerk_deg_s3 = 12000.0 }",
    );
    sandbox.write("fast.toml", &fast);
    let run = sandbox.run("cell check example.toml --format json");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    let shares = report["instructions"].as_array().unwrap().iter();
    let shares = shares.filter_map(|row| row["slip"]["share"].as_f64());
    let most = shares.fold(0.0, f64::max);
    assert!((0.97..=1.0).contains(&most), "{most}");
    // The robot file is searched next to the cell, and nowhere else.
    let outside = "robot = \"../fast.toml\"";
    sandbox.write(
        "example.toml",
        &sandbox.read("example.toml").replace("robot = \"fast.toml\"", outside),
    );
    let refused = sandbox.run("cell check example.toml");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("folder"), "{}", refused.stderr);
}

/// Line of the cell file, counted from 1, with these words, and the column of the first of them.
fn place_of(text: &str, words: &str) -> (usize, usize) {
    let at = text.find(words).unwrap();
    let line = text[..at].matches('\n').count() + 1;
    (line, at - text[..at].rfind('\n').map_or(0, |end| end + 1) + 1)
}

#[test]
fn two_faults_of_the_example_are_found_and_fixed() {
    let sandbox = sandbox(&[]);
    let sound = sandbox.read("example.toml");
    let broken = |from: &str, to: &str| {
        assert!(sound.contains(from), "{from}");
        sandbox.write("example.toml", &sound.replace(from, to));
    };
    let violations = |kind: &str| {
        let run = sandbox.run("cell check example.toml --format json");
        assert_eq!(run.code, 1, "{}", run.stderr);
        let report: Value = serde_json::from_str(&run.stdout).unwrap();
        assert_eq!(report["result"], "failed");
        let found = report["violations"].as_array().unwrap().iter();
        let found: Vec<Value> = found.filter(|one| one["kind"] == kind).cloned().collect();
        assert!(!found.is_empty(), "no {kind}: {}", run.stdout);
        // Each within its instruction, and at its line.
        for one in &found {
            let rows = report["instructions"].as_array().unwrap().iter();
            let row = rows.clone().find(|row| row["number"] == one["instruction"]).unwrap();
            let number = |value: &Value| value.as_f64().unwrap();
            let start = number(&row["start_s"]);
            let end = start + number(&row["duration_s"]) + 1e-9;
            let times = ["start_s", "worst_s", "end_s"].map(|key| number(&one[key]));
            assert!(times.is_sorted() && start <= times[0] && times[2] <= end, "{one} {row}");
            assert_eq!(one["line"], row["line"]);
        }
        found
    };

    // A station is tilted by 2°.
    broken("angle_deg = 0.8", "angle_deg = 2.0");
    let run = sandbox.run("cell check example.toml");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    let (line, _) = place_of(&sound, "tilt = { azimuth_deg = 100.0");
    let at = format!("example.toml:{line}:8: ");
    assert!(run.stderr.contains(&at), "{at} {}", run.stderr);
    assert!(run.stderr.contains("2.000°") && run.stderr.contains("1.500°"), "{}", run.stderr);
    assert_eq!(sandbox.run("cell export example.toml").code, 2);

    // The wall is in the path of the rotating arms.
    broken(WALL.0, WALL.1);
    let collisions = violations("collision");
    assert!(collisions.iter().any(|one| one["line"] == 3), "{collisions:?}");
    for one in collisions {
        let names: Vec<&str> = one["entities"]
            .as_array()
            .unwrap()
            .iter()
            .map(|it| it["name"].as_str().unwrap())
            .collect();
        assert_eq!(names[1], "wall", "{one}");
        assert_eq!(one["entities"][1]["kind"], "body", "{one}");
        let message = one["message"].as_str().unwrap();
        assert!(message.contains(names[0]) && message.contains("wall"), "{one}");
    }

    // Faster than the limits is no speed.
    sandbox.write("example.toml", &sound);
    sandbox
        .write("fast.program", &SMALL.replace("HOME\nTRANSFER LP1", "SPEED 150 %\nTRANSFER LP1"));
    let run = sandbox.run("cell check example.toml fast.program");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(run.stderr.contains("fast.program:1:7: "), "{}", run.stderr);
    assert!(run.stderr.contains("100 %"), "{}", run.stderr);

    // Fixed, it is sound and can be exported.
    assert_eq!(sandbox.json("cell check example.toml")["result"], "passed");
    sandbox.done("cell export example.toml --to csv,gltf --rate 20");
    assert_eq!(sandbox.names("cell-export"), ["example.csv", "example.glb"]);
}

#[test]
fn a_program_is_laid_out_and_stays_so() {
    let sandbox = sandbox(&[]);
    let rough =
        "home # first\nrepeat 2 as n\nget LP1 slot   n with A\n PUT LP1 SLOT n WITH A\nend\n";
    let even =
        "HOME  # first\nREPEAT 2 AS n\n  GET LP1 SLOT n WITH A\n  PUT LP1 SLOT n WITH A\nEND\n";
    sandbox.write("rough.program", rough);
    assert_eq!(sandbox.done("cell format rough.program"), even);
    assert_eq!(sandbox.read("rough.program"), rough, "only printed");
    assert_eq!(sandbox.done("cell format rough.program --write"), "");
    assert_eq!(sandbox.read("rough.program"), even);
    // The included example is formatted.
    sandbox.done("cell example --out whole");
    assert_eq!(sandbox.done("cell format"), sandbox.read("whole/example.program"));
    sandbox.write("rough.program", "GTE LP1\n");
    let run = sandbox.run("cell format rough.program --write");
    assert_eq!((run.code, sandbox.read("rough.program").as_str()), (2, "GTE LP1\n"));
    assert!(run.stderr.contains("rough.program:1:1: "), "{}", run.stderr);
}

#[test]
fn all_errors_of_a_program_are_reported_together() {
    let sandbox = sandbox(&[]);
    sandbox.write("invalid.program", "HOME\nGTE LP1 SLOT 1\nWAIT 3\n");
    let run = sandbox.run("cell check example.toml invalid.program");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    for part in ["invalid.program:2:1: ", "did you mean `GET`", "invalid.program:3:", "^^^"] {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
    // A line that cannot be read hides no name that is not known, before it or behind it.
    let text = "GET LP3 SLOT 1 WITH A\nWAIT 3\nMOVE T 3 mm\nREPEAT 1000000\n  GET LP1 SLOT 1 WITH C\nEND\nCALL far\nREPEAT 2 AS\n  PUT LP1 SLOT n WITH A\nEND\nREPEAT 3\n";
    sandbox.write("invalid.program", text);
    let run = sandbox.run("cell check example.toml invalid.program");
    let at = run.stderr.lines().filter_map(|line| line.split("invalid.program:").nth(1));
    let at: Vec<String> = at.map(|rest| rest.split(": ").next().unwrap().to_owned()).collect();
    assert_eq!(at, ["1:5", "2:6", "3:6", "4:1", "5:23", "8:12", "11:1"], "{}", run.stderr);
    sandbox.write("invalid.program", "GET LP2 SLOT 1 WITH A\n");
    let run = sandbox.run("cell check example invalid.program");
    assert_eq!(run.code, 2);
    assert!(
        run.stderr.contains("invalid.program:1:") && run.stderr.contains("is empty"),
        "{}",
        run.stderr
    );
    sandbox.write("invalid.program", "GET LP3 SLOT 1 WITH A\nPUT LP4 WITH A\n");
    let run = sandbox.run("cell check example invalid.program");
    assert_eq!(run.code, 2);
    for part in ["invalid.program:1:5: ", "LP3", "invalid.program:2:5: ", "LP4"] {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
    let json = sandbox.run("cell check example invalid.program --format json");
    let error: Value = serde_json::from_str(&json.stderr).unwrap();
    assert!(error["error"]["message"].as_str().unwrap().contains("LP3"));
    let places = error["error"]["places"].as_array().unwrap();
    for (place, (line, name)) in places.iter().zip([(1, "LP3"), (2, "LP4")]) {
        assert_eq!((&place["file"], &place["line"]), (&"invalid.program".into(), &line.into()));
        assert_eq!(place["column"], 5);
        let message = place["message"].as_str().unwrap();
        assert!(message.contains(name) && !message.contains('\n'), "{message}");
    }
    assert_eq!(places.len(), 2);
}

#[test]
fn a_program_that_moves_nothing_is_refused() {
    let sandbox = sandbox(&[]);
    let waits = "HOME\nWAIT 3 s\nREPEAT 2\n  WAIT 1 s\nEND\n";
    for text in ["", "# nothing\n", "HOME\n", "SPEED 50 %\nREPEAT 3\nEND\n", waits] {
        sandbox.write("idle.program", text);
        for command in ["check", "run", "export"] {
            let run = sandbox.run(&format!("cell {command} example.toml idle.program"));
            assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{text}");
            let message = "idle.program: the program contains no motion (all axes stay at home)";
            assert!(run.stderr.contains(message), "{text}: {}", run.stderr);
        }
        assert_eq!(sandbox.names(""), ["example.program", "example.toml", "idle.program"]);
    }
}

#[test]
fn missing_files_of_a_cell_are_searched_next_to_it() {
    for (named, line) in [
        ("robot = \"mine.toml\"", "cannot read the file \"mine.toml\": there is no such file in "),
        (
            "robot = \"dual-am\"",
            "robot with arms \"dual-am\" is not known (did you mean `dual-arm`?)",
        ),
    ] {
        let sandbox = sandbox(&[("robot = \"dual-arm\"", named)]);
        let run = sandbox.run("cell check example.toml");
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{named}");
        assert!(run.stderr.contains("example.toml:10:9: "), "{}", run.stderr);
        assert!(run.stderr.contains(line), "{}", run.stderr);
    }
}

#[test]
fn a_place_out_of_reach_is_a_no() {
    let sandbox = sandbox(&[]);
    sandbox.write("far.program", "GET LP1 SLOT 1 WITH A\nMOVE LINE WITH A BY Y 3000 mm\n");
    let run = sandbox.run("cell check example.toml far.program");
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stderr.contains("far.program:2:"), "{}", run.stderr);
}

/// Before, a motor ratio without closed form had a span of links from 0 to their sum, and the target was "0.000 mm away".
#[test]
fn an_arm_without_closed_form_states_no_span_of_its_links() {
    let sandbox = sandbox(&[]);
    let robot = sandbox.done("catalogue show radial-arm");
    assert!(robot.contains("drives = { R = -2 }"));
    sandbox.write("own.toml", &robot.replace("drives = { R = -2 }", "drives = { R = -2.5 }"));
    let cell = "kind = \"cell\"\nname = \"x\"\nrobot = \"own.toml\"\n[wafer]\ndiameter_mm = 300\nthickness_mm = 0.775\nmaterial = \"silicon\"\n[budgets]\nvirtual_joint_norm_um = 60\nmin_distance_mm = 1.0\nslot_min_distance_mm = 0.5\nplane_urad = 50\n[[station]]\nname = \"S\"\nslots = 3\npitch_mm = 10\nposition_mm = [0, 600, 550]\nstroke = { below_mm = 2, above_mm = 2, speed_mm_s = 15 }\nretract_mm = 30\nwafers = [2]\n";
    sandbox.write("one.toml", cell);
    sandbox.write("one.program", "GET S SLOT 2\n");
    let run = sandbox.run("cell check one.toml");
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(
        run.stderr.contains("no positions were found that bring the wafer there"),
        "{}",
        run.stderr
    );
    // Farther than all links together, whatever the ratios of the motors.
    sandbox.write("far.toml", &cell.replace("[0, 600, 550]", "[0, 2000, 550]"));
    let run = sandbox.run("cell check far.toml one.program");
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stderr.contains("out of reach: the links would have to reach"), "{}", run.stderr);
}

#[test]
fn options_that_do_not_suit_the_taught_points_are_usage() {
    let sandbox = sandbox(&[]);
    let points = "--point-mm 300,606,600 --point-mm 400,606,600 --point-mm 350,706,600";
    for (rest, message) in [
        (format!("{points} --noise-um 1,2"), "--noise-um has 2 values for 3 points"),
        (
            "--reference 0,0=350,606,600 --reference-noise-um 1,2".to_owned(),
            "2 values for 1 reference:",
        ),
        (
            "--first-mm 350,606,600 --last-mm 350,606,700".to_owned(),
            "need a station with several slots",
        ),
    ] {
        let run = sandbox.run(&format!("cell teach example.toml --station ALIGN {rest}"));
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(run.stderr.contains(message), "{}", run.stderr);
    }
    let one =
        sandbox.run("cell teach example.toml --station ALIGN --reference 0,0=350.1,606.2,600");
    assert!(one.stdout.contains("; reference points\n"), "{}", one.stdout);
}

#[test]
fn files_that_are_not_there_are_named() {
    let sandbox = Sandbox::new();
    for (line, message) in [
        ("cell check nowhere.toml", "cannot read nowhere.toml"),
        ("cell check nowhere.toml", "nowhere.program"),
        ("cell check nowhere.toml also.program", "cannot read nowhere.toml"),
        ("cell check nowhere.toml also.program", "cannot read also.program"),
        ("cell export --dialect rapid", "known: neutral, points"),
        ("cell export --dialect rapid.toml", "cannot read rapid.toml"),
        ("cell export --rate 0", "must be from 0.1 to 100000 Hz"),
        ("cell export --to step", "possible values: csv"),
        ("cell optimise --blend-mm 1001", "must be from 0 to 1000 mm, got 1001 mm"),
        ("cell optimise --speed-percent 0.005", "must be from 0.01 to 100 %, got 0.005 %"),
        ("cell teach --station LP9", "known: LP1, LP2, ALIGN, PM1"),
        ("cell teach --point-mm 1,2,3", "--station"),
        ("cell teach --station LP1 --point-mm 1,2", "expected 3 coordinates, got 2"),
        ("cell teach --station LP1 --first-mm 1,2,3", "--last-mm"),
    ] {
        let run = sandbox.run(line);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{line}: {}", run.stderr);
        assert!(run.stderr.contains(message), "{line}: {}", run.stderr);
        assert_eq!(sandbox.names(""), [""; 0], "{line} left files behind");
    }
}

#[test]
fn a_window_has_the_rows_of_the_whole_table_in_chosen_columns() {
    let sandbox = sandbox(&[]);
    let records = |name: &str| -> Vec<Vec<String>> {
        let text = sandbox.read(&format!("{name}/example.csv"));
        text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    sandbox.done("cell export example.toml --to csv --columns all --rate 200 --out whole");
    let written = sandbox.json("cell export example.toml --columns A_tilt,time,heading,A_tilt --from-s 3.1 --to-s 4 --rate 200 --out part");
    let names = ["A_tilt_deg", "time_s", "A_heading_deg", "B_heading_deg"];
    assert_eq!(
        (&written["columns"], &written["window_s"]),
        (&names.into(), &vec![3.1, 4.0].into())
    );
    // Chosen columns are those of a table alone.
    assert_eq!(sandbox.names("part"), ["example.csv"]);
    let (whole, part) = (records("whole"), records("part"));
    assert_eq!((part.len(), &part[0][..]), (182, &names.map(str::to_owned)[..]));
    let columns = names.map(|name| whole[0].iter().position(|one| one == name).unwrap());
    let first = whole.iter().position(|row| row[0] == part[1][1]).unwrap();
    for (k, row) in part[1..].iter().enumerate() {
        assert_eq!(row[..], columns.map(|column| whole[first + k][column].clone()));
    }
    let listed = sandbox.done("cell export example.toml --columns list");
    assert!(whole[0].iter().all(|name| listed.contains(name)));
    // Poses follow the default columns, alone in a table.
    sandbox.done("cell export example.toml --poses --rate 20 --out poses");
    assert_eq!(sandbox.names("poses"), ["example.csv"]);
    let header = &records("poses")[0];
    assert_eq!(header[..3], ["time_s", "line", "step"]);
    let poses = header.iter().filter(|name| name.ends_with("_qw")).count();
    assert_eq!(poses, 3 + 1 + 2 * 4 + 2, "{header:?}");
}

#[test]
fn windows_and_columns_that_do_not_exist_are_refused_with_what_is_allowed() {
    let sandbox = sandbox(&[]);
    for (options, message) in [
        ("--columns time,tild", "column or group `tild` is not known (did you mean `tilt`?)"),
        ("--columns time,tild", "A_heading_deg, A_tilt_deg"),
        ("--from-s 1000", "is not within the motion, which takes"),
        ("--from-s 3 --to-s 2", "ends after it starts"),
        ("--from-s -1", "starts at 0 s or later"),
        ("--from-s 1.001 --to-s 1.002", "no sample at 100 Hz is between 1.001 s and 1.002 s"),
        ("--to-s 1 --to gltf", "--to gltf always has the whole motion"),
        ("--columns time --to gltf", "--to names no table"),
        ("--poses --to gltf", "--poses adds columns of tables, but --to names no table"),
    ] {
        let run = sandbox.run(&format!("cell export example.toml {options}"));
        assert_ne!(run.code, 0, "{options}");
        assert!(run.stderr.contains(message), "{options}: {}", run.stderr);
        assert!(!sandbox.file("cell-export").exists(), "{options}");
    }
}

#[test]
fn the_how_to_shows_the_controller_text_of_its_dialect() {
    let page = include_str!("../../../../docs/how-to/export-a-motion.md");
    let block = |before: &str| {
        let after = page.split_once(before).unwrap().1;
        let block = after.split_once("```").unwrap().1.split_once("```").unwrap().0;
        block.split_once('\n').unwrap().1
    };
    let sandbox = Sandbox::new();
    let dialect = block("Save this as `robot-controller.toml`");
    sandbox.write("mine.toml", dialect);
    sandbox.write("cell.program", block("Save this as `cell.program`"));
    let command = "cell export example cell.program --to text --out c --dialect";
    sandbox.done(&format!("{command} mine.toml"));
    assert_eq!(sandbox.read("c/example-robot-controller.cmd"), block("The controller text:"));
    sandbox.write("cartesian.toml", block("Save this as `cartesian.toml`"));
    sandbox.done(&format!("{command} cartesian.toml --force"));
    let text = sandbox.read("c/example-cartesian.pos");
    assert!(text.starts_with(block("The controller text begins with:")), "{text}");
    // What the cell does not have is reported with its place in the dialect.
    for (from, to, message) in [
        ("LP1 = \"P1\"\n", "", "mine.toml:21:1: `[station_codes]` has no code for \"LP1\""),
        (
            "GET {station_code}",
            "GET {1 / (slot - 3)}",
            "mine.toml:18:16: `1 / (slot - 3)` is infinite for slot = 3",
        ),
    ] {
        sandbox.write("mine.toml", &dialect.replace(from, to));
        let run = sandbox.run(&format!("{command} mine.toml --force"));
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(run.stderr.contains(message), "{}", run.stderr);
    }
}

#[test]
fn every_file_lasts_as_long_as_the_motion() {
    let sandbox = sandbox(&[]);
    let written = sandbox.json("cell export example.toml --rate 50");
    let duration = written["duration_s"].as_f64().unwrap();
    let names = sandbox.names("cell-export");
    assert_eq!(written["files"].as_array().unwrap().len(), names.len());
    for name in
        ["example.csv", "example.glb", "example-neutral.txt", "load-motors.bas", "motor-RB.csv"]
    {
        assert!(names.contains(&name.to_owned()), "{names:?}");
    }
    let text = sandbox.read("cell-export/example-neutral.txt");
    assert!(text.ends_with(&format!("END {duration:.6}\n")));
    for line in ["TAKE A LP1 1", "LEAVE A ALIGN 1", "LEAVE A LP2 25", "WAIT "] {
        assert!(text.contains(line), "{line}");
    }
    let motor = sandbox.read("cell-export/motor-T.csv");
    let last = motor.lines().last().unwrap();
    assert_eq!(last.split(',').next().unwrap().parse::<f64>().unwrap(), duration);

    sandbox.write("own.toml", "name = \"own\"\nabout = \"mine\"\nextension = \"x\"\nlength = \"m\"\nangle = \"rad\"\ndecimals = 3\ntime_decimals = 3\naxis = \"{valeu}\"\nbetween = \",\"\ncomment = \"{text}\"\npoint = []\n");
    let refused = sandbox.run("cell export example.toml --to text --dialect own.toml --out own");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("own.toml:8:10: "), "{}", refused.stderr);
    assert!(refused.stderr.contains("did you mean `value`"), "{}", refused.stderr);
}

#[test]
fn stations_are_taught_and_written_back() {
    let sandbox = sandbox(&[]);
    // A plane tilted by 10 mm over 1 m toward -x, with a scatter of a fifth of a millimetre.
    let points = "--point-mm 400,600,600 --point-mm 300,600,599 --point-mm 350,700,599.5 --point-mm 350,500,599.5 --point-mm 350,600,599.5 --noise-um 0.5";
    let taught = sandbox.json(&format!("cell teach example.toml --station ALIGN {points}"));
    let station = &taught["stations"][0];
    let tilt = station["tilt_angle_deg"].as_f64().unwrap();
    assert!((tilt - 0.01_f64.atan().to_degrees()).abs() < 1e-9, "{tilt}");
    assert_eq!(station["plane"]["result"], "fits");
    assert!(sandbox.read("example.toml").contains("# An example cell"));

    let before = sandbox.read("example.toml");
    sandbox.done(&format!("cell teach example.toml --station ALIGN {points} --write"));
    let after = sandbox.read("example.toml");
    assert_ne!(before, after);
    assert!(after.contains("# An example cell"), "comments stay");
    let again = sandbox.json("cell teach example.toml --station ALIGN");
    assert_eq!(again["stations"][0], *station);

    // The picture of one, and of all.
    let line = format!("cell teach example.toml --station ALIGN {points} --figure one.svg");
    assert!(sandbox.done(&line).ends_with("picture: one.svg\n"));
    let one = sandbox.read("one.svg");
    for text in [
        "tilt 0.5729° toward ",
        "5 points, distances up to 0.0 µm (allowed 100.0), tilt ±",
        "fits",
        "dashed: level",
    ] {
        assert!(one.contains(text), "{text}: {one}");
    }
    assert!(!one.contains("LP1"), "{one}");
    sandbox.done("cell teach example.toml --figure all.svg");
    let all = sandbox.read("all.svg");
    for text in ["LP1", "level", "nominal, not taught", "tilt 0.8000° toward 100.0°", "1: +2.5 µm"]
    {
        assert!(all.contains(text), "{text}: {all}");
    }
    let kind = sandbox.run("cell teach example.toml --figure all.gif");
    assert_eq!(kind.code, 2);
    assert!(kind.stderr.contains("must end in .svg, .png, .pdf or .tex"), "{}", kind.stderr);

    let steep = points.replace("599.5", "609.5");
    let no = sandbox.run(&format!("cell teach example.toml --station ALIGN {steep}"));
    assert_eq!(no.code, 1, "{}", no.stderr);
    assert_eq!(sandbox.read("example.toml"), after);

    let carrier_axis = sandbox.json(
        "cell teach example.toml --station LP2 --first-mm -495,-495,500 --last-mm -494,-495,740",
    );
    assert!(
        (carrier_axis["stations"][0]["horizontal_offset_mm"].as_f64().unwrap() - 1.0).abs() < 1e-9
    );
    let refused = sandbox.run(&format!("cell teach --station ALIGN {points} --write"));
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("cell example"), "{}", refused.stderr);
}

#[cfg(target_os = "linux")]
#[test]
fn a_taught_station_is_written_into_a_file_whose_name_is_not_text() {
    use std::os::unix::ffi::OsStrExt as _;
    let sandbox = sandbox(&[]);
    let path = sandbox.path().join(std::ffi::OsStr::from_bytes(b"caf\xe9.toml"));
    std::fs::rename(sandbox.file("example.toml"), &path).unwrap();
    let before = std::fs::read_to_string(&path).unwrap();
    let mut command = sandbox.command(
        "cell teach --write --station LP2 --first-mm -495,-495,500 --last-mm -494,-495,740",
    );
    assert!(command.arg(&path).output().unwrap().status.success());
    assert_ne!(std::fs::read_to_string(&path).unwrap(), before);
    let count = std::fs::read_dir(sandbox.path()).unwrap().count();
    assert_eq!(count, 2, "no other file is written");
}

#[test]
fn the_examples_files_replace_nothing() {
    let sandbox = Sandbox::new();
    sandbox.done("cell example");
    assert_eq!(sandbox.names("example-cell"), ["example.program", "example.toml"]);
    sandbox.write("example-cell/example.toml", "mine");
    let refused = sandbox.run("cell example");
    assert_eq!(refused.code, 2);
    assert_eq!(sandbox.read("example-cell/example.toml"), "mine");
}

#[cfg(feature = "mcap")]
#[test]
fn mcap_is_written() {
    let sandbox = sandbox(&[]);
    sandbox.done("cell export example.toml --to mcap --rate 20");
    let bytes = std::fs::read(sandbox.file("cell-export/example.mcap")).unwrap();
    assert!(bytes.starts_with(b"\x89MCAP0\r\n") && bytes.ends_with(b"\x89MCAP0\r\n"));
}

#[cfg(not(feature = "mcap"))]
#[test]
fn a_build_without_mcap_names_the_feature() {
    let run = Sandbox::new().run("cell export --to mcap");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("--features mcap"), "{}", run.stderr);
}

#[test]
fn reported_jumps_at_hand_offs_equal_those_of_the_exported_wafer_centre() {
    let sandbox = sandbox(&[]);
    sandbox.write("example.program", "HOME\nTRANSFER LP1 SLOT 1 TO ALIGN WITH A\n");
    sandbox.done("cell export example.toml --to csv,gltf --rate 1000 --out out");
    let gltf = sandbox.scene("out/example.glb");
    let hand_offs = gltf["asset"]["extras"]["hand_offs"].as_array().unwrap();
    let slots: Vec<&str> = hand_offs.iter().map(|one| one["slot"].as_str().unwrap()).collect();
    assert_eq!(slots, ["LP1 1", "ALIGN 1"]);
    let table = crate::study::columns(&sandbox.read("out/example.csv"));
    let column =
        |name: &str| -> Vec<f64> { table[name].iter().map(|cell| cell.parse().unwrap()).collect() };
    let times = column("time_s");
    let center = ["A_x_mm", "A_y_mm", "A_z_mm"].map(column);
    let mut largest: f64 = 0.0;
    for one in hand_offs {
        let time = one["time_s"].as_f64().unwrap();
        let after = times.iter().position(|&at| at > time).unwrap();
        // The robot is at rest there: within a millisecond it moves by less than 10 nm.
        let squares = center.iter().map(|axis| (axis[after] - axis[after - 1]).powi(2));
        let jump_um = 1e3 * squares.sum::<f64>().sqrt();
        let reported = one["jump_um"].as_f64().unwrap();
        assert!((reported - jump_um).abs() < 0.01, "{one}: {jump_um}");
        assert!(jump_um > 50.0, "{jump_um}");
        largest = largest.max(reported);
    }
    let report = sandbox.json("cell check example.toml");
    assert_eq!(report["compensated"]["jump_um"], largest);
}

#[test]
fn displacement_of_wafers_names_causes_and_bounds() {
    let sandbox = sandbox(&[]);
    let found = sandbox.json("cell displacement example.toml --tilt-deg 0,0.6 --at-mm 0,700");
    let wafer = &found["wafers"][0];
    let number = |value: &Value| value.as_f64().unwrap();
    // The lever times the sine of the tilt, toward the tilt.
    let expected = number(&wafer["lever_mm"]) * 0.6_f64.to_radians().sin();
    assert_eq!(wafer["shifts"][0]["cause"], "lever of the tilt");
    assert!((number(&wafer["shifts"][0]["shift_mm"][0]) - expected).abs() < 1e-9, "{wafer}");
    // The platform's centre moves by micrometres only.
    assert!(number(&wafer["platform_center_um"][0]).abs() < 10.0, "{wafer}");
    assert_eq!(wafer["contributions"][0]["basis"], "model");

    let text = sandbox.done("cell displacement example.toml --station PM1 --effector A");
    for part in
        ["lever of the tilt", "relative to the slot", "not stated in full", "link_um", "station"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    sandbox.write(
        "stated.toml",
        &sandbox.read("example.toml").replacen(
            "[budgets]",
            "[tolerances]\nguide_um = 10\nsocket_um = 10\nrod_zero_um = 5\nmount_um = 20\nlink_um = 20\njoint_zero_urad = 50\nlinear_resolution_um = 1\nrotary_resolution_urad = 5\ndroop_percent = 5\nsag_percent = 10\n\n[budgets]",
            1,
        ),
    );
    let stated = sandbox.json("cell displacement stated.toml --station PM1 --effector A");
    let wafer = &stated["wafers"][0];
    assert_eq!(wafer["unknown"].as_array().unwrap().len(), 1, "{wafer}");
    assert!(
        number(&wafer["expanded"]["horizontal_um"]) < number(&wafer["linear_sum"]["horizontal_um"])
    );
    let program = sandbox.done("cell displacement stated.toml example.program");
    assert!(program.contains("linear sum (±µm)") && program.contains("least certain"), "{program}");

    for (line, expected) in [
        ("cell displacement --station PM9", "known: LP1, LP2, ALIGN, PM1"),
        ("cell displacement --station PM1 --slot 2", "no slot 2"),
        ("cell displacement --tilt-deg 0", "expected 2 numbers, got 1"),
        ("cell displacement --station PM1 --effector C", "known: A, B"),
    ] {
        let refused = sandbox.run(line);
        assert_eq!(refused.code, 2, "{line}");
        assert!(refused.stderr.contains(expected), "{line}: {}", refused.stderr);
    }
    let far = sandbox.run("cell displacement --tilt-deg 0,0.6 --at-mm 2000,0");
    assert_eq!(far.code, 1, "{}", far.stderr);
    let steep = sandbox.run("cell displacement --tilt-deg 0,3");
    assert_eq!(steep.code, 1, "{}", steep.stderr);
}

#[test]
fn parameters_of_a_program_are_set_on_every_command_that_reads_it() {
    let sandbox = sandbox(&[]);
    let text = "PARAMETER lot = 2 FROM 1 TO 25\nPARAMETER pause = 1 s\nREPEAT lot AS n\n  TRANSFER LP1 SLOT n TO LP2 SLOT n WITH A\n  WAIT pause s\nEND\n";
    sandbox.write("example.program", text);
    let wafers = |command: &str| sandbox.json(command)["wafers"].as_u64().unwrap();
    assert_eq!(wafers("cell check example.toml"), 2);
    assert_eq!(wafers("cell check example.toml --set lot=1,pause=2s"), 1);
    sandbox.done("cell run example.toml --set lot=1 --out run");
    let report: Value = serde_json::from_str(&sandbox.read("run/report.json")).unwrap();
    assert_eq!(report["wafers"], 1);
    sandbox.done("cell export example.toml --set lot=1 --to text --dialect neutral --out text");
    let displacement = sandbox.json("cell displacement example.toml --set lot=1");
    assert_eq!(displacement["wafers"].as_array().unwrap().len(), 2);
    let refused = |flags: &str, message: &str| {
        let run = sandbox.run(&format!("cell check example.toml {flags}"));
        assert_eq!(run.code, 2, "{flags}: {}", run.stderr);
        assert!(run.stderr.contains(message), "{flags}: {}", run.stderr);
    };
    refused(
        "--set lott=1",
        "example.program:1:17: the parameter `lott` is not known (did you mean",
    );
    refused("--set lot=26", "example.program:1:17: the parameter lot is 26, but has to be from 1");
    refused("--set pause=2", "has to be a number in s, as in `2 s`, found 2");
    refused("--set pause=2mm", "has to be a number in s, as in `2 s`, found 2mm");
    refused("--set lot", "expected PARAMETER=VALUE");
    let run = sandbox.run("cell displacement example.toml --station LP2 --set lot=1");
    assert_eq!(run.code, 2, "{}", run.stderr);
}
