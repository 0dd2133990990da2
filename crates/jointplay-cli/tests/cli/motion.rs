//! `jointplay move` along curves and tables.

use serde_json::Value;

use crate::sandbox::Sandbox;

/// A plate on four vertical legs at (±150, ±100) mm, with play along x and y at each ball.
pub(crate) fn four_legs() -> String {
    let mut text = String::from(
        "kind = \"mechanism\"\nname = \"Stage on four legs\"\nunits = { length = \"mm\", angle = \"deg\" }\nbase = \"floor\"\n\n[parameters]\nhx = 150\nhy = 100\nh = 400\n",
    );
    for (i, [x, y]) in
        [["hx", "hy"], ["-hx", "hy"], ["-hx", "-hy"], ["hx", "-hy"]].iter().enumerate()
    {
        let n = i + 1;
        text += &format!(
            "\n[[joint]]\nname = \"leg {n}\"\nkind = \"prismatic\"\nlinks = [\"floor\", \"post {n}\"]\npoint = [\"{x}\", \"{y}\", \"h\"]\naxis = [0, 0, 1]\nactuated = true\nlimits = [-20, 20]\n\n[[joint]]\nname = \"ball {n}\"\nkind = \"spherical\"\nlinks = [\"post {n}\", \"top\"]\npoint = [\"{x}\", \"{y}\", \"h\"]\n",
        );
        for axis in ["x", "y"] {
            let along = if axis == "x" { "[1, 0, 0]" } else { "[0, 1, 0]" };
            text += &format!(
                "\n[[virtual_joint]]\nname = \"{axis}{n}\"\njoint = \"ball {n}\"\nslide = {along}\n"
            );
        }
    }
    text + "\n[[frame]]\nname = \"centre\"\nlink = \"top\"\npoint = [0, 0, \"h\"]\n"
}

fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("four.toml", &four_legs());
    sandbox
}

/// Values of an entry of `series`.
fn series(report: &Value, name: &str) -> Vec<f64> {
    let values = report["series"][name].as_array().unwrap();
    values.iter().map(|value| value.as_f64().unwrap()).collect()
}

/// Drives of the legs for a precession of the plate: its plane keeps the slope tan α.
fn precession(angle: &str) -> String {
    let leg = |n: usize, x: &str, y: &str| {
        format!("--drive \"leg {n} = ({y})*tan({angle})*cos(t) - ({x})*tan({angle})*sin(t)\" ")
    };
    leg(1, "hx", "hy") + &leg(2, "-hx", "hy") + &leg(3, "-hx", "-hy") + &leg(4, "hx", "-hy")
}

#[test]
fn legs_driven_along_sines_tilt_the_plate_by_a_constant_angle() {
    let sandbox = sandbox();
    let line = format!("move four.toml {} --steps 24 --poses", precession("1"));
    let found = sandbox.json(&line);
    let t = found["parameter"]["values"].as_array().unwrap();
    assert_eq!((t.len(), t[24].as_f64()), (25, Some(360.0)));
    for (row, quaternion) in
        found["poses"]["top"]["quaternion"].as_array().unwrap().iter().enumerate()
    {
        let [w, x, y, z] = [0, 1, 2, 3].map(|k| quaternion[k].as_f64().unwrap());
        let normal = [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)];
        let tilt = normal[0].hypot(normal[1]).atan2(normal[2]).to_degrees();
        assert!((tilt - 1.0).abs() < 1e-9, "{row}: {tilt}");
        let toward = normal[1].atan2(normal[0]).to_degrees();
        let off = (toward - (15.0 * row as f64 - 90.0) + 180.0).rem_euclid(360.0) - 180.0;
        assert!(off.abs() < 1e-6, "{row}: {toward}");
    }
    // About x, each ball lies hy (sec 1° − 1) too far out of its leg.
    let expected = 100.0 * (1.0 / 1.0_f64.to_radians().cos() - 1.0);
    assert!((series(&found, "y1_mm")[0] - expected).abs() < 1e-9);
    assert!(series(&found, "x1_mm")[0].abs() < 1e-9);
}

