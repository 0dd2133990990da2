//! Mechanism files: what is answered, what is refused, what is written.

use crate::sandbox::{Run, Sandbox};

const HEAD: &str = r#"
kind = "mechanism"
name = "test"
units = { length = "mm", angle = "deg" }
base = "ground"
"#;

/// A joint of a file.
fn joint(name: &str, kind: &str, links: [&str; 2], point: [f64; 3], axis: [f64; 3]) -> String {
    format!(
        "[[joint]]\nname = \"{name}\"\nkind = \"{kind}\"\nlinks = {links:?}\npoint = {point:?}\naxis = {axis:?}\n"
    )
}

const Z: [f64; 3] = [0.0, 0.0, 1.0];

fn refused(file: &str, line: &str, code: i32, message: &str) {
    let sandbox = Sandbox::new();
    sandbox.write("test.toml", file);
    let run = sandbox.run(line);
    assert_eq!(run.code, code, "{line}: {}{}", run.stdout, run.stderr);
    assert!(run.stderr.contains(message), "{line}: {}", run.stderr);
}

#[test]
fn texts() {
    let sandbox = Sandbox::new();
    crate::sandbox::without_round_off().bind(|| {
        for line in ["assemble four-bar --at A=30 --branches 30", "catalogue", "move --help"] {
            insta::assert_snapshot!(line.replace([' ', '=', '-'], "_"), sandbox.done(line), line);
        }
    });
    // Round-off has its own mind about the values that are zero.
    let bennett = sandbox.done("mobility bennett");
    for part in [
        "mobility of Bennett's linkage, at",
        "of all joints          4",
        "redundant              3",
    ] {
        assert!(bennett.contains(part), "{bennett}");
    }
}

/// The limits of the last joint admit the configuration of the guess a turn farther only.
#[test]
fn the_assembled_configuration_is_not_listed_as_another_a_turn_away() {
    let sandbox = Sandbox::new();
    let four_bar = sandbox.done("catalogue show four-bar");
    let limited = four_bar.replace("name = \"D\"\n", "name = \"D\"\nlimits = [360, 380]\n");
    sandbox.write("test.toml", &limited);
    let found = sandbox.json("assemble test.toml --at A=30 --branches 30 --quiet");
    let of_last = |found: &serde_json::Value| found["coordinates"]["D"].as_f64().unwrap();
    assert!((of_last(&found) - 373.382_367).abs() < 1e-6, "{found}");
    let [other] = &found["branches"].as_array().unwrap()[..] else { panic!("{found}") };
    assert!((of_last(other).rem_euclid(360.0) - 116.298_738).abs() < 1e-6, "{found}");
}

/// Three cranks whose rounded lengths close exactly only where they are nearly stretched.
#[test]
fn a_tolerance_keeps_actuated_joints_at_their_guesses() {
    let crank = |k: usize, [base, length, coupler]: [f64; 3]| {
        let actuated = if k == 1 { "actuated = true" } else { "" };
        let z = "axis = [0, 0, 1], zero = [1, 0, 0]";
        format!(
            "[[joint]]\nname = \"A{k}\"\nkind = \"revolute\"\nlinks = [\"ground\", \"crank {k}\"]\nguess = 65\n{actuated}\nframes = [{{ point = [{base}, 0, 0], {z} }}, {{ point = [0, 0, 0], {z} }}]\n[[joint]]\nname = \"B{k}\"\nkind = \"revolute\"\nlinks = [\"crank {k}\", \"coupler\"]\nguess = -65\nframes = [{{ point = [{length}, 0, 0], {z} }}, {{ point = [{coupler}, 0, 0], {z} }}]\n"
        )
    };
    let cranks = [[0.0, 0.1, 0.0], [0.15, 0.1, 0.15], [0.35, 0.1001, 0.3501]];
    let joints: String = (1..).zip(cranks).map(|(k, lengths)| crank(k, lengths)).collect();
    let sandbox = Sandbox::new();
    sandbox.write(
        "cranks.toml",
        &format!(
            "kind = \"mechanism\"\nname = \"cranks\"\nunits = {{ length = \"m\", angle = \"deg\" }}\nbase = \"ground\"\n{joints}"
        ),
    );
    let near = sandbox.json("assemble cranks.toml --tolerance 1e-3");
    assert!((near["coordinates"]["A1"].as_f64().unwrap() - 65.0).abs() < 1e-9, "{near}");
    let open = near["residual"].as_f64().unwrap();
    assert!((1e-5..1e-3).contains(&open), "{near}");
    assert!(sandbox.done("mobility cranks.toml --tolerance 1e-3").contains("within a tolerance"));

    let exact = sandbox.run("assemble cranks.toml");
    assert_eq!(exact.code, 0, "{}", exact.stderr);
    let words = "with the actuated joints at their guesses the loops are open by";
    assert!(
        exact.stderr.contains(words) && exact.stderr.contains("--tolerance"),
        "{}",
        exact.stderr
    );
}

/// With its crank free, the linkage has any number of configurations.
#[test]
fn a_search_for_configurations_that_ends_at_its_limit_is_reported() {
    let sandbox = Sandbox::new();
    let free = sandbox.json("assemble four-bar --branches 500");
    assert_eq!(free["branches"].as_array().unwrap().len(), 16, "{free}");
    let search = &free["branch_search"];
    assert_eq!((&search["limit"], &search["limit_reached"]), (&16.into(), &true.into()));
    let starts = search["starts"].as_u64().unwrap();
    assert!((16..500).contains(&starts), "{search}");
    let words = format!(
        "the search ended at its limit of 16 configurations after {starts} starts: there may be more"
    );
    let text = sandbox.done("assemble four-bar --branches 500");
    assert!(text.contains(&words), "{text}");

    let held = sandbox.json("assemble four-bar --at A=30 --branches 50");
    let search = &held["branch_search"];
    assert_eq!((&search["starts"], &search["limit_reached"]), (&50.into(), &false.into()));
    assert!(!sandbox.done("assemble four-bar --at A=30 --branches 50").contains("limit"));
}

#[test]
fn mobility_equals_that_of_the_catalogue() {
    let sandbox = Sandbox::new();
    let found = sandbox.json("mobility four-bar --at A=30 --set coupler=0.25");
    assert_eq!(found["kutzbach_mobility"], -2);
    assert_eq!(found["instantaneous_mobility"], 1);
    assert_eq!(found["finite_mobility"], 1);
    assert_eq!(found["finite_mobility_bounds"], serde_json::json!([1, 1]));
    assert_eq!((&found["rank"], &found["redundancy"]), (&3.into(), &3.into()));
    assert_eq!((&found["joint_freedoms"], &found["loops"]), (&4.into(), &1.into()));
    assert_eq!(found["coordinates"]["A"], 30.0);
    assert_eq!(found["null_space"].as_array().unwrap().len(), 1);
    assert_eq!(found["self_stress"].as_array().unwrap().len(), 3);
    assert_eq!(found["characteristic_length_mm"], 100.0);
    // The robot from a file, the same as by its flag.
    let robot = sandbox.done("catalogue show gpr");
    sandbox.write("robot.toml", &robot);
    assert_eq!(sandbox.json("mobility robot.toml"), sandbox.json("mobility --robot robot.toml"));
}

#[test]
fn virtual_joints_are_displaced_where_rigid_links_do_not_close() {
    let sandbox = Sandbox::new();
    let level = sandbox.json("mobility gpr-mechanism");
    assert_eq!(
        (&level["instantaneous_mobility"], &level["finite_mobility"]),
        (&3.into(), &1.into())
    );
    assert_eq!(level.get("virtual_joints"), None);
    let tilted = sandbox.json("mobility gpr-mechanism --at S1[1]=0.5");
    let l1 = tilted["virtual_joints"]["l1"].as_f64().unwrap();
    // In the tilted plane the balls' triangle is 1/cos times as high, 3/2 r, and as wide as it was: l1 is the difference.
    let expected = 1.5 * 93.218 * (1.0 / 0.5_f64.to_radians().cos() - 1.0);
    assert!((l1 - expected).abs() < 1e-7, "{l1} {expected}");
    assert_eq!(tilted["instantaneous_mobility"], 1);
    let play = sandbox.json("sensitivity gpr-mechanism --command S1[1]=0.5");
    let um = play["virtual_joints"][0]["displacement"].as_f64().unwrap();
    assert!((um - l1 * 1e3).abs() < 1e-4, "{um} {l1}");
}

#[test]
fn virtual_joints_are_displaced_along_a_motion() {
    let sandbox = Sandbox::new();
    let text = sandbox.done("catalogue show gpr-mechanism").replace("rod 1", "rod1");
    sandbox.write("robot.toml", &text);
    let raised = sandbox.json("move robot.toml --drive rod1=0:3:1");
    let column = |name: &str| -> Vec<f64> {
        let values = raised["series"][name].as_array().unwrap();
        values.iter().map(|value| value.as_f64().unwrap()).collect()
    };
    // One raised rod tilts the plane of the balls about the line of the other two: l1 is what its height gains.
    for (rod, l1) in column("rod1_mm").into_iter().zip(column("l1_mm")) {
        let height = 1.5 * 93.218;
        let expected = rod.hypot(height) - height;
        assert!((l1 - expected).abs() < 1e-9, "{rod} {l1} {expected}");
    }
    let largest = raised["largest_displacements"]["l1"].as_f64().unwrap();
    assert!((largest - 3.0_f64.hypot(1.5 * 93.218) + 1.5 * 93.218).abs() < 1e-9, "{largest}");
    // A single commanded coordinate of a ball joint takes another path through the core.
    let tilted = sandbox.json("move gpr-mechanism --drive S1[1]=0:0.5:0.25");
    assert_eq!(tilted["stopped"], serde_json::Value::Null);
    let tight = text.replace("slide = [1, 0, 0]", "slide = [1, 0, 0]\nclearance = 0.001");
    sandbox.write("tight.toml", &tight);
    let beyond = sandbox.run("move tight.toml --drive rod1=0:3:1");
    assert!(beyond.stdout.contains("limits exceeded      l1"), "{}", beyond.stdout);
    assert_eq!(beyond.code, 1);
    assert!(beyond.stderr.contains("its limits are -0.001 to 0.001 mm"), "{}", beyond.stderr);
}

