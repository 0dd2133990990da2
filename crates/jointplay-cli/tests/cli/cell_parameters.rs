//! Parameters of cells on the command line, and what a search resumes from.

use crate::sandbox::Sandbox;

const CELL: &str = concat!(
    r#"
kind = "cell"
name = "One port"
robot = "own.toml"
assumed = ["places: drawn"]

[parameters]
distance = 700

"#,
    include_str!("../../../jointplay-format/tests/wafer_and_budgets.toml"),
    r#"
[[station]]
name = "port"
slots = 2
pitch_mm = 10.0
position_mm = ["distance", 0.0, 600.0]
heading_deg = -90.0
stroke = { below_mm = 4.0, above_mm = 3.0, speed_mm_s = 20.0 }
retract_mm = 10.0
wafers = [1]
"#
);

fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    let robots = concat!(env!("CARGO_MANIFEST_DIR"), "/../jointplay-format/robots/radial-arm.toml");
    sandbox.write("own.toml", &std::fs::read_to_string(robots).unwrap());
    sandbox.write("cell.toml", CELL);
    sandbox.write(
        "cell.program",
        "PARAMETER first = 1\nTRANSFER port SLOT first TO port SLOT 3 - first\n",
    );
    sandbox
}

#[test]
fn parameters_of_a_cell_are_set_by_their_name_with_a_prefix() {
    let sandbox = sandbox();
    let duration = |set: &str| {
        sandbox.json(&format!("cell check cell.toml {set}"))["duration_s"].as_f64().unwrap()
    };
    let near = duration("--set cell.distance=600");
    sandbox.write("near.toml", &CELL.replace("distance = 700", "distance = 600"));
    sandbox.write("near.program", &sandbox.read("cell.program"));
    let written = sandbox.json("cell check near.toml")["duration_s"].as_f64().unwrap();
    assert_eq!(near.to_bits(), written.to_bits());
    assert_ne!(near, duration(""));
    assert_eq!(near, duration("--set first=1,cell.distance=600"));
    for (set, expected) in [
        ("cell.distanse=600", "distance"),
        ("cell.distance=far", "invalid number"),
        ("cell.distance=inf", "not a finite number"),
        ("distance=600", "known: first"),
    ] {
        let run = sandbox.run(&format!("cell check cell.toml --set {set}"));
        assert_eq!(run.code, 2, "{set}");
        assert!(run.stderr.contains(expected), "{set}: {}", run.stderr);
    }
}

#[test]
fn a_search_is_not_resumed_after_a_file_of_the_cell_has_changed() {
    let sandbox = sandbox();
    let line = "cell optimise cell.toml --rounds 0 --blend-mm 0 --speed-percent 100 --station-programs 0 --out found";
    let run = sandbox.run(line);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(sandbox.run(line).code, 0, "it is resumed");
    let refused = sandbox.run(&format!("{line} --set cell.distance=690"));
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    let robot = sandbox.read("own.toml");
    sandbox.write("own.toml", &format!("{robot}\n# A change.\n"));
    let refused = sandbox.run(line);
    assert_eq!(refused.code, 2, "{}", refused.stderr);
    assert!(refused.stderr.contains("belongs to another cell"), "{}", refused.stderr);
}