#[test]
fn curves_and_ranges_and_units_are_mixed() {
    let sandbox = sandbox();
    let line = "move four.toml --drive \"leg 1=s um\" --drive \"leg 2=s*1e-3\" --drive \"leg 3=2*s/2e3 mm\" --drive \"leg 4=0:1.5e-3\" --over \"s=0:hx/hy:0.5\" --format json";
    let found: Value = serde_json::from_str(&sandbox.done(line)).unwrap();
    assert_eq!(
        found["parameter"],
        serde_json::json!({ "name": "s", "values": [0.0, 0.5, 1.0, 1.5] })
    );
    for leg in 1..=4 {
        let values = series(&found, &format!("leg {leg}_mm"));
        let expected = [0.0, 0.5e-3, 1e-3, 1.5e-3];
        assert!(
            values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15),
            "{leg} {values:?}"
        );
    }
}

#[test]
fn drives_of_one_flag_are_separated_by_commas() {
    let sandbox = Sandbox::new();
    let flags = sandbox
        .json("move hexapod --drive \"P1 = max(0, t)/1e4\" --drive P2=0:0.01 --over t=0:100");
    let flag =
        sandbox.json("move hexapod --drive \"P1 = max(0, t)/1e4, P2=0:0.01\" --over t=0:100");
    assert_eq!(flag, flags);
}

#[test]
fn a_table_of_drives_gives_the_motion_of_the_curve_that_it_samples() {
    let sandbox = sandbox();
    let curve = sandbox.json(&format!("move four.toml {} --steps 12", precession("0.5")));
    let [first, second, third, fourth] =
        [1, 2, 3, 4].map(|leg| series(&curve, &format!("leg {leg}_mm")));
    let rows = first.iter().zip(&second).zip(third.iter().zip(&fourth)).enumerate();
    let mut table = String::from("# half a degree\nphase,leg 1,leg 2_mm,leg 3_um,leg 4\n");
    for (row, ((a, b), (c, d))) in rows {
        table += &format!("{},{a:e},{b:e},{:e},{d:e}\n", 30 * row, c * 1e3);
    }
    sandbox.write("drives.csv", &table);
    let found = sandbox.json("move four.toml --table drives.csv");
    assert_eq!(found["parameter"]["name"], "phase");
    for name in ["x1_mm", "y1_mm", "x3_mm", "ball 2[0]_deg"] {
        let (a, b) = (series(&curve, name), series(&found, name));
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-8), "{name}: {a:?} {b:?}");
    }
    // Column headings of a written series can be read again.
    sandbox.done("move four-bar --drive \"A=20*sin(t)\" --steps 6 --out out");
    let csv = sandbox.read("out/four-bar-motion.csv");
    let cut: Vec<String> =
        csv.lines().map(|line| line.split(',').take(2).collect::<Vec<_>>().join(",")).collect();
    assert_eq!(cut[0], "t,A_deg");
    sandbox.write("again.csv", &cut.join("\n"));
    let again = sandbox.json("move four-bar --table again.csv");
    assert!((series(&again, "A_deg")[1] - 20.0 * 60.0_f64.to_radians().sin()).abs() < 1e-12);
}

#[test]
fn a_free_motor_follows_and_a_held_one_stays() {
    let sandbox = sandbox();
    let found = sandbox.json("move four.toml --drive \"leg 1=1\" --free \"leg 2,leg 3\"");
    assert_eq!(found["held"], serde_json::json!(["leg 4"]));
    let last = |leg: usize| *series(&found, &format!("leg {leg}_mm")).last().unwrap();
    // The least motion with leg 4 held: a tilt about the line of legs 3 and 4, which moves leg 2 with leg 1.
    assert_eq!(last(4), 0.0);
    // The balls stay in a plane.
    assert!((last(1) + last(3) - last(2) - last(4)).abs() < 1e-9);
    let held = sandbox.run("move four.toml --drive \"leg 1=1\"");
    assert_eq!(held.code, 1);
    assert!(held.stderr.contains("the loops do not stay closed"), "{}", held.stderr);
}

#[test]
fn the_first_place_beyond_limits_is_reported() {
    let sandbox = sandbox();
    let drives: String = (1..=4).map(|leg| format!("--drive \"leg {leg}=25*sin(t)\" ")).collect();
    let run = sandbox.run(&format!("move four.toml {drives} --steps 36"));
    assert_eq!(run.code, 1);
    let message = "joint limits exceeded, first at t = 60:\n  leg 1 is at 21.650635 mm, its limits are -20 to 20 mm";
    assert!(run.stderr.contains(message), "{}", run.stderr);
}