/// A lift of crossed bars, half as high as it is wide: more loops than dense algebra takes.
fn tall_lift(stages: usize) -> String {
    let mut text = HEAD.to_owned();
    let mut pin = |name: String, links: [&str; 2], point: [f64; 3]| {
        text.push_str(&joint(&name, "revolute", links, point, [0.0, 1.0, 0.0]));
    };
    let bar = |sense: &str, stage: usize| format!("{sense} {stage}");
    pin("foot".to_owned(), ["ground", &bar("rising", 0)], [0.0; 3]);
    for stage in 0..stages {
        let (rising, falling) = (bar("rising", stage), bar("falling", stage));
        let z = stage as f64;
        pin(format!("middle{stage}"), [&rising, &falling], [1.0, 0.0, z + 0.5]);
        if stage + 1 < stages {
            let next = [bar("rising", stage + 1), bar("falling", stage + 1)];
            pin(format!("right {stage}"), [&rising, &next[1]], [2.0, 0.0, z + 1.0]);
            pin(format!("left {stage}"), [&falling, &next[0]], [0.0, 0.0, z + 1.0]);
        }
    }
    text
}

#[test]
fn many_loops_are_left_to_sparse_algebra() {
    let sandbox = Sandbox::new();
    sandbox.write("lift.toml", &tall_lift(120));
    let found = sandbox.json("mobility lift.toml");
    for (key, expected) in [
        ("loops", 119),
        ("instantaneous_mobility", 2),
        ("finite_mobility", 2),
        ("redundancy", 357),
        ("kutzbach_mobility", 2 - 357),
    ] {
        assert_eq!(found[key], expected, "{key}");
    }
    let text = sandbox.done("mobility lift.toml");
    assert!(text.contains("overconstrained and movable"), "{text}");
    assert!(sandbox.done("assemble lift.toml --at foot=10").contains("closed"));
    let moved = sandbox.json("move lift.toml --drive foot=0:20:10 --drive middle0=0:10");
    assert_eq!(moved["stopped"], serde_json::Value::Null);
    // Every stage folds alike.
    let middle: Vec<_> = (0..120).map(|k| &moved["series"][format!("middle{k}_deg")]).collect();
    for folded in &middle {
        let last = folded[2].as_f64().unwrap();
        assert!((last - 10.0).abs() < 1e-8, "{last}");
    }
    sandbox.done("draw lift.toml --ghost foot=20,middle0=10 --figure lift.svg");
    assert!(sandbox.read("lift.svg").contains(">moved<"));
    let refused = sandbox.run("suggest lift.toml");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("at most 240"), "{}", refused.stderr);
}

#[test]
fn play_beyond_the_clearance_is_a_no() {
    let sandbox = Sandbox::new();
    let text = sandbox.done("catalogue show gpr-mechanism");
    sandbox.write(
        "tight.toml",
        &text.replace("slide = [1, 0, 0]", "slide = [1, 0, 0]\nclearance = 0.001"),
    );
    let Run { code, stdout, stderr } = sandbox.run("sensitivity tight.toml --command S1[1]=0.5");
    assert_eq!(code, 1);
    assert!(stdout.contains("±1.000 µm  exceeded"), "{stdout}");
    assert!(stderr.contains("exceeds the clearance of l1"), "{stderr}");
}

#[test]
fn a_motion_is_written_as_series_and_figure() {
    let sandbox = Sandbox::new();
    sandbox.done("move four-bar --drive A=0:360:10 --out path");
    assert_eq!(
        sandbox.names("path"),
        ["four-bar-motion.csv", "four-bar-motion.png", "four-bar-motion.svg"]
    );
    let csv = sandbox.read("path/four-bar-motion.csv");
    assert!(csv.starts_with("A_deg,B_deg,C_deg,D_deg\n"), "{csv}");
    assert_eq!(csv.lines().count(), 38);
    assert!(sandbox.read("path/four-bar-motion.svg").contains("A (deg)"));
    // Again into the same folder on request only.
    assert_eq!(sandbox.run("move four-bar --out path").code, 2);
    assert_eq!(sandbox.read("path/four-bar-motion.csv"), csv);
    sandbox.done("move four-bar --out path --force");
    assert_ne!(sandbox.read("path/four-bar-motion.csv"), csv);
    let json = sandbox.json("move four-bar --drive A=:20:5");
    assert_eq!(json["series"]["A_deg"], serde_json::json!([0.0, 5.0, 10.0, 15.0, 20.0]));
    assert_eq!(json["stopped"], serde_json::Value::Null);
}

/// A door with a frame at its handle: the frame moves on a circle.
const DOOR: &str = r#"kind = "mechanism"
name = "door"
units = { length = "mm", angle = "deg" }
base = "wall"
[[joint]]
name = "hinge"
kind = "revolute"
links = ["wall", "leaf"]
point = [0, 0, 0]
axis = [0, 0, 1]
actuated = true
[[frame]]
name = "handle"
link = "leaf"
point = [900, 0, 1000]
axis = [1, 0, 0]
zero = [0, 1, 0]
"#;

