//! Parameters of cells on the command line, and what a search resumes from.

use serde_json::json;

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
fn parts_without_bodies_are_listed_as_not_checked_for_collisions() {
    let sandbox = sandbox();
    let not_checked = || sandbox.json("cell check cell.toml")["not_checked"].clone();
    let body = |name: &str, on: &str| {
        let on = if on.is_empty() { String::new() } else { format!("on = {on}\n") };
        format!(
            "\n[[body]]\nname = \"{name}\"\n{on}position_mm = [0.0, -900.0, 0.0]\nbox = {{ size_mm = [10.0, 10.0, 10.0] }}\n"
        )
    };
    assert_eq!(not_checked(), json!(["arm “arm”", "surroundings of the robot"]));
    let text = sandbox.run("cell check cell.toml").stdout;
    let line = "not checked          collisions of arm “arm”, surroundings of the robot: without bodies in the cell file";
    assert!(text.contains(line), "{text}");
    assert!(text.contains("result               no violations in what was checked"), "{text}");
    assert_eq!(sandbox.run("cell report cell.toml").code, 0);
    let page = sandbox.read("cell-report.html");
    assert!(page.contains("Not checked: collisions of arm “arm”, surroundings of the robot: "));
    assert!(page.contains("No violations in what was checked") && !page.contains("Check passed"));
    sandbox.write("cell.toml", &format!("{CELL}{}", body("wall", "")));
    assert_eq!(not_checked(), json!(["arm “arm”"]));
    let on_link = body("hub", r#"{ arm = "arm", link = 1 }"#).replace("-900.0", "0.0");
    sandbox.write("cell.toml", &format!("{CELL}{}{on_link}", body("wall", "")));
    assert_eq!(not_checked(), json!([]));
    assert!(!sandbox.run("cell check cell.toml").stdout.contains("not checked"));
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