#[test]
fn play_has_panels_of_its_own_in_micrometres() {
    let sandbox = sandbox();
    sandbox.done(&format!("move four.toml {} --steps 8 --out out", precession("1")));
    let figure = sandbox.read("out/four-motion.svg");
    assert!(figure.contains("virtual joint (µm)"));
    assert!(figure.contains("joint coordinate (mm)"));
    assert!(sandbox.read("out/four-motion.csv").starts_with("t,leg 1_mm,"));
}

#[track_caller]
fn refuse(line: &str, message: &str) {
    let sandbox = sandbox();
    for (name, table) in [
        ("nan.csv", "t,leg 1\n0,0\n1,nan\n"),
        ("gap.csv", "t,leg 1\n0,0\n1\n"),
        ("other.csv", "t,leg 1,legs 2\n0,0,0\n1,0,0\n"),
        ("none.csv", "t\n0\n1\n"),
        ("jump.csv", "t,leg 1\n0,0\n0,1\n"),
        ("twice.csv", "leg 1,leg 1_mm\n0,0\n1,1\n"),
        ("far.csv", "leg 1\n0\n1e12\n"),
    ] {
        sandbox.write(name, table);
    }
    let run = sandbox.run(line);
    assert_eq!(run.code, 2, "{line}: {}{}", run.stdout, run.stderr);
    assert!(run.stderr.contains(message), "{line}: {}", run.stderr);
}

#[test]
fn expressions_without_a_value_and_tables_without_numbers_are_refused() {
    refuse(
        "move four.toml --drive \"leg 1=1/(t-8)\" --steps 90",
        "leg 1 at t = 8: \"1/(t-8)\": the expression gives a value that is infinite",
    );
    refuse("move four.toml --drive \"leg 1=hz*t\"", "unknown name `hz`");
    refuse(
        "move four.toml --drive \"leg 1=2 deg\"",
        "the value is a length, but deg is a unit of angles",
    );
    refuse(
        "move four.toml --drive \"leg 1=t:4\"",
        "FROM, TO and STEP cannot depend on the variable `t`",
    );
    refuse(
        "move four.toml --drive \"leg 1=h*t\" --over h=0:1",
        "`h` is a parameter of the file; choose another name for the variable, such as `t`",
    );
    refuse("move four.toml --drive \"leg 1=3\" --over t=0:1", "no drive depends on `t`");
    refuse("move four.toml --over t=0:1", "--over needs a --drive");
    refuse(
        "move four.toml --drive \"leg 1=sin(t)\" --over t=0:360:7",
        "steps of 7 from 0 miss 360",
    );
    refuse(
        "move four.toml --drive \"leg 1=sin(t)\" --over t=0:360:10 --steps 9",
        "--over has 36 steps and --steps has 9",
    );
    refuse("move four.toml --drive \"leg 1=1e9*t\"", "is too large");
    refuse(
        "move four.toml --drive \"leg 1=1\" --free \"leg 1\"",
        "--free leg 1: the joint is not held; without --free, held are: leg 2, leg 3, leg 4",
    );
    refuse("move four.toml --drive \"leg 1=1\" --free \"leg 9\"", "joint `leg 9` is not known");
    refuse("move four.toml --steps 0", "expected a whole number from 1 to 100000");
    refuse(
        "move four.toml --table nan.csv",
        "line 3, column \"leg 1\": expected a finite number, found \"nan\"",
    );
    refuse("move four.toml --table gap.csv", "the table is not valid CSV");
    refuse(
        "move four.toml --table other.csv",
        "column 3: joint `legs 2` is not known (did you mean `leg 2`?)",
    );
    refuse("move four.toml --table none.csv", "no column names a joint coordinate");
    refuse("move four.toml --table jump.csv", "must increase or decrease from row to row");
    refuse("move four.toml --table twice.csv", "\"leg 1_mm\" is given twice");
    refuse("move four.toml --table far.csv", "is too large");
    refuse("move four.toml --table nan.csv --steps 5", "cannot be used with");
}