#[test]
fn poses_of_links_and_attached_frames_follow_the_motion() {
    let sandbox = Sandbox::new();
    sandbox.write("door.toml", DOOR);
    let json = sandbox.json("move door.toml --drive hinge=0:350:10 --poses");
    let numbers = |frame: &str, key: &str, row: usize| -> Vec<f64> {
        let row = json["poses"][frame][key][row].as_array().unwrap();
        row.iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let mut before = numbers("handle", "quaternion", 0);
    for row in 0..36 {
        let angle = f64::to_radians(10.0 * row as f64);
        let [x, y, z] = numbers("handle", "position", row)[..] else { panic!() };
        let off = (x - 900.0 * angle.cos()).hypot(y - 900.0 * angle.sin()).max(z - 1000.0);
        assert!(off < 1e-9, "{row}: {off}");
        let [w, i, j, k] = numbers("leaf", "quaternion", row)[..] else { panic!() };
        let half = 0.5 * angle;
        assert!((w - half.cos()).abs().max((k - half.sin()).abs()) < 1e-12, "{w} {k}");
        assert!(i.abs().max(j.abs()) < 1e-15);
        // The sign of a quaternion does not jump at a half turn.
        let quaternion = numbers("handle", "quaternion", row);
        let along: f64 = before.iter().zip(&quaternion).map(|(a, b)| a * b).sum();
        assert!(along > 0.99, "{row}: {along}");
        before = quaternion;
    }
    let text = sandbox.done("move door.toml --drive hinge=0:90 --poses --out path");
    assert!(text.contains("handle                   900.000000         0.000000"), "{text}");
    // No other coordinate follows the hinge, so that there is nothing to draw.
    assert_eq!(sandbox.names("path"), ["door-motion.csv"]);
    let csv = sandbox.read("path/door-motion.csv");
    let header = "hinge_deg,leaf_x_mm,leaf_y_mm,leaf_z_mm,leaf_qw,leaf_qx,leaf_qy,leaf_qz,handle_x_mm,handle_y_mm,handle_z_mm,handle_qw,handle_qx,handle_qy,handle_qz\n";
    assert!(csv.starts_with(header), "{csv}");
    assert!(!sandbox.json("move door.toml")["poses"].is_object());
}

#[test]
fn velocities_of_a_door_are_those_of_a_circle() {
    let sandbox = Sandbox::new();
    sandbox.write("door.toml", DOOR);
    let line = "jacobian door.toml --at hinge=30 --velocity hinge=90 --acceleration hinge=45";
    let json = sandbox.json(line);
    let near = |found: &serde_json::Value, expected: f64| {
        assert!((found.as_f64().unwrap() - expected).abs() < 1e-9, "{found} {expected}");
    };
    // A file with frames reports these, and no links.
    assert_eq!(json["frames"].as_object().unwrap().len(), 1);
    let handle = &json["frames"]["handle"];
    let (sine, cosine) = 30_f64.to_radians().sin_cos();
    let (speed, degree) = (90_f64.to_radians(), 1_f64.to_radians());
    near(&handle["jacobian"][2][0], 1.0);
    near(&handle["jacobian"][3][0], -900.0 * sine * degree);
    near(&handle["jacobian"][4][0], 900.0 * cosine * degree);
    near(&handle["jacobian_derivative"][3][0], -900.0 * cosine * degree * speed);
    near(&handle["velocity"]["angular"][2], 90.0);
    let tangential = 900.0 * 45_f64.to_radians();
    let radial = 900.0 * speed * speed;
    near(&handle["acceleration"]["linear"][0], -tangential * sine - radial * cosine);
    near(&handle["acceleration"]["linear"][1], tangential * cosine - radial * sine);
    near(&json["accelerations"]["hinge"], 45.0);
    assert_eq!(handle["singular_values"].as_array().unwrap().len(), 1);
    let both = sandbox.json("jacobian door.toml --frame leaf,handle");
    assert_eq!(both["frames"].as_object().unwrap().len(), 2);
    assert!(both["velocities"].is_null() && both["frames"]["leaf"]["velocity"].is_null());
}

#[test]
fn parameters_move_a_linkage_as_other_values_do() {
    let sandbox = Sandbox::new();
    let with = |set: &str| {
        let json =
            sandbox.json(&format!("jacobian four-bar --at A=30 --frame coupler --set {set}"));
        let position = &json["frames"]["coupler"]["position"];
        [&json["coordinates"]["C"], &position[0], &position[1]].map(|one| one.as_f64().unwrap())
    };
    let (less, more) = (with("coupler=0.2599"), with("coupler=0.2601"));
    let json = sandbox.json("jacobian four-bar --at A=30 --frame coupler --parameters=coupler");
    let found = &json["parameters"]["coupler"];
    let linear = &found["frames"]["coupler"]["linear"];
    for (k, found) in [&found["coordinates"]["C"], &linear[0], &linear[1]].into_iter().enumerate() {
        let expected = (more[k] - less[k]) / 2e-4;
        let off = (found.as_f64().unwrap() - expected).abs();
        assert!(off < 1e-5 * expected.abs().max(1.0), "{k}: {found} {expected}");
    }
    let all = sandbox.json("jacobian four-bar --at A=30 --parameters");
    assert_eq!(all["parameters"].as_object().unwrap().len(), 11);
    assert!(sandbox.json("jacobian four-bar")["parameters"].is_null());
    refused("", "jacobian four-bar --parameters=cuopler", 2, "did you mean `coupler`?");
    let opens = "jacobian bennett --parameters=b";
    refused("", opens, 1, "parameter `b`: changing this dimension opens the loops");
}

/// Names of links may have commas, as in imported models; commas separate names too.
#[test]
fn links_with_commas_can_be_reported() {
    let text = include_str!("../../../jointplay-format/robots/four-bar.toml");
    let sandbox = Sandbox::new();
    sandbox.write("bars.toml", &text.replace("\"coupler\"", "\"coupler, steel\""));
    let found = sandbox.json("jacobian bars.toml --frame \"coupler, steel\" --frame crank,rocker");
    let frames: Vec<&String> = found["frames"].as_object().unwrap().keys().collect();
    assert_eq!(frames, ["coupler, steel", "crank", "rocker"]);
    let unknown = sandbox.run("jacobian bars.toml --frame \"crank,coupler, stel\"");
    assert_eq!(unknown.code, 2);
    assert!(unknown.stderr.contains("`coupler` is not known"), "{}", unknown.stderr);
}

#[test]
fn a_motion_names_what_its_drives_leave_free() {
    let sandbox = Sandbox::new();
    let text = sandbox.done("move delta --steps 2");
    assert!(text.contains("left free: the spins of rod 1 left, rod 1 right, "), "{text}");
    let free = |command: &str| sandbox.json(command)["free_motions"].clone();
    let spins = free("move delta --steps 2");
    assert_eq!(spins.as_array().unwrap().len(), 6);
    assert_eq!((&spins[0]["is_spin"], &spins[0]["count"]), (&true.into(), &1.into()));
    // A released motor is free with the links that it holds.
    let released = free("move delta --steps 2 --free \"drive 3\"");
    let counts = released.as_array().unwrap().iter().map(|one| one["count"].as_u64().unwrap());
    assert_eq!(counts.sum::<u64>(), 7);
    assert_eq!(free("move four-bar --steps 2"), serde_json::json!([]));
    // A chain of 300 hinges, whose last one has no motor, is too large for dense algebra.
    let links: Vec<String> = (0..300).map(|k| format!("l{k}")).collect();
    let hinge = |k: usize| {
        let from = if k == 0 { "ground" } else { &links[k - 1] };
        let hinge = format!("j{k}");
        let hinge = joint(&hinge, "revolute", [from, &links[k]], [10.0 * k as f64, 0.0, 0.0], Z);
        format!("{hinge}actuated = {}\n", k < 299)
    };
    let chain: String = (0..300).map(hinge).collect();
    sandbox.write("chain.toml", &(HEAD.to_owned() + &chain));
    let text = sandbox.done("move chain.toml --drive j0=0:1 --steps 2");
    assert!(text.contains("left free: not determined for a mechanism of this size"), "{text}");
    assert!(free("move chain.toml --drive j0=0:1 --steps 2").is_null());
}

#[test]
fn commands_that_do_not_determine_the_motion_have_no_jacobian() {
    refused("", "jacobian four-bar --commanded A,D", 1, "the loops do not allow these rates");
    let tilt = "jacobian gpr-mechanism --commanded \"rod 1,rod 2\"";
    refused("", tilt, 1, "leave 1 motion free: a motion of rod 3, platform by rod 3, S1");
    let unknown = "jacobian four-bar --frame coupla";
    refused("", unknown, 2, "did you mean `coupler`?");
    let passive = "jacobian four-bar --velocity B=3";
    refused("", passive, 2, "B is not commanded; commanded are A");
    refused("", "jacobian griffis-duffy", 2, "use --commanded JOINT");
}

#[test]
fn a_step_that_does_not_fit_into_its_range_is_refused() {
    let refuse = |line, message| refused("", line, 2, message);
    let misses = "--drive A (in deg): steps of 3 from 0 miss 10: the range is 3.33333 steps long";
    refuse("move four-bar --drive A=0:10:3", misses);
    refuse("move four-bar --drive A=0:10:30", "miss 10");
    refuse("move four-bar --drive A=0:10:-5", "a step of -5 does not lead from 0 to 10");
    refuse(
        "move hexapod --drive P1=0:20:5 --drive P2=0:20:10",
        "P1 has 4 steps and --drive P2 has 2",
    );
    let sandbox = Sandbox::new();
    let json = sandbox.json("move four-bar --drive A=0:-1:-0.1");
    assert_eq!(json["series"]["A_deg"].as_array().unwrap().len(), 11);
}

#[test]
fn a_mobility_that_its_file_does_not_expect_is_an_answer_of_no() {
    let sandbox = Sandbox::new();
    let four_bar = sandbox.done("catalogue show four-bar");
    assert!(four_bar.contains("finite = 1") && four_bar.contains("rank = "));
    sandbox.write("mine.toml", &four_bar);
    sandbox.done("mobility mine.toml");
    sandbox.write(
        "mine.toml",
        &four_bar.replace("finite = 1", "finite = 0").replace("\nrank = ", "\nrank = 7"),
    );
    let run = sandbox.run("mobility mine.toml");
    assert_eq!(run.code, 1);
    assert!(run.stdout.contains("freedoms"), "{}", run.stdout);
    assert!(run.stderr.contains("finite: 0 expected, 1 found"), "{}", run.stderr);
    assert!(run.stderr.contains("rank: 73 expected, 3 found"), "{}", run.stderr);
    // Expectations do not apply to other poses and dimensions.
    sandbox.done("mobility mine.toml --at A=30");
    sandbox.done("mobility mine.toml --set coupler=0.25");
}

#[test]
fn a_stopped_motion_reports_its_position() {
    let sandbox = Sandbox::new();
    // The rocker cannot follow a full turn.
    let run = sandbox.run("move four-bar --drive D=0:180 --format json");
    assert_eq!(run.code, 1);
    let found: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(found["stopped"], "locked");
    assert!(run.stderr.contains("stopped at D = "), "{}", run.stderr);
    assert!(run.stderr.contains("a dead point"), "{}", run.stderr);
    // That point is singular, and the last of the series.
    let there = &found["singular"][0];
    assert_eq!((&there["branches"], &there["drives_reverse"]), (&1.into(), &true.into()));
    assert_eq!(
        there["coordinates"]["D"],
        *found["series"]["D_deg"].as_array().unwrap().last().unwrap()
    );
}

#[test]
fn drives_that_continue_on_the_only_branch_do_not_reverse() {
    let sandbox = Sandbox::new();
    // Flat at 115°, where the third crank admits no antiparallelogram.
    let text = sandbox.done("move parallelogram --drive A1=100:130:5");
    let line = "A1 = 115.000000 deg: instantaneous mobility 2, one branch, on which the driven coordinates continue";
    assert!(text.contains(line), "{text}");
    let ends = sandbox.json("move parallelogram --drive A1=0:115");
    assert_eq!(ends["singular"][0]["drives_reverse"], false, "{ends}");
}

#[test]
fn a_singular_start_is_left_where_a_branch_leads_on() {
    let sandbox = Sandbox::new();
    let text = sandbox.done("move 3-upu-snu --drive P1=0:20");
    assert!(text.contains("P1 = 0.000000 mm: instantaneous mobility 5"), "{text}");
    // A parallelogram through flat, with a step that ends there.
    let flat = "move four-bar --set coupler=0.3,rocker=0.1 --drive A=0:-160:-10 --format json";
    let found: serde_json::Value = serde_json::from_str(&sandbox.done(flat)).unwrap();
    let [there] = &found["singular"].as_array().unwrap()[..] else { panic!("{found}") };
    assert_eq!(there["branches"], 2, "{there}");
    assert!((there["drives"]["A"].as_f64().unwrap() + 70.0).abs() < 1e-6, "{there}");
}

#[test]
fn branches_of_different_dimension_are_reported() {
    let sandbox = Sandbox::new();
    let line = "mobility wunderlich-12-bar --set t=0";
    let text = sandbox.done(line);
    let words = "branches of different freedom meet here (1, 2): a kinematotropic candidate";
    assert!(text.contains(words), "{text}");
    let json = sandbox.done(&format!("{line} --format json"));
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(found["branch_dimensions"], serde_json::json!([1, 2]));
    let one = sandbox.done("mobility wunderlich-12-bar --format json");
    assert!(!one.contains("branch_dimensions"));
}

/// The written joints close the loops by another computation, with the mismatch of the links included.
#[test]
fn suggested_joints_close_measured_links_too() {
    let sandbox = Sandbox::new();
    let copied = sandbox.done("catalogue show bennett").replace("b = 0.11\n", "b = 0.1101\n");
    sandbox.write("measured.toml", &copied);
    let found = sandbox.json("suggest measured.toml --write 1 --out play.toml");
    assert_eq!(found["play_needed"], true);
    let residual = found["home_residual"].as_f64().unwrap();
    assert!((1e-4..1e-3).contains(&residual), "{residual}");
    let commanded = found["commands"][0][0].as_f64().unwrap();
    let closed = sandbox.json(&format!("sensitivity play.toml --command J1={commanded}"));
    assert!(closed["residual"].as_f64().unwrap() < 1e-11, "{closed}");
    assert_eq!(closed["size_unit"], "um");
    let size_mm = 1e-3 * closed["size"].as_f64().unwrap();
    assert!((size_mm / found["sets"][0]["size_mm"].as_f64().unwrap() - 1.0).abs() < 1e-6);
    let text = sandbox.done("suggest measured.toml");
    assert!(text.contains("rigid links do not close, by "), "{text}");
    // With the joints in the file, the search starts from the configuration that they close.
    let again = sandbox.json("suggest play.toml");
    assert_eq!(again["play_needed"], true);
    // Exact dimensions have no residual in the report.
    assert!(sandbox.json("suggest parallelogram --command A1=5")["home_residual"].is_null());
}

/// Of the displacements that close measured links at a command, the least one: near 54.3°, two are least nearby, and far from the guess there are others of many millimetres.
///
/// Expected (µm): the least of 40 random starts each, by an independent program in NumPy with Jacobians by central differences.
#[test]
fn measured_links_take_the_least_displacement_at_any_command() {
    let sandbox = Sandbox::new();
    let copied = sandbox.done("catalogue show bennett").replace("b = 0.11\n", "b = 0.1101\n");
    let play = r#"
[[virtual_joint]]
name = "slide"
joint = "J1"
on = "link 1"
slide = [0, -1, 0]

[[virtual_joint]]
name = "first turn"
joint = "J2"
on = "link 2"
turn = [0.544796330904, -0.838568397826, 0]
about = [0, 0, 0]

[[virtual_joint]]
name = "second turn"
joint = "J4"
on = "ground"
turn = [0.545090125277, -0.726056173098, -0.419188726985]
about = [-0.1101, 0, 0]
"#;
    sandbox.write("play.toml", &format!("{copied}{play}"));
    let expected = [
        (20.0, 35.352),
        (35.0, 58.952),
        (51.5, 84.881),
        (53.0, 87.788),
        (54.3, 115.139),
        (54.3648, 84.645),
        (60.0, 97.921),
        (70.0, 115.473),
    ];
    for (at, least) in expected {
        let found = sandbox.json(&format!("sensitivity play.toml --command J1={at}"));
        let size = found["size"].as_f64().unwrap();
        assert!((size - least).abs() < 1e-3, "J1 = {at}: {size} µm, not {least} µm");
    }
}

/// Bennett's linkage with a length of four digits: rigid and not closed exactly, mobile within a tolerance.
#[test]
fn near_misses_differ_from_open_loops() {
    let rounded = "bennett --set b=0.1101";
    let sandbox = Sandbox::new();
    let refused = sandbox.run(&format!("mobility {rounded}"));
    assert_eq!(refused.code, 1);
    assert!(refused.stderr.contains("they close to 1.7e-4"), "{}", refused.stderr);
    assert!(refused.stderr.contains("--tolerance"), "{}", refused.stderr);
    let refused = sandbox.run(&format!("assemble {rounded} --tolerance 1e-5"));
    assert_eq!((refused.code, refused.stdout.as_str()), (1, ""));

    let found = sandbox.json(&format!("mobility {rounded} --tolerance 1e-3"));
    assert_eq!((&found["finite_mobility"], &found["near_mobility"]), (&0.into(), &1.into()));
    assert_eq!(found["tolerance"], 1e-3);
    let (gap, needed) = (found["forced_shut"].as_f64(), found["near_tolerance_needed"].as_f64());
    assert!(gap > Some(1e-4) && needed >= gap && needed < Some(5e-4), "{gap:?} {needed:?}");
    let text = sandbox.done(&format!("mobility {rounded} --tolerance 1e-3"));
    let expected = "within a tolerance of 1.0e-3: 1, if dimensions are accurate only to 1.7e-4";
    assert!(text.contains(expected) && text.contains("forced shut"), "{text}");

    let assembled = sandbox.json(&format!("assemble {rounded} --tolerance 1e-3"));
    assert_eq!(
        (assembled["tolerance"].as_f64(), assembled["residual"].as_f64()),
        (Some(1e-3), gap)
    );
    let text = sandbox.done(&format!("assemble {rounded} --tolerance 1e-3"));
    assert!(text.contains("closed within the tolerance"), "{text}");
    // Loops that close exactly are reported so, with or without a tolerance.
    let exact = sandbox.done("assemble bennett --tolerance 1e-3");
    assert_eq!(exact, sandbox.done("assemble bennett"));
    let exact = sandbox.done("mobility bennett --tolerance 1e-3");
    assert!(
        exact.contains("within a tolerance of 1.0e-3: 1, equal to the finite mobility"),
        "{exact}"
    );
    assert!(!exact.contains("forced shut"), "{exact}");
}

/// A hinge tilted by 1e-5: closed, rigid, and a hint at --tolerance.
#[test]
fn near_misses_that_close_are_hinted_at() {
    let sandbox = Sandbox::new();
    let links = [["ground", "a"], ["a", "b"], ["b", "c"], ["c", "ground"]];
    let points = [[0.0, 0.0, 0.0], [5.0, 9.0, 0.0], [26.0, 15.0, 0.0], [30.0, 0.0, 0.0]];
    let file = |tilt: f64| {
        let joints = (0..4).map(|k| {
            let axis = if k == 1 { [tilt, 0.0, 1.0] } else { Z };
            joint(&format!("J{k}"), "revolute", links[k], points[k], axis)
        });
        format!("{HEAD}{}", joints.collect::<String>())
    };
    sandbox.write("tilted.toml", &file(1e-5));
    sandbox.write("upright.toml", &file(0.0));
    let text = sandbox.done("mobility tilted.toml");
    let (_, after) = text.split_once("near miss: mobility 1").unwrap_or_else(|| panic!("{text}"));
    let (_, after) = after.split_once("--tolerance ").unwrap();
    let tolerance = after.split(['\n', ' ']).next().unwrap();
    let found = sandbox.json(&format!("mobility tilted.toml --tolerance {tolerance}"));
    assert_eq!((&found["finite_mobility"], &found["near_mobility"]), (&0.into(), &1.into()));
    assert!(found.get("near_miss").is_none() && found["forced_shut"].is_null());
    let found = sandbox.json("mobility tilted.toml");
    assert!(found.get("near_mobility").is_none());
    assert_eq!(found["near_miss"]["near_mobility"], 1);
    let needed = found["near_miss"]["near_tolerance_needed"].as_f64();
    assert!(needed > Some(1e-7) && needed < Some(1e-5), "{needed:?}");
    assert!(!sandbox.done("mobility upright.toml").contains("near miss"));
}

/// A length off by a millionth where second order breaks the motion: no small singular value, and still a hint.
#[test]
fn near_misses_of_second_order_are_hinted_at() {
    // Peaucellier and Lipkin's inversor, its pen in a slot along the line that it draws.
    let points: [[f64; 2]; 5] = [[0.0, 0.0], [2.0, 0.0], [6.0, 3.0], [6.0, -3.0], [0.0, 0.0]];
    let [o, c, a, b, _] = points;
    let file = |off: f64| {
        // The rhombus O-A-P-B reflects C's circle through O into a line: |OC| = |CD| with D the other corner.
        let d = [4.0, 0.0];
        let p = [8.0, 0.0];
        let mut text = HEAD.to_owned();
        let mut hinge = |name: &str, links: [&str; 2], at: [f64; 2]| {
            text.push_str(&joint(name, "revolute", links, [at[0], at[1], 0.0], Z));
        };
        hinge("O1", ["ground", "OA"], o);
        hinge("O2", ["ground", "OB"], o);
        hinge("C", ["ground", "CD"], [c[0] - off, c[1]]);
        hinge("A1", ["OA", "AD"], a);
        hinge("A2", ["OA", "AP"], a);
        hinge("B1", ["OB", "BD"], b);
        hinge("B2", ["OB", "BP"], b);
        hinge("D1", ["CD", "AD"], d);
        hinge("D2", ["CD", "BD"], d);
        hinge("P1", ["AP", "BP"], p);
        hinge("P2", ["AP", "pen"], p);
        text + &joint("slot", "prismatic", ["ground", "pen"], [8.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    };
    let sandbox = Sandbox::new();
    sandbox.write("exact.toml", &file(0.0));
    sandbox.write("off.toml", &file(4e-6));
    let exact = sandbox.json("mobility exact.toml");
    assert_eq!(exact["finite_mobility"], 1, "{exact}");
    assert!(exact.get("near_miss").is_none());
    let off = sandbox.json("mobility off.toml");
    assert_eq!((&off["instantaneous_mobility"], &off["finite_mobility"]), (&1.into(), &0.into()));
    assert_eq!(off["near_miss"]["near_mobility"], 1, "{off}");
    let needed = off["near_miss"]["near_tolerance_needed"].as_f64().unwrap();
    assert!((1e-9..1e-6).contains(&needed), "{needed:e}");
    // What is needed does not depend on the tolerance asked with.
    for tolerance in ["1e-6", "1e-4", "1e-2"] {
        let found = sandbox.json(&format!("mobility off.toml --tolerance {tolerance}"));
        assert_eq!(found["near_tolerance_needed"], off["near_miss"]["near_tolerance_needed"]);
    }
}

/// Where a command leaves the height free, the robot stays where it is; and limits are an answer in every command.
#[test]
fn undetermined_joints_move_least_and_limits_hold() {
    let sandbox = Sandbox::new();
    let tilt = "--command S1[0]=0,S1[1]=1";
    let rods = |coordinates: &serde_json::Value| {
        ["rod 1", "rod 2", "rod 3"].map(|rod| coordinates[rod].as_f64().unwrap())
    };
    let found = sandbox.json(&format!("sensitivity gpr-mechanism {tilt}"));
    let at = rods(&found["coordinates"]);
    assert!(at.iter().sum::<f64>().abs() < 1e-6, "{at:?}");
    // R tan α for the rod toward the tilt.
    assert!((at[0] + 93.218 * 1.0_f64.to_radians().tan()).abs() < 1e-6, "{at:?}");
    let found = sandbox.json(&format!("suggest gpr-mechanism {tilt}"));
    let best = &found["sets"][0];
    let size = best["size_mm"].as_f64().unwrap();
    assert!((size - 0.0213).abs() < 1e-4, "{size}");
    assert!(rods(&best["configurations"][0]).iter().all(|rod| rod.abs() < 4.0));
    let text = sandbox.done(&format!("suggest gpr-mechanism {tilt}"));
    assert!(text.contains("   at rod 1 = ") && !text.contains("exceeded"), "{text}");

    for line in [
        "sensitivity gpr-mechanism --command \"rod 1=1e6\"",
        "assemble gpr-mechanism --at \"rod 1=300,rod 2=300,rod 3=300\"",
        "mobility gpr-mechanism --at \"rod 1=300,rod 2=300,rod 3=300\"",
        "move gpr-mechanism --drive \"rod 1=0:300\" --drive \"rod 2=0:300\" --drive \"rod 3=0:300\"",
        "suggest gpr-mechanism --command \"rod 1=300,rod 2=300,rod 3=301\"",
    ] {
        let run = sandbox.run(line);
        assert_eq!(run.code, 1, "{line}: {}", run.stderr);
        assert!(run.stderr.contains("joint limits exceeded"), "{line}: {}", run.stderr);
        assert!(run.stderr.contains("its limits are -254 to 254 mm"), "{line}: {}", run.stderr);
        assert!(!run.stdout.is_empty(), "{line}");
    }
}

/// Virtual joints of the file are used by `assemble --at` as by `mobility --at`.
#[test]
fn assembling_uses_virtual_joints() {
    let sandbox = Sandbox::new();
    let line = "gpr-mechanism --at \"rod 1=1,rod 2=0,rod 3=-1\"";
    let assembled = sandbox.json(&format!("assemble {line}"));
    let posed = sandbox.json(&format!("mobility {line}"));
    assert_eq!(assembled["coordinates"], posed["coordinates"]);
    assert_eq!(assembled["virtual_joints"], posed["virtual_joints"]);
    assert!(assembled["virtual_joints"]["l1"].as_f64().is_some());
}

/// An open chain needs no virtual joints, and is reported as one.
#[test]
fn an_open_chain_is_named() {
    let sandbox = Sandbox::new();
    let text = format!(
        "{HEAD}{}{}",
        joint("a", "revolute", ["ground", "upper"], [0.0; 3], Z),
        joint("b", "revolute", ["upper", "lower"], [10.0, 0.0, 0.0], Z)
    );
    sandbox.write("arm.toml", &text);
    let text = sandbox.done("suggest arm.toml --command a=1");
    assert!(text.contains("none needed: an open chain"), "{text}");
}

#[test]
fn names_that_are_not_there() {
    let refuse = |line, message| refused("", line, 2, message);
    refuse(
        "mobility four-bar --at AA=1",
        "joint `AA` is not known (did you mean `A`?); known: A, B, C, D",
    );
    refuse(
        "assemble 3-rps --at S1=1",
        "joint `S1` has 3 freedoms: choose one of S1[0], S1[1], S1[2]",
    );
    refuse("assemble four-bar --at A", "expected JOINT=VALUE");
    refuse("assemble four-bar --at A=x", "A: \"x\": unknown name `x`");
    refuse("assemble four-bar --set couple=1", "couple");
    refuse("move four-bar --drive A", "expected JOINT=FROM:TO");
    refuse("move four-bar --drive A=0:1:0", "STEP must not be 0");
    refuse("move four-bar --drive A=1:1", "FROM and TO are equal");
    refuse("move four-bar --drive A=0:1 --drive A=0:2", "is given twice");
    refuse("move griffis-duffy", "no joint of this mechanism is actuated");
    refuse("move four-bar --drive A=0:360:1e-3", "at most 100000 steps");
    refuse("move four-bar --drive A=0:360:1e-9", "values, at most");
    refuse("mobility four-bar --q-mm 1,2,3", "--q-mm and --virtualization");
    refuse("mobility gpr --at A=1", "--at applies to mechanism files");
    refuse("mobility --set a=1", "--set needs a file: use --robot for a robot file");
    refuse("mobility gpr --tolerance 1e-3", "--tolerance applies to mechanism files");
    refuse("mobility --tolerance 1e-3", "--tolerance applies to mechanism files");
    refuse("mobility four-bar --tolerance 0.5", "must be from 1e-11 to 1e-2, got 0.5");
    refuse("assemble four-bar --tolerance=-1e-3", "must be from 1e-11 to 1e-2");
    refuse("assemble four-bar --tolerance x", "invalid number");
    refuse("sensitivity four-bar --command A=1", "no virtual joints");
    refuse("sensitivity gpr-mechanism", "no command is given");
    refuse("catalogue show benett", "did you mean `bennett`?");
    refuse("assemble missing.toml", "cannot read missing.toml");
}

#[test]
fn files_that_make_no_mechanism() {
    let line = "mobility test.toml";
    let hinge = joint("a", "revolute", ["ground", "arm"], [0.0; 3], Z);
    let dangling = joint("b", "revolute", ["x", "y"], [1.0, 0.0, 0.0], Z);
    refused(&format!("{HEAD}{hinge}{dangling}"), line, 2, "is not connected to the base");
    let own = joint("b", "revolute", ["arm", "arm"], [1.0, 0.0, 0.0], Z);
    refused(&format!("{HEAD}{hinge}{own}"), line, 2, "to itself");
    let no_axis = joint("a", "revolute", ["ground", "arm"], [0.0; 3], [0.0; 3]);
    refused(&format!("{HEAD}{no_axis}"), line, 2, "is a direction, but all its numbers are 0");
    refused("kind = \"mechanism\"", line, 2, "test.toml:");
}

#[test]
fn two_joints_in_one_place() {
    let sandbox = Sandbox::new();
    let first = joint("a", "revolute", ["ground", "arm"], [0.0; 3], Z);
    let second = joint("b", "revolute", ["ground", "arm"], [0.0; 3], Z);
    sandbox.write("test.toml", &format!("{HEAD}{first}{second}"));
    let found = sandbox.json("mobility test.toml");
    assert_eq!(
        (&found["instantaneous_mobility"], &found["finite_mobility"]),
        (&1.into(), &1.into())
    );
    assert_eq!(found["redundancy"], 5);
}

#[test]
fn links_that_do_not_fit_are_a_no() {
    // Rods of 10 and 10 mm cannot reach over 50.
    let hinge = joint("a", "revolute", ["ground", "one"], [0.0; 3], Z);
    let frames = |name: &str, links: [&str; 2], from: f64, to: f64| {
        format!(
            "[[joint]]\nname = \"{name}\"\nkind = \"revolute\"\nlinks = {links:?}\nframes = [{{ point = [{from:?}, 0, 0], axis = [0, 0, 1], zero = [1, 0, 0] }}, {{ point = [{to:?}, 0, 0], axis = [0, 0, 1], zero = [1, 0, 0] }}]\n"
        )
    };
    let far = format!(
        "{HEAD}{hinge}{}{}",
        frames("b", ["one", "two"], 10.0, 0.0),
        frames("c", ["two", "ground"], 10.0, 50.0)
    );
    refused(&far, "mobility test.toml", 1, "the loops cannot be closed: best mismatch");
    refused(&far, "assemble test.toml", 1, "stays open by");
    refused(&far, "suggest test.toml --command a=1", 1, "stays open by");
}

#[test]
fn the_note_of_an_open_chain_mentions_no_loops() {
    let sandbox = Sandbox::new();
    let hinge = joint("a", "revolute", ["ground", "one"], [0.0; 3], Z);
    sandbox.write("test.toml", &format!("{HEAD}{hinge}limits = [10, 20]\n"));
    let run = sandbox.run("assemble test.toml");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let note =
        "the guess is beyond the joint limits: the nearest configuration within them is used";
    assert!(run.stderr.contains(note) && !run.stderr.contains("loop"), "{}", run.stderr);
    let file = format!("{HEAD}{hinge}limits = [5, 5]\n");
    refused(&file, "assemble test.toml", 2, "`limits` are an empty range: least 5, most 5");
}

#[test]
fn lengths_and_angles_are_in_the_units_of_the_file() {
    let hinge = joint("a", "revolute", ["ground", "one"], [0.0; 3], Z);
    let beyond = "[[joint]]\nname = \"b\"\nkind = \"revolute\"\nlinks = [\"ground\", \"one\"]\nframes = [{ point = [0, 0, 0], axis = [0, 0, 1], zero = [1, 0, 0] }, { point = [3, 0, 0], axis = [0, 0, 1], zero = [1, 0, 0] }]\n";
    for (length, angle) in [("mm", "deg"), ("in", "rad")] {
        let units = format!("units = {{ length = {length:?}, angle = {angle:?} }}");
        let head = HEAD.replace("units = { length = \"mm\", angle = \"deg\" }", &units);
        let open = format!("{head}{hinge}{beyond}");
        refused(&open, "mobility test.toml", 1, &format!("are 3 {length} and "));
        refused(&open, "mobility test.toml", 1, &format!(" {angle} apart"));
    }
    // An open chain of one crank.
    let pin = joint("a", "revolute", ["ground", "one"], [100.0, 20.0, 0.0], Z);
    for (length, axis) in [
        ("mm", "rotation about an axis through (100.0000, 20.0000, 0.0000) mm"),
        ("um", "rotation about an axis through (100.0, 20.0, 0.0) um"),
        ("in", "rotation about an axis through (100.000000, 20.000000, 0.000000) in"),
    ] {
        let sandbox = Sandbox::new();
        let head = HEAD.replace("\"mm\"", &format!("{length:?}"));
        sandbox.write("test.toml", &format!("{head}{pin}"));
        let text = sandbox.done("mobility test.toml");
        assert!(text.contains(axis), "{text}");
    }
    let sandbox = Sandbox::new();
    let text = sandbox.done("mobility bennett");
    assert!(text.contains("lengths in units of 0.22 m\n"), "{text}");
    assert!(text.contains(") m with a moment of "), "{text}");
}

#[test]
fn a_closure_that_drifts_is_never_within_a_tolerance() {
    // With these coordinates held, the sliders of the 3-PRS platform run away: at 11 m their mismatch is below 1e-2 of its size.
    let at = "S2[0]=-0.238227703255103,R3=0.0792213199342808,S3[1]=0.2066036079337891,R1=0.0494851612098681,S3[0]=-0.27009488146112187,S2[2]=0.2832733133870829";
    let run = Sandbox::new().run(&format!("assemble 3-prs --at {at} --tolerance 1e-2"));
    assert_eq!((run.code, run.stdout.as_str()), (1, ""), "{}", run.stderr);
    assert!(run.stderr.contains("links moved apart"), "{}", run.stderr);
}

#[test]
fn a_copy_never_replaces() {
    let sandbox = Sandbox::new();
    sandbox.done("catalogue copy bennett mine");
    assert_eq!(sandbox.names("mine"), ["bennett.toml"]);
    assert_eq!(sandbox.read("mine/bennett.toml"), sandbox.done("catalogue show bennett"));
    sandbox.write("mine/bennett.toml", "changed");
    let again = sandbox.run("catalogue copy bennett mine");
    assert_eq!(again.code, 2);
    assert!(again.stderr.contains("exists: choose another name"), "{}", again.stderr);
    assert_eq!(sandbox.read("mine/bennett.toml"), "changed");
    // A file takes precedence over a catalogue entry of the same name.
    sandbox.write("four-bar", "kind = \"mechanism\"");
    assert_eq!(sandbox.run("mobility four-bar").code, 2);
}

#[test]
fn the_paper_s_slides_are_suggested_first() {
    let sandbox = Sandbox::new();
    let text = sandbox.done("suggest gpr-mechanism --format json");
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(report["play_needed"], true);
    let best = &report["sets"][0];
    assert_eq!(best["symmetric"], true);
    for (k, joint) in ["S1", "S2", "S3"].into_iter().enumerate() {
        let slide = &best["virtual_joints"][k];
        assert_eq!(slide["name"], format!("radial slide of platform at {joint}"));
        assert_eq!((&slide["motion"], &slide["unit"]), (&"slide".into(), &"um".into()));
    }
    let text = sandbox.done("suggest gpr-mechanism");
    assert!(text.contains("1. displacement 0.07766 mm, symmetric"), "{text}");
    assert!(
        sandbox.done("suggest 3-rps").contains("none needed: rigid links close for each command")
    );
    let other = sandbox.run("suggest parallelogram --command A1=5,A2=4 --command A1=5");
    assert_eq!(other.code, 2);
    assert!(other.stderr.contains("must name the same joints"), "{}", other.stderr);
    let none = sandbox.run("suggest 3-crr");
    assert_eq!(none.code, 2);
    assert!(none.stderr.contains("no actuated joint"), "{}", none.stderr);
}

#[test]
fn suggestions_are_ranked_by_elastic_energy() {
    let sandbox = Sandbox::new();
    let tilt = "--command \"rod 1=2,rod 2=0,rod 3=0\" --rank stiffness";
    let refused = sandbox.run(&format!("suggest gpr-mechanism {tilt}"));
    assert_eq!(refused.code, 2);
    for part in ["has no linear stiffness", "add `stiffness = { linear = … }` in N/m"] {
        assert!(refused.stderr.contains(part), "{}", refused.stderr);
    }
    let line = format!("suggest gpr-mechanism {tilt} --stiffness linear=2e7,angular=5e3");
    let found = sandbox.json(&line);
    let sets = found["sets"].as_array().unwrap();
    let energies: Vec<f64> = sets.iter().map(|set| set["energy_mj"].as_f64().unwrap()).collect();
    assert!(
        energies.len() > 3 && energies.is_sorted_by(|a, b| *a <= b * (1.0 + 2e-6)),
        "{energies:?}"
    );
    assert!(energies[0] >= found["lower_bound_mj"].as_f64().unwrap() * (1.0 - 1e-6));
    // One slide of each leg: ½ Σ k x² of the displacements of the only command.
    let joints = sets[0]["virtual_joints"].as_array().unwrap();
    let energy: f64 = joints
        .iter()
        .map(|joint| {
            let si = if joint["unit"] == "um" { 1e-6 } else { 1e-3 };
            let x = joint["largest"].as_f64().unwrap() * si;
            0.5 * joint["stiffness"].as_f64().unwrap() * x * x
        })
        .sum();
    assert!((energy * 1e3 / energies[0] - 1.0).abs() < 1e-9, "{energy} {energies:?}");
    assert!(sandbox.done(&line).contains("1. energy "));
    for (options, message) in [
        ("--rank stiffness --stiffness linear=0", "linear stiffness must be positive, got 0"),
        ("--rank stiffness --stiffness 5", "expected linear=K or angular=K"),
        ("--rank stiffness --stiffness linear=1,linear=2", "linear stiffness is given twice"),
        ("--stiffness linear=1", "--stiffness needs --rank stiffness"),
    ] {
        let run = sandbox.run(&format!("suggest gpr-mechanism {options}"));
        assert_eq!(run.code, 2, "{options}");
        assert!(run.stderr.contains(message), "{}", run.stderr);
    }
}

#[test]
fn parameters_of_robot_files_are_set() {
    let sandbox = Sandbox::new();
    let robot = sandbox.done("catalogue show gpr");
    let text = robot.replace("socket_radius_mm = 93.218", "socket_radius_mm = \"r\"");
    sandbox.write("own.toml", &format!("{text}\n[parameters]\nr = 93.218\n"));
    for command in ["inverse", "forward", "mobility", "sensitivity", "compare"] {
        let arguments = match command {
            "forward" => "--q-mm 500,501,502",
            "inverse" | "sensitivity" => "--tilt-deg 1",
            _ => "",
        };
        let of = |robot: &str| sandbox.json(&format!("{command} {arguments} {robot}"));
        let plain = of("");
        assert_eq!(of("--robot own.toml"), plain, "{command}");
        if command != "mobility" {
            assert_ne!(of("--robot own.toml --set r=120"), plain, "{command}");
        }
    }
    // The rod under a socket at radius r rises by r tan α toward the tilt.
    let rods = sandbox.json("inverse --tilt-deg 1 --robot own.toml --set r=120");
    let rod = rods["q_mm"][0].as_f64().unwrap();
    let expected = 500.0 - 120.0 * 1.0_f64.to_radians().tan();
    assert!((rod - expected).abs() < 1e-6, "{rod} {expected}");
    for (line, message) in [
        ("inverse --tilt-deg 1 --set r=120", "--set needs a file"),
        ("inverse --tilt-deg 1 --robot own.toml --set q=120", "q"),
    ] {
        let run = sandbox.run(line);
        assert_eq!(run.code, 2, "{line}");
        assert!(run.stderr.contains(message), "{}", run.stderr);
    }
}

#[test]
fn a_suggestion_is_written_into_the_file() {
    let sandbox = Sandbox::new();
    let tilt = "--command \"rod 1=2,rod 2=0,rod 3=-1\"";
    let text = sandbox.done("catalogue show gpr-mechanism");
    sandbox.write("own.toml", &text);
    let line = format!("suggest own.toml {tilt}");
    let report = sandbox.json(&format!("{line} --write 2 --out with-play.toml"));
    assert_eq!(report["written"]["set"], 2);
    assert_eq!(
        (&report["written"]["file"], &report["written"]["replaced"]),
        (&"with-play.toml".into(), &3.into())
    );
    let written = sandbox.read("with-play.toml");
    let kept = text.split_once("[[virtual_joint]]").unwrap().0;
    assert!(written.starts_with(kept.trim_end()), "{written}");
    // The command needs the displacement that was stated.
    let relief = sandbox.json(&format!("sensitivity with-play.toml {tilt}"));
    let stated = report["sets"][1]["size_mm"].as_f64().unwrap();
    assert!((relief["size"].as_f64().unwrap() / (stated * 1e3) - 1.0).abs() < 1e-7);
    // Files are replaced only on request.
    for (line, words) in [
        (format!("{line} --write 1 --out with-play.toml"), "use --force"),
        (format!("{line} --write 1"), "has 3 virtual joints, which --write replaces"),
        (format!("suggest gpr-mechanism {tilt} --write 1"), "use --out FILE"),
        (format!("{line} --write 100000 --out other.toml"), "--write must be from 1 to"),
        (format!("{line} --out other.toml"), "--write"),
    ] {
        let run = sandbox.run(&line);
        assert_eq!(run.code, 2, "{line}");
        assert!(run.stderr.contains(words), "{line}: {}", run.stderr);
    }
    assert_eq!(sandbox.read("own.toml"), text);
    let none = sandbox.run("suggest 3-rps --write 1 --out other.toml");
    assert_eq!(none.code, 1, "{}", none.stderr);
    assert!(!sandbox.file("other.toml").exists());
    sandbox.done(&format!("{line} --write 1 --force"));
    assert!(sandbox.read("own.toml").contains("slide of platform at S1"));
}

/// Each set states what it allows besides the commands, and clearances count.
#[test]
fn a_suggestion_states_what_it_makes_possible() {
    let sandbox = Sandbox::new();
    let tilt = "--command \"rod 1=2,rod 2=0,rod 3=-1\"";
    let text = sandbox.done("catalogue show gpr-mechanism");
    let bare = text.split_once("[[virtual_joint]]").unwrap().0;
    let with = |name: &str, clearance: &str| {
        let joint = format!("name = \"S1\"\nclearance = {{ linear = {clearance} }}");
        sandbox.write(name, &bare.replace("name = \"S1\"", &joint));
    };
    with("wide.toml", "1");
    let report = sandbox.json(&format!("suggest wide.toml {tilt}"));
    let best = &report["sets"][0];
    assert_eq!(best["within_limits"], true);
    // Two slides along the principal directions allow this tilt only; with more of them each rod moves by itself.
    let single = |set: &serde_json::Value| set["single_commands"].as_array().unwrap().clone();
    assert_eq!(best["virtual_joints"].as_array().unwrap().len(), 2);
    assert!(single(best).iter().all(|one| one["by"] == 2.0 && one["size_mm"].is_null()));
    let listed = &report["sets"].as_array().unwrap()[..10];
    let whole = listed.iter().find(|set| single(set).iter().all(|one| !one["size_mm"].is_null()));
    let alone = sandbox.json("suggest wide.toml --command \"rod 1=2,rod 2=0,rod 3=0\"");
    let bound = alone["lower_bound_mm"].as_f64().unwrap();
    for one in single(whole.unwrap()) {
        assert!(one["size_mm"].as_f64().unwrap() >= bound * (1.0 - 1e-6), "{one}");
    }
    with("tight.toml", "1e-9");
    let tight = sandbox.json(&format!("suggest tight.toml {tilt}"));
    let exceeds = |set: &serde_json::Value| {
        let joints = set["virtual_joints"].as_array().unwrap();
        joints.iter().any(|one| one["exceeds_clearance"] == true)
    };
    let sets = tight["sets"].as_array().unwrap();
    let first = sets.iter().position(exceeds).unwrap();
    assert!(sets[first..].iter().all(exceeds));
}

#[test]
fn redundant_constraints_are_described() {
    let sandbox = Sandbox::new();
    let text = sandbox.done("mobility four-bar");
    for words in [
        "overconstrained and movable",
        "redundant constraints (sparsest basis of the self-stresses)",
        ". moment about x, transmitted by A, B, C, D",
        "  in all self-stresses: A, B, C, D",
    ] {
        assert!(text.contains(words), "{text}");
    }
    // The balls of the three-rod robot press against each other in pairs.
    let found = sandbox.json("mobility gpr-mechanism");
    assert_eq!(found["redundant_constraint_basis"]["sparsest"], true);
    let all = found["redundant_constraints"].as_array().unwrap();
    assert_eq!(all.len(), 3);
    let first = &all[0];
    assert_eq!(first["what"], "S1 against S2 along their line, through rod 1, rod 2");
    for one in all {
        assert_eq!((&one["group"], &one["independent"]), (&1.into(), &true.into()));
    }
    // 1 N along the line of the balls, with no moment about a ball.
    for load in first["remove_any_one_of"].as_array().unwrap() {
        let norm = |key: &str| {
            let part = load[key].as_array().unwrap();
            part.iter().map(|x| x.as_f64().unwrap().powi(2)).sum::<f64>().sqrt()
        };
        assert!((norm("force_n") - 1.0).abs() < 1e-9 && norm("moment_nmm") < 1e-6, "{load}");
    }
}

/// A spindle that lifts a guided ram by its thread: the coupling is a constraint of its own.
#[test]
fn couplings_are_counted_and_suggested_about() {
    let sandbox = Sandbox::new();
    let text = r#"kind = "mechanism"
name = "press"
units = { length = "mm", angle = "deg" }
base = "frame"
joint = [
  { name = "spindle", kind = "revolute", links = ["frame", "spindle"], point = [0, 0, 0], axis = [0, 0, 1], actuated = true },
  { name = "nut", kind = "cylindrical", links = ["spindle", "ram"], point = [0, 0, 0], axis = [0, 0, 1] },
  { name = "guide", kind = "prismatic", links = ["frame", "ram"], axis = [0, 0, 1] },
]
coupling = [{ name = "thread", coordinate = "nut[0]", terms = [{ coordinate = "nut[1]", ratio = "5 / 360" }] }]
"#;
    sandbox.write("press.toml", text);
    let shown = sandbox.done("mobility press.toml");
    assert!(
        shown.contains("\n  loops                  1\n  couplings              1\n"),
        "{shown}"
    );
    let found = sandbox.json("mobility press.toml");
    assert_eq!(
        (&found["couplings"], &found["rank"], &found["redundancy"]),
        (&1.into(), &3.into(), &4.into())
    );
    assert!(sandbox.json("mobility four-bar")["couplings"].is_null());
    let run = sandbox.run("export press.toml --to sdf");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stdout.contains(".sdf"), "{}", run.stdout);
    // Without the guide there is no loop, but the thread constrains.
    let open = text.replace("  { name = \"guide\", kind = \"prismatic\", links = [\"frame\", \"ram\"], axis = [0, 0, 1] },\n", "");
    sandbox.write("press.toml", &open);
    let found = sandbox.json("suggest press.toml --command \"nut[1] = 72\"");
    assert_eq!(found["open_chain"], false);
}

#[test]
fn redundant_couplings_are_removed_and_not_released() {
    let sandbox = Sandbox::new();
    let wheel = |name: &str, actuated: bool| {
        format!(
            "[[joint]]\nname = {name:?}\nkind = \"revolute\"\nlinks = [\"frame\", \"wheel {name}\"]\npoint = [0, 0, 0]\naxis = [0, 0, 1]\nactuated = {actuated}\n"
        )
    };
    let gear = |name: &str, follower: &str, leader: &str, ratio: f64| {
        format!(
            "[[coupling]]\nname = {name:?}\ncoordinate = {follower:?}\nterms = [{{ coordinate = {leader:?}, ratio = {ratio} }}]\n"
        )
    };
    let head = "kind = \"mechanism\"\nname = \"ring\"\nunits = { length = \"mm\", angle = \"deg\" }\nbase = \"frame\"\n";
    let text = [
        head.to_owned(),
        wheel("A", true),
        wheel("B", true),
        wheel("C", false),
        gear("AB", "B", "A", -2.0),
        gear("BC", "C", "B", -0.5),
        gear("CA", "A", "C", 1.0),
    ];
    sandbox.write("ring.toml", &text.concat());
    let text = sandbox.done("mobility ring.toml");
    for words in [
        "forces of couplings alone, transmitted by couplings AB, BC, CA",
        "  to remove one: remove any one of its couplings\n",
        "  couplings in all self-stresses: AB, BC, CA\n",
    ] {
        assert!(text.contains(words), "{text}");
    }
    assert!(!text.contains("release"), "{text}");
    // Both motors are of one train: play at joints makes no difference.
    let run = sandbox.run("suggest ring.toml");
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stderr.contains("contradict couplings \"AB\""), "{}", run.stderr);
    assert!(!run.stderr.contains("virtual joints"), "{}", run.stderr);
}

/// Self-stresses at an angle of less than a milliradian, where the dimensions miss a redundancy by little.
#[test]
fn nearly_equal_redundant_constraints_are_listed_once() {
    let sandbox = Sandbox::new();
    let found = sandbox.json("mobility bennett-network --set b=0.110055 --tolerance 1e-2");
    let groups = found["redundant_constraints"].as_array().unwrap().clone();
    assert!(groups.len() <= found["redundancy"].as_u64().unwrap() as usize, "{groups:?}");
}

/// A lead screw, and two motors that a gear joins: what a coupling determines is not held.
#[test]
fn coupled_actuators_move_together() {
    let sandbox = Sandbox::new();
    let screw = joint("nut", "cylindrical", ["ground", "carriage"], [0.0; 3], Z);
    let thread = "\n[[coupling]]\nname = \"thread\"\ncoordinate = \"nut[0]\"\nterms = [{ coordinate = \"nut[1]\", ratio = \"5 / 360\" }]\n";
    sandbox.write("screw.toml", &format!("{HEAD}{screw}actuated = true\n{thread}"));
    let found = sandbox.json("move screw.toml --drive nut[0]=0:10 --steps 2");
    let turned = found["series"]["nut[1]_deg"][2].as_f64().unwrap();
    assert!((turned - 720.0).abs() < 1e-9, "{found}");
    sandbox.done("move screw.toml");

    let motor = |name| {
        let wheel = format!("wheel {name}");
        joint(name, "revolute", ["ground", &wheel], [0.0; 3], Z) + "actuated = true\n"
    };
    let motors = ["a", "b", "c"].map(motor).concat();
    let gear = "\n[[coupling]]\nname = \"gear\"\ncoordinate = \"b\"\nterms = [{ coordinate = \"a\", ratio = -2 }]\n";
    sandbox.write("gear.toml", &format!("{HEAD}{motors}{gear}"));
    let found = sandbox.json("move gear.toml --drive a=0:10 --steps 2");
    let last = |name: &str| found["series"][name][2].as_f64().unwrap();
    assert!((last("b_deg") + 20.0).abs() < 1e-9 && last("c_deg") == 0.0, "{found}");
    assert_eq!(found["held"], serde_json::json!(["c"]));
}

/// More coordinates than dense algebra takes.
#[test]
fn sparse_algebra_names_a_contradicted_coupling() {
    let hinge = |k: usize| {
        let link = format!("l{k}");
        joint(&format!("j{k}"), "revolute", ["ground", &link], [0.0; 3], Z)
    };
    let hinges: String = (0..250).map(hinge).collect();
    let gear = "\n[[coupling]]\nname = \"gear\"\ncoordinate = \"j1\"\nterms = [{ coordinate = \"j0\", ratio = 1 }]\n";
    let file = format!("{HEAD}{hinges}{gear}");
    refused(&file, "assemble test.toml --at j0=10,j1=12", 1, "contradict coupling \"gear\"");
    let many = (1..100)
        .map(|k| format!("{{ coordinate = \"j{k}\", ratio = 1 }}"))
        .collect::<Vec<_>>()
        .join(", ");
    let sum = format!("\n[[coupling]]\nname = \"sum\"\ncoordinate = \"j0\"\nterms = [{many}]\n");
    let file = format!("{HEAD}{hinges}{sum}");
    refused(&file, "mobility test.toml", 2, "relates 100 coordinates, but at most 64 are allowed");
}

/// A limit with one end: the default range starts on the limit, where a coupling leaves the closed configuration below it.
#[test]
fn the_default_range_of_a_motion_is_within_the_limits() {
    let sandbox = Sandbox::new();
    let slide = |name: &str, limits| {
        let slide = joint(name, "prismatic", ["ground", &format!("slide {name}")], [0.0; 3], Z);
        format!("{slide}limits = {limits}\n")
    };
    let [p, q] = [slide("p", "[5, inf]"), slide("q", "[0, 1]")];
    let equal = "\n[[coupling]]\nname = \"equal\"\ncoordinate = \"q\"\nterms = [{ coordinate = \"p\", ratio = 1 }]\n";
    sandbox.write("test.toml", &format!("{HEAD}{p}actuated = true\n{q}{equal}"));
    let run = sandbox.run("move test.toml --format json");
    // q is beyond its limits everywhere: the answer is no, with the motion.
    assert_eq!(run.code, 1);
    let found: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let driven = found["series"]["p_mm"].as_array().unwrap();
    assert_eq!(driven[0].as_f64(), Some(5.0), "{}", run.stdout);
    assert!(driven.iter().all(|one| one.as_f64().unwrap() >= 5.0), "{}", run.stdout);
}

/// Rigid links allow the motion, so that the play at rest and all angles are those of the linkage without play; at a thousandth of the size too.
#[test]
fn a_linkage_with_play_in_one_step_moves_as_without_play_at_any_size() {
    let sandbox = Sandbox::new();
    let sarrus = sandbox.done("catalogue show sarrus");
    let mut play = String::new();
    for joint in ["B2", "B3"] {
        for (name, slide) in [("x", [1, 0, 0]), ("y", [0, 1, 0]), ("z", [0, 0, 1])] {
            play += &format!(
                "\n[[virtual_joint]]\nname = \"{joint} {name}\"\njoint = \"{joint}\"\nslide = {slide:?}\n"
            );
        }
    }
    let drive = "--drive A1=0:8 --steps";
    let rigid = sandbox.json(&format!("move sarrus {drive} 40"));
    let last = |found: &serde_json::Value, name: &str| {
        found["series"][name].as_array().unwrap().last().unwrap().as_f64().unwrap()
    };
    for unit in ["m", "mm", "um"] {
        let units = format!("length = \"{unit}\"");
        let text = sarrus.replace("length = \"m\"", &units).replace("length = \"mm\"", &units);
        sandbox.write("play.toml", &format!("{text}{play}"));
        for steps in [1, 3, 40] {
            let found = sandbox.json(&format!("move play.toml {drive} {steps}"));
            for joint in ["A1", "A2", "A3", "B1", "B2", "B3"] {
                let name = format!("{joint}_deg");
                let off = (last(&found, &name) - last(&rigid, &name)).abs();
                assert!(off < 1e-5, "{unit}, {steps} steps: {joint} by {off}");
            }
        }
    }
}

/// Three parallel cranks, the third longer by e: rigid links nearly close at every angle and exactly only where they are flat, far from the guess. Play takes up e along the crank, in closed form.
#[test]
fn a_crank_that_is_too_long_needs_its_excess_as_play_at_every_angle() {
    let excess = 0.001;
    let sandbox = Sandbox::new();
    sandbox.write("cranks.toml", &cranks_in_inches(excess, true));
    for angle in [0.0, 5.0, 10.0, 20.0, 45.0, 60.0, 80.0, 100.0, 120.0, -20.0, -90.0_f64] {
        let found = sandbox.json(&format!("mobility cranks.toml --at A0={angle}"));
        let direction = (40.0 + angle).to_radians();
        for (name, expected) in [("play x", direction.cos()), ("play y", direction.sin())] {
            let play = found["virtual_joints"][name].as_f64().unwrap();
            // The other cranks may turn by a small angle, which changes the play by its square.
            assert!((play - excess * expected).abs() < 1e-3 * excess, "{angle}: {found}");
        }
    }
    // Without a command too, and not where the links close exactly.
    let found = sandbox.json("assemble cranks.toml");
    assert!(found["coordinates"]["A1"].as_f64().unwrap().abs() < 0.1, "{found}");
}

/// Three parallel cranks of 2 in, the third longer by an excess (in), with or without play at it.
fn cranks_in_inches(excess: f64, has_play: bool) -> String {
    let [bx, by] = [40.0_f64.to_radians().cos(), 40.0_f64.to_radians().sin()];
    let mut file = HEAD.replace("\"mm\"", "\"in\"");
    let bases = [[0.0, 0.0], [3.0, 0.0], [7.0, 1.0]];
    for (k, [x, y]) in bases.into_iter().enumerate() {
        let crank = format!("crank {k}");
        file += &joint(&format!("A{k}"), "revolute", ["ground", &crank], [x, y, 0.0], Z);
        file += if k == 0 { "actuated = true\n" } else { "" };
        let tip = |length: f64| [x + length * bx, y + length * by, 0.0];
        if k < 2 {
            file += &joint(&format!("B{k}"), "revolute", [&crank, "table"], tip(2.0), Z);
        } else {
            let [on_crank, on_table] = [tip(2.0 + excess), tip(2.0)];
            file += &format!(
                "[[joint]]\nname = \"B2\"\nkind = \"revolute\"\nlinks = [\"crank 2\", \"table\"]\nframes = [{{ point = {on_crank:?}, axis = [0, 0, 1] }}, {{ point = {on_table:?}, axis = [0, 0, 1] }}]\n"
            );
        }
    }
    for (name, slide) in [("x", "[1, 0, 0]"), ("y", "[0, 1, 0]")].into_iter().filter(|_| has_play) {
        file += &format!(
            "[[virtual_joint]]\nname = \"play {name}\"\njoint = \"B2\"\nslide = {slide}\nclearance = 0.0015\n"
        );
    }
    file
}

/// A suggested set, written into the file, needs the same displacement at the same command: both are counted from the near miss at the guess, where the links close to their rounding or exactly only far away.
#[test]
fn suggestions_and_commands_start_from_one_configuration() {
    let sandbox = Sandbox::new();
    let bennett = sandbox.done("catalogue show bennett");
    let rounded = |b: &str| bennett.replace("b = 0.11\n", &format!("b = {b}\n"));
    let cases = [
        (rounded("0.1101"), "J1=50"),
        (rounded("0.11003"), "J1=60"),
        (rounded("0.1100001"), "J1=54"),
        (cranks_in_inches(0.001, false), "A0=3"),
        (cranks_in_inches(0.001, true), "A0=-10"),
    ];
    for (text, command) in cases {
        sandbox.write("links.toml", &text);
        for set in [1, 3] {
            let line = format!("suggest links.toml --command {command} --write {set}");
            let found = sandbox.json(&format!("{line} --out play.toml --force"));
            let least = found["sets"][set - 1]["size_mm"].as_f64().unwrap();
            // Play of the size of the inaccuracy, and not of a far configuration.
            assert!(least < 0.2, "{command}: {least}");
            let closed = sandbox.json(&format!("sensitivity play.toml --command {command}"));
            let unit = match closed["size_unit"].as_str().unwrap() {
                "um" => 1e-3,
                "mil" => 0.0254,
                unit => panic!("{unit}"),
            };
            let size = unit * closed["size"].as_f64().unwrap();
            assert!((size / least - 1.0).abs() < 1e-6, "{command}, set {set}: {size} {least}");
        }
    }
}