#[test]
fn values_of_every_command_are_expressions_of_the_file() {
    let sandbox = sandbox();
    let tilt =
        "leg 1=hy*tan(1), leg 2=hy * tan(1),leg 3=-max(1, hy)*tan(1),leg 4=-1745.5064928217585 um";
    let found = sandbox.json(&format!("assemble four.toml --at \"{tilt}\""));
    let expected = 100.0 * (1.0 / 1.0_f64.to_radians().cos() - 1.0);
    assert!((found["virtual_joints"]["y1"].as_f64().unwrap() - expected).abs() < 1e-9);
    let found = sandbox.json("assemble four-bar --at \"A=0.5 rad\"");
    assert!((found["coordinates"]["A"].as_f64().unwrap() - 0.5_f64.to_degrees()).abs() < 1e-12);
    let run = sandbox.run("sensitivity four.toml --command \"leg 1=hz\"");
    assert!(
        run.code == 2 && run.stderr.contains("leg 1: \"hz\": unknown name `hz`"),
        "{}",
        run.stderr
    );
}

#[test]
fn a_precession_keeps_the_tilt_and_returns_to_its_start() {
    let sandbox = sandbox();
    let found = sandbox.json("move four.toml --pose \"centre: precess 1\" --steps 12 --poses");
    assert_eq!(found["parameter"]["values"][12], 360.0);
    for leg in 1..=4 {
        let values = series(&found, &format!("leg {leg}_mm"));
        assert!((values[0] - values[12]).abs() < 1e-9 && (values[0] + values[6]).abs() < 1e-9);
    }
    for quaternion in found["poses"]["centre"]["quaternion"].as_array().unwrap() {
        let [x, y] = [1, 2].map(|k| quaternion[k].as_f64().unwrap());
        assert!((2.0 * x.hypot(y).asin().to_degrees() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_search_without_an_answer_names_no_nearest_pose() {
    let line = "move hexapod --pose \"platform: move by [_, _, 5]\" --format json";
    let run = Sandbox::new().run(line);
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stderr.contains("was not found"), "{}", run.stderr);
    assert!(!run.stderr.contains("nearest possible"), "{}", run.stderr);
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(report["stopped"], "not_least");
    assert!(report.get("nearest_pose").is_none());
}

#[test]
fn a_pose_out_of_reach_stops_at_the_nearest_that_is_possible() {
    let sandbox = sandbox();
    let run = sandbox.run("move four.toml --pose \"centre: tilt 15 toward 30\" --steps 10");
    assert_eq!(run.code, 1);
    // Opposite legs reach their limits together: the first is held there, the other has no freedom left.
    let message = "stopped at share = 0.422904: leg 3 would have to leave its limits\n  nearest possible: centre: tilt 6.34355 toward 30\n";
    assert!(run.stderr.ends_with(message), "{}", run.stderr);
    let turn =
        sandbox.run("move gpr-mechanism --pose \"platform: turn 1 about [0,0,1]\" --steps 4");
    assert_eq!(turn.code, 1);
    assert!(turn.stderr.contains("no configuration has the commanded poses"), "{}", turn.stderr);
}

#[test]
fn commands_to_poses_that_have_no_meaning_are_refused() {
    refuse(
        "move four.toml --pose \"centre: tilt 1 about [0, 0, 1]\"",
        "is not perpendicular to the z axis",
    );
    refuse("move four.toml --pose \"centre: tilt 1 toward 1/(t-360)\"", "infinite");
    refuse("move four.toml --pose \"center: tilt 1 toward 0\"", "did you mean `centre`?");
    refuse("move four.toml --pose \"centre: tilt 1\"", "expected FRAME: COMMAND");
    refuse("move four.toml --pose \"floor: tilt 1 toward 0\"", "the base does not move");
    refuse(
        "move four.toml --pose \"centre: tilt 1 toward 0\" --pose \"centre: move by [_,_,1]\"",
        "commanded twice",
    );
    refuse(
        "move four.toml --pose \"centre: tilt 1 toward 0\" --drive \"leg 1=1\"",
        "cannot be used with",
    );
    refuse(
        "move four.toml --pose \"centre: tilt 1 toward 0\" --over t=0:1",
        "no pose depends on `t`",
    );
}
