//! Cell files: the example, errors with their places, and editing.

use jointplay_cell::check::{CheckOptions, Report, check};
use jointplay_cell::geometry::Shape;
use jointplay_cell::program::expand;
use jointplay_cell::robot::RODS;
use jointplay_cell::station::{Approach, Origin, SlotId, Stroke};
use jointplay_cell::trajectory::{TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::Tilt;
use jointplay_format::cell::{Change, EXAMPLE, Errors, MAX_TRIANGLES, Problem, read, set_station};
use jointplay_format::program;
use nalgebra::Vector3;
use proptest::prelude::*;

fn no_files(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("there is no {name}"))
}

fn problems(text: &str) -> Errors {
    read(text, &mut no_files).unwrap_err()
}

fn example() -> Cell {
    match read(EXAMPLE, &mut no_files) {
        Ok(cell) => cell,
        Err(problems) => {
            let messages = problems.iter().map(|problem| problem.with_excerpt("example.toml"));
            panic!("{}", messages.collect::<Vec<_>>().join("\n"))
        }
    }
}

#[test]
fn every_slot_of_the_example_is_within_reach_of_both_arms() {
    let cell = example();
    let home: Vec<f64> = cell.robot.axes.iter().map(|axis| axis.home).collect();
    for (index, station) in cell.stations.iter().enumerate() {
        for slot in 1..=station.slots {
            for &id in &station.effectors {
                let slot_id = SlotId { station: index, slot };
                let waypoints = cell
                    .waypoints(id, slot_id, &home)
                    .unwrap_or_else(|error| panic!("{} slot {slot} {id:?}: {error}", station.name));
                let mut near = home.clone();
                let places = [
                    &waypoints.retracted_below,
                    &waypoints.below,
                    &waypoints.resting,
                    &waypoints.above,
                    &waypoints.retracted_above,
                ];
                for (k, place) in places.into_iter().enumerate() {
                    let reached =
                        cell.compensated_inverse(id, place, k > 2, &near).unwrap_or_else(|error| {
                            panic!("{} slot {slot} place {k} {id:?}: {error}", station.name)
                        });
                    // An arm that extends and retracts along its own radius does not rotate.
                    if k > 0 {
                        assert!((reached.positions[RODS] - near[RODS]).abs() < 0.01, "{k} {slot}");
                    }
                    near = reached.positions;
                }
            }
        }
    }
}

#[test]
fn the_example_of_the_reference_is_a_valid_cell() {
    let document = include_str!("../../../docs/reference/cell-files.md");
    let text =
        document.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let cell = read(text, &mut no_files).unwrap();
    assert_eq!((cell.stations.len(), cell.occupied.len()), (1, 25));
}

const PROGRAM: &str = "HOME
TRANSFER LP1 SLOT 1 TO PM1 WITH A
TRANSFER PM1 TO LP2 SLOT 25 WITH B
HOME
";

/// Report on a short program in a cell.
fn checked(cell: &Cell) -> Report {
    let steps = expand(cell, &program::parse(PROGRAM).unwrap()).unwrap();
    check(
        cell,
        &plan_trajectory(cell, steps, &TrajectoryOptions::default()).unwrap(),
        &CheckOptions::default(),
    )
}

#[test]
fn the_example_has_no_violations_and_a_collision_names_the_wall() {
    let report = checked(&example());
    assert!(report.violations.is_empty(), "{:#?}", report.violations);
    let from = "position_mm = [100.0, -600.0, 500.0]";
    assert!(EXAMPLE.contains(from));
    let text = EXAMPLE.replacen(from, "position_mm = [100.0, -300.0, 500.0]", 1);
    let cell = read(&text, &mut no_files).unwrap();
    let report = checked(&cell);
    let hit = |name: &str| report.violations.iter().any(|one| one.describe(&cell).contains(name));
    assert!(hit("wall") && !hit("slit-above"), "{:#?}", report.violations);
}

/// Replaces a part of the example and checks an error message.
#[track_caller]
fn refuse(from: &str, to: &str, message: &str) {
    assert!(EXAMPLE.contains(from), "{from:?} is not in the file");
    let text = EXAMPLE.replacen(from, to, 1);
    let found = problems(&text);
    let line = EXAMPLE[..EXAMPLE.find(from).unwrap()].matches('\n').count() + 1;
    let last = line + to.matches('\n').count();
    let fits = |problem: &Problem| {
        (line..=last).contains(&problem.place.line) && problem.to_string().contains(message)
    };
    let messages: Vec<String> =
        found.iter().map(|problem| problem.with_excerpt("x.toml")).collect();
    assert!(found.iter().any(fits), "line {line}:\n{}", messages.join("\n"));
}

#[test]
fn a_file_of_another_kind_is_refused_for_its_kind_alone() {
    let mechanism = "kind = \"mechanism\"\nname = \"press\"\nbase = \"frame\"\n";
    let messages: Vec<String> = problems(mechanism).iter().map(ToString::to_string).collect();
    assert_eq!(messages, ["kind \"mechanism\" is not known; known: cell"]);
}

#[test]
fn errors_name_their_place_and_the_allowed_values() {
    refuse(
        "kind = \"cell\"",
        "kind = \"sell\"",
        "kind \"sell\" is not known (did you mean `cell`?)",
    );
    refuse(
        "robot = \"dual-arm\"",
        "robot = \"dual\"",
        "robot with arms \"dual\" is not known (did you mean `dual-arm`?); known: dual-arm, radial-arm, scara-3r, scara-4r, or a file ….toml",
    );
    refuse("robot = \"dual-arm\"", "robot = \"mine.toml\"", "there is no mine.toml");
    refuse("robot = \"dual-arm\"", "robot = \"../mine.toml\"", "within the cell file's folder");
    let plain = "\"gpr\" is a mechanism without arms; robots with arms: dual-arm, radial-arm";
    refuse("robot = \"dual-arm\"", "robot = \"gpr\"", plain);
    refuse(
        "diameter_mm = 300.0",
        "diameter_mm = -300.0",
        "`diameter_mm` is -300, but has to be positive",
    );
    refuse("diameter_mm = 300.0", "diameter_mm = nan", "`diameter_mm` is not a number");
    refuse(
        "diameter_mm = 300.0",
        "diameter = 300.0",
        "unknown key `diameter` (did you mean `diameter_mm`?)",
    );
    refuse(
        "diameter_mm = 300.0",
        "diameter_mm = \"300 mm\"",
        "column 5 of the expression: expected an operator or the end, found `mm`",
    );
    refuse("[wafer]", "[wafer]\nyoung = 3", "unknown key `young`");
    refuse("thickness_mm = 0.775", "thickness_mm = 50.0\n", "too thick: its thickness");
    refuse("material = \"silicon\"", "material = \"silicone\"", "did you mean `silicon`?");
    refuse("slots = 25", "slots = 25.5", "has to be a whole number");
    refuse("slots = 25", "slots = 0", "`slots` is 0, but has to be from 1 to 1000");
    refuse("wafers = \"all\"", "wafers = [3, 26]", "`wafers` is 26, but has to be from 1 to 25");
    refuse("wafers = \"all\"", "wafers = [3, 3]", "slot 3 is listed twice");
    // One error each, and none that follows from it.
    for (from, to, message) in [
        ("slots = 25", "slots = 1001", "`slots` is 1001, but has to be from 1 to 1000"),
        ("pitch_mm = 10.0", "pitch_mm = 0", "`pitch_mm` is 0, but has to be positive"),
        ("thickness_mm = 0.775", "thickness_mm = inf", "but has to be a finite number"),
    ] {
        let text = EXAMPLE.replacen(from, to, 1).replacen("wafers = \"all\"", "wafers = [2]", 1);
        let found: Vec<String> = problems(&text).iter().map(ToString::to_string).collect();
        assert!(found.len() == 1 && found[0].contains(message), "{found:?}");
    }
    refuse(
        "wafers = \"all\"",
        "wafers = [1, \"5-9\"]",
        "list the slots from 5 to 9 one by one, such as [1, 2, 5]",
    );
    refuse("wafers = \"all\"", "effectors = [\"C\"]", "effector \"C\" is not known; known: A, B");
    refuse("wafers = \"all\"", "approach = \"straight\"", "approach \"straight\" is not known");
    refuse("name = \"LP2\"", "name = \"LP1\"", "station \"LP1\" is defined twice");
    refuse("name = \"LP2\"", "name = \"load port\"", "a name is letters from a to z");
    refuse(
        "retract_mm = 10.0",
        "retract_mm = 800.0",
        "is only 700.036 mm from the first joint of the arm",
    );
    refuse(
        "angle_deg = 0.8",
        "angle_deg = 2.0",
        "tilts 2.000° toward 100.0°, but the robot tilts by at most 1.500°: level the station by at least 0.538°, 0.038° of which",
    );
    refuse("[600.0, 0.0, 619.83]", "[600.0, 0.0, 620.83]", "taught point 3 deviates most, by");
    refuse("rule = \"safe\"", "rule = \"save\"", "did you mean `safe`?");
    refuse("on = \"platform\"", "on = \"plattform\"", "did you mean `platform`?");
    refuse("{ arm = \"upper\", link = 2 }", "{ arm = \"upper\", link = 5 }", "from 1 to 4");
    refuse(
        "{ arm = \"upper\", link = 2 }",
        "{ arm = \"uper\", link = 2 }",
        "did you mean `upper`?",
    );
    refuse("{ station = \"LP2\" }", "{ station = \"LP3\" }", "station \"LP3\" is not known");
    refuse("{ station = \"LP2\" }", "{ station = \"LP2\", link = 1 }", "{ arm = …, link = … }");
    refuse("[\"base\", \"platform\"]", "[\"base\", \"platfrom\"]", "did you mean `platform`?");
    refuse("[\"base\", \"platform\"]", "[\"base\"]", "needs 2 bodies");
    refuse("virtual_joint_norm_um = 60.0", "play_mm = 0.06", "unknown key `play_mm`");
    refuse("virtual_joint_norm_um = 60.0", "virtual_joint_norm_um = 0.0", "has to be positive");
    refuse("[[zone]]", "[[zones]]", "unknown key `zones` (did you mean `zone`?)");
    refuse("tilt = {", "tilt = = {", "");
}

#[test]
fn rules_are_read_and_contradictory_ones_refused() {
    let rule = "[[rule]]\nname = \"align\"\nvisit = [\"ALIGN\"]\nbefore = [\"PM1\"]\nfrom = [\"LP1\"]\ntimes = 1\n";
    let text = EXAMPLE.replace("process_s = 8.0", "process_s = 8.0\nmax_dwell_s = 30.0") + rule;
    let cell = read(&text, &mut no_files).unwrap();
    let [limits] = cell.rules.dwell.as_slice() else { panic!("{:?}", cell.rules) };
    assert_eq!((limits.station, limits.min, limits.max), (3, 0.0, Some(30.0)));
    let [visit] = cell.rules.visits.as_slice() else { panic!("{:?}", cell.rules) };
    assert_eq!((&visit.stations, &visit.before, &visit.origins), (&vec![2], &vec![3], &vec![0]));
    assert_eq!(visit.count, Some(1));
    let budgets = "[budgets]";
    let with = |rule: &str| format!("{rule}\n{budgets}");
    let named = "[[rule]]\nname = \"r\"\n";
    refuse(budgets, &with("[[rule]]\nvisit = [\"PM1\"]"), "needs `name`");
    refuse(budgets, &with(named), "the rule \"r\" needs `visit`");
    refuse(budgets, &with(&format!("{named}visit = []")), "name one or more in `visit`");
    refuse(budgets, &with(&format!("{named}visit = [\"PM\"]")), "did you mean `PM1`?");
    let twice = format!("{named}visit = [\"PM1\"]\nbefore = [\"PM1\"]");
    refuse(budgets, &with(&twice), "requires a visit to PM1 before a visit to PM1");
    let circle = "[[rule]]\nname = \"s\"\nvisit = [\"ALIGN\"]\nbefore = [\"PM1\"]\n[[rule]]\nname = \"t\"\nvisit = [\"PM1\"]\nbefore = [\"ALIGN\"]";
    refuse(budgets, &with(circle), "requires a visit before itself");
    let short = "process_s = 8.0\nmax_dwell_s = 7.5";
    refuse("process_s = 8.0", short, "`process_s` requires a dwell of 8 s: increase");
    let reversed = "process_s = 2.0\nmin_dwell_s = 5.0\nmax_dwell_s = 4.0";
    refuse("process_s = 2.0", reversed, "`min_dwell_s` requires a dwell of 5 s");
}

#[test]
fn all_errors_are_reported_in_order_of_place() {
    let text = EXAMPLE
        .replace("thickness_mm = 0.775", "thickness_mm = -1")
        .replace("slots = 25", "slots = true")
        .replace("rule = \"safe\"", "rul = \"safe\"");
    let found = problems(&text);
    let lines: Vec<usize> = found.iter().map(|problem| problem.place.line).collect();
    assert!(lines.is_sorted(), "{lines:?}");
    let messages: Vec<String> = found.iter().map(ToString::to_string).collect();
    assert_eq!(
        messages.iter().filter(|one| one.contains("has to be a number")).count(),
        2,
        "{messages:#?}"
    );
    assert!(messages.iter().any(|one| one.contains("needs `rule`")), "{messages:#?}");
    assert!(messages.iter().any(|one| one.contains("unknown key `rul`")), "{messages:#?}");
}

#[test]
fn missing_keys_of_a_station_are_named() {
    let text = EXAMPLE.replace(
        "stroke = { below_mm = 4.0, above_mm = 3.0, speed_mm_s = 20.0 }",
        "stroke = { below_mm = 4.0 }",
    );
    let messages: Vec<String> = problems(&text).iter().map(ToString::to_string).collect();
    assert!(messages.contains(&"a stroke needs `above_mm`".to_owned()), "{messages:#?}");
    let text = EXAMPLE.replace("pitch_mm = 10.0", "");
    let messages: Vec<String> = problems(&text).iter().map(ToString::to_string).collect();
    assert!(messages.contains(&"the station \"LP1\" needs `pitch_mm`".to_owned()), "{messages:#?}");
}

/// The example with other lines in place of the position of LP1.
fn placed(lines: &str) -> Result<Cell, Errors> {
    let from = "position_mm = [-495.0, 495.0, 500.0]";
    assert!(EXAMPLE.contains(from));
    read(&EXAMPLE.replacen(from, lines, 1), &mut no_files)
}

#[test]
fn station_frames_follow_from_taught_points_or_carrier_axis() {
    let cell = placed(
        "carrier_axis = { first_mm = [-495.0, 495.0, 500.0], last_mm = [-493.0, 495.0, 739.99] }",
    )
    .unwrap();
    let Origin::CarrierAxis(carrier_axis) = &cell.stations[0].origin else { panic!() };
    assert!((carrier_axis.horizontal_offset - 0.002).abs() < 1e-15);
    assert!((carrier_axis.tilt.angle.tan() - 0.002 / 0.23999).abs() < 1e-12);
    let last = cell.stations[0].slot_frame(25).translation.vector;
    assert!((last - Vector3::new(-0.493, 0.495, 0.73999)).norm() < 1e-14, "{last}");
    let refused = |lines: &str| placed(lines).unwrap_err()[0].to_string();
    let message = refused(
        "carrier_axis = { first_mm = [-495.0, 495.0, 500.0], last_mm = [-495.0, 495.0, 750.0] }",
    );
    assert!(message.contains("but `pitch_mm` is 10"), "{message}");
    let message = refused(
        "carrier_axis = { first_mm = [-495.0, 495.0, 500.0], last_mm = [-495.0, 495.0, 400.0] }",
    );
    assert!(message.contains("it must be above it"), "{message}");
    let message = refused(
        "carrier_axis = { first_mm = [-495.0, 495.0, 500.0], last_mm = [-485.0, 495.0, 739.8] }",
    );
    assert!(message.contains("but the robot tilts by at most 1.500°"), "{message}");
    let position = "position_mm = [-495.0, 495.0, 500.0]\n";
    let taught = |points: &str| refused(&format!("{position}taught = {{ points_mm = {points} }}"));
    let message = taught("[[0, 0, 500], [1, 0, 500]]");
    assert!(message.contains("2 taught points determine no plane"), "{message}");
    let message = taught("[[0, 0, 500], [100, 0, 500], [200, 0, 500.001]]");
    assert!(message.contains("deviate from one line by 0.2 µm"), "{message}");
    let message = taught("[[0, 0, 500], [100, 0, 500], [0, 100, 503]]");
    assert!(message.contains("tilts 1.718° toward -90.0°"), "{message}");
    let message = refused(&format!(
        "{position}tilt = {{ azimuth_deg = 0, angle_deg = 1 }}\ntaught = {{ points_mm = [] }}"
    ));
    assert!(message.contains("has both `tilt` and `taught`"), "{message}");
}

/// A body of the shape of a file in place of the wall.
fn with_mesh(name: &str, bytes: &[u8], options: &str) -> Result<Shape, String> {
    let from = "box = { size_mm = [600.0, 20.0, 1000.0] }";
    let text = EXAMPLE.replacen(from, &format!("mesh = {{ file = \"{name}\"{options} }}"), 1);
    let mut files = |asked: &str| match asked == name {
        true => Ok(bytes.to_vec()),
        false => Err("no such file".to_owned()),
    };
    match read(&text, &mut files) {
        Ok(cell) => Ok(cell.bodies.into_iter().find(|body| body.name == "wall").unwrap().shape),
        Err(problems) => Err(problems[0].to_string()),
    }
}

const TETRAHEDRON_OBJ: &str = "mtllib none.mtl\nv 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 50\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// The first two of its triangles.
fn stl(header: &[u8], count: u32) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes[..header.len()].copy_from_slice(header);
    bytes.extend(count.to_le_bytes());
    for triangle in [
        [[0.0_f32, 0.0, 0.0], [0.0, 100.0, 0.0], [100.0, 0.0, 0.0]],
        [[0.0; 3], [100.0, 0.0, 0.0], [0.0, 0.0, 50.0]],
    ] {
        bytes.extend([0_u8; 12]);
        bytes.extend(triangle.iter().flatten().flat_map(|value| value.to_le_bytes()));
        bytes.extend([0_u8; 2]);
    }
    bytes
}

#[test]
fn shapes_are_read_from_stl_and_obj() {
    let tall = |shape: Shape| match shape {
        Shape::Mesh { vertices, triangles } => {
            (vertices.len(), triangles.len(), vertices.iter().map(|v| v[2]).fold(0.0, f64::max))
        }
        other => panic!("{other:?}"),
    };
    assert_eq!(tall(with_mesh("a/t.obj", TETRAHEDRON_OBJ.as_bytes(), "").unwrap()), (4, 4, 0.05));
    let in_m = with_mesh("t.OBJ", TETRAHEDRON_OBJ.as_bytes(), ", unit = \"m\"").unwrap();
    assert_eq!(tall(in_m), (4, 4, 50.0));
    assert_eq!(tall(with_mesh("t.stl", &stl(b"made by hand", 2), "").unwrap()), (4, 2, 0.05));
    // Many programs also write this at the start of binary files.
    assert_eq!(tall(with_mesh("t.stl", &stl(b"solid body", 2), "").unwrap()), (4, 2, 0.05));
    let text = "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 5\nendloop\nendfacet\nendsolid t\n";
    assert_eq!(tall(with_mesh("t.stl", text.as_bytes(), "").unwrap()), (3, 1, 0.005));
    let convex = with_mesh("t.obj", TETRAHEDRON_OBJ.as_bytes(), ", convex = true").unwrap();
    assert!(matches!(convex, Shape::Convex { points } if points.len() == 4));
}

#[test]
fn invalid_shapes_are_rejected() {
    #[track_caller]
    fn refuse(name: &str, bytes: &[u8], message: &str) {
        let found = with_mesh(name, bytes, "").unwrap_err();
        assert!(found.contains(message), "{found}");
    }
    refuse("t.stl", b"", "no STL file, or a broken one");
    refuse("t.stl", &stl(b"", 3), "bytes end before its triangles do");
    refuse("t.stl", &stl(b"", u32::MAX), "no STL file, or a broken one");
    refuse("t.stl", &stl(b"", 0), "it has no triangles");
    refuse("t.obj", b"", "it has no triangles");
    refuse("t.obj", b"v 0 0 0\nf 1 2 3\n", "no OBJ file, or a broken one");
    refuse("t.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not finite");
    refuse("t.step", b"", "convert it to .glb, .stl or .obj");
    refuse("../t.stl", b"", "within the cell file's folder");
    let mut many = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    many.push_str(&"f 1 2 3\n".repeat(MAX_TRIANGLES + 1));
    refuse("t.obj", many.as_bytes(), "more than 500000 triangles; simplify");
    assert!(
        with_mesh("t.obj", TETRAHEDRON_OBJ.as_bytes(), ", convex = 1")
            .unwrap_err()
            .contains("true or false")
    );
    let flat = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let message = with_mesh("t.obj", flat.as_bytes(), ", convex = true").unwrap_err();
    assert!(message.contains("lie in one plane"), "{message}");
}

#[test]
fn an_edit_changes_one_station_and_keeps_every_comment() {
    let changes = [
        Change::Position(Vector3::new(-0.4951, -0.495, 0.5)),
        Change::Tilt(Tilt { azimuth: 1.0_f64.to_radians(), angle: 0.4_f64.to_radians() }),
        Change::Retract(0.012),
        Change::ProcessTime(3.0),
    ];
    let text = set_station(EXAMPLE, "LP2", &changes).unwrap();
    let station = &read(&text, &mut no_files).unwrap().stations[1];
    assert_eq!(station.base_from_station.translation.vector.x, -0.4951);
    assert_eq!((station.retract_reach, station.process_time), (0.012, 3.0));
    let comments = |text: &str| -> Vec<String> {
        text.lines().filter(|line| line.contains('#')).map(str::to_owned).collect()
    };
    assert_eq!(comments(&text), comments(EXAMPLE));
    // Three lines changed, one is new.
    let old: Vec<&str> = EXAMPLE.lines().collect();
    let added: Vec<&str> = text.lines().filter(|line| !old.contains(line)).collect();
    assert_eq!(
        added,
        [
            "position_mm = [-495.1, -495.0, 500.0]",
            "tilt = { azimuth_deg = 1.0, angle_deg = 0.4 }",
            "retract_mm = 12.0",
            "process_s = 3.0"
        ]
    );
    assert_eq!(set_station(EXAMPLE, "LP2", &[]).unwrap(), EXAMPLE);
}

#[test]
fn an_edit_replaces_the_previous_definition_of_the_frame() {
    let of = |changes: &[Change]| {
        let text = set_station(EXAMPLE, "PM1", changes).unwrap();
        read(&text, &mut no_files).unwrap().stations[3].clone()
    };
    let taught = |z: f64| Change::Taught {
        points: vec![
            Vector3::new(0.8, 0.0, z),
            Vector3::new(0.7, 0.1, 0.62),
            Vector3::new(0.6, 0.0, 0.62),
        ],
        threshold: 5e-5,
        noise: None,
    };
    let carrier_axis = Change::CarrierAxis {
        first: Vector3::new(-0.495, 0.495, 0.5),
        last: Vector3::new(-0.494, 0.495, 0.74),
    };
    assert!(matches!(of(&[Change::Tilt(Tilt::LEVEL)]).origin, Origin::Nominal));
    let Origin::Taught(found) = of(&[taught(0.621)]).origin else { panic!() };
    assert_eq!(found.plane.unwrap().agreement.threshold, 5e-5);
    let text = set_station(EXAMPLE, "LP1", &[carrier_axis]).unwrap();
    assert!(matches!(
        read(&text, &mut no_files).unwrap().stations[0].origin,
        Origin::CarrierAxis(_)
    ));
    // The tilt replaces the carrier axis, and the position of the first slot remains.
    let text = set_station(&text, "LP1", &[Change::Tilt(Tilt::LEVEL)]).unwrap();
    let station = &read(&text, &mut no_files).unwrap().stations[0];
    assert_eq!(station.base_from_station.translation.vector, Vector3::new(-0.495, 0.495, 0.5));
    let text = set_station(
        EXAMPLE,
        "LP1",
        &[
            Change::Heading(0.5),
            Change::Pitch(0.011),
            Change::Offset(Vector3::new(0.001, 0.0, 0.0)),
            Change::Via(vec![Vector3::new(0.0, -0.3, 0.0)]),
            Change::Approach(Approach::Line),
            Change::Stroke(Stroke { below: 0.002, above: 0.0025, speed: 0.03 }),
        ],
    )
    .unwrap();
    let station = &read(&text, &mut no_files).unwrap().stations[0];
    assert_eq!(
        (station.pitch, station.offset, station.approach),
        (0.011, [0.001, 0.0, 0.0], Approach::Line)
    );
    assert_eq!(
        (station.via.as_slice(), station.stroke.above),
        ([[0.0, -0.3, 0.0]].as_slice(), 0.0025)
    );
}

#[test]
fn a_station_with_a_carrier_axis_is_moved_and_rotated_by_both_its_positions() {
    let table = "[[station]]
name = \"LP\"
[station.carrier_axis] # measured
first_mm = [-495.0, 495.0, 500.1] # by slot 1
last_mm = [-494.0, 494.3, 740.1] # by slot 25
";
    let moved = Change::Position(Vector3::new(-0.4951, 0.495, 0.5));
    assert_eq!(
        set_station(table, "LP", &[moved]).unwrap(),
        table
            .replace("[-495.0, 495.0, 500.1]", "[-495.1, 495.0, 500.0]")
            .replace("[-494.0, 494.3, 740.1]", "[-494.1, 494.3, 740.0]")
    );
    let inline = "[[station]]
name = \"LP\"
carrier_axis = { first_mm = [100, 0.1, 500], last_mm = [100, 0.1, 740] } # drifted
";
    let tilt = Tilt { azimuth: 0.0, angle: 0.01 };
    let turned = set_station(inline, "LP", &[Change::Turned(tilt)]).unwrap();
    let (sine, cosine) = tilt.angle.sin_cos();
    let place = |value: f64| (value * 1e9).round() / 1e9;
    let last = [100.0 + 240.0 * sine, 0.1, 500.0 + 240.0 * cosine].map(place);
    let expected = inline
        .replace("[100, 0.1, 500]", "[100.0, 0.1, 500.0]")
        .replace("[100, 0.1, 740]", &format!("{last:?}"));
    assert_eq!(turned, expected);
    // Without a carrier axis, `Turned` equals `Tilt`.
    let of = |change| set_station(EXAMPLE, "LP2", &[change]).unwrap();
    assert_eq!(of(Change::Turned(tilt)), of(Change::Tilt(tilt)));
}

#[test]
fn stations_in_an_inline_list_are_edited_in_place() {
    let text = "kind = \"cell\"
name = \"Two in a list\"
robot = \"dual-arm\"
wafer = { diameter_mm = 300, thickness_mm = 0.775, material = \"silicon\" }
budgets = { virtual_joint_norm_um = 60, min_distance_mm = 1, slot_min_distance_mm = 1, plane_urad = 20 }
station = [
    # The station that is not edited.
    { name = \"LP1\", position_mm = [-495.0, 495.0, 500.0], heading_deg = 45.0, stroke = { below_mm = 4, above_mm = 3, speed_mm_s = 20 }, retract_mm = 10.0 },
    { name = \"LP2\", carrier_axis = { first_mm = [-495, -495, 500], last_mm = [-494, -495, 740] }, slots = 25, heading_deg = 135.0, stroke = { below_mm = 4, above_mm = 3, speed_mm_s = 20 }, retract_mm = 10.0 }, # drifted
]
";
    let stations = |text: &str| {
        let found = read(text, &mut no_files);
        let fail = |problems: Errors| panic!("{}", problems[0].with_excerpt("x.toml"));
        found.unwrap_or_else(fail).stations
    };
    assert!(matches!(stations(text)[1].origin, Origin::CarrierAxis(_)));
    let changes = [Change::Position(Vector3::new(-0.49, 0.495, 0.5)), Change::ProcessTime(3.0)];
    let edited = set_station(text, "LP1", &changes).unwrap();
    let found = &stations(&edited)[0];
    assert_eq!((found.base_from_station.translation.vector.x, found.process_time), (-0.49, 3.0));
    // One line differs, in the usual notation.
    let old: Vec<&str> = text.lines().collect();
    let added: Vec<&str> = edited.lines().filter(|line| !old.contains(line)).collect();
    assert_eq!(added.len(), 1, "{added:?}");
    assert!(added[0].starts_with("    { name = \"LP1\", position_mm = [-490.0, 495.0, 500.0], "));
    assert!(added[0].ends_with(" retract_mm = 10.0, process_s = 3.0 },"), "{}", added[0]);
    let level = set_station(text, "LP2", &[Change::Tilt(Tilt::LEVEL)]).unwrap();
    let found = &stations(&level)[1];
    // The pitch remains that of the carrier axis.
    assert!(matches!(found.origin, Origin::Nominal) && (found.pitch - 0.01).abs() < 1e-6);
    assert!(level.contains(" # drifted\n]") && !level.contains("carrier_axis = "), "{level}");
    let message = set_station(text, "LP3", &[]).unwrap_err().to_string();
    assert!(message.contains("did you mean `LP2`?); known: LP1, LP2"), "{message}");
}

#[test]
fn an_edit_of_an_unknown_station_is_rejected() {
    let message = set_station(EXAMPLE, "LP3", &[]).unwrap_err().to_string();
    assert!(
        message.contains("station \"LP3\" is not known (did you mean `LP2`?); known: LP1, LP2"),
        "{message}"
    );
    assert!(set_station("x = = 1", "LP1", &[]).is_err());
    assert!(
        set_station("station = 3", "LP1", &[]).unwrap_err().to_string().contains("[[station]]")
    );
}

#[test]
fn long_texts_are_rejected_without_reading() {
    let message = problems(&" ".repeat(1_000_001))[0].to_string();
    assert!(message.contains("at most 1000000 are allowed"), "{message}");
    assert!(problems("").iter().any(|problem| problem.to_string() == "a cell needs `robot`"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]
    #[test]
    fn mutated_cell_files_do_not_panic(at in 0..EXAMPLE.len(), length in 0..40_usize, put in "[-0-9a-z_.=\"\\[\\]{}#\n ]{0,6}") {
        let start = EXAMPLE.floor_char_boundary(at);
        let end = EXAMPLE.floor_char_boundary((start + length).min(EXAMPLE.len()));
        let text = format!("{}{put}{}", &EXAMPLE[..start], &EXAMPLE[end..]);
        if let Err(problems) = read(&text, &mut no_files) {
            prop_assert!(!problems.is_empty());
            for problem in problems {
                let _ = problem.with_excerpt("x.toml");
            }
        }
        let _ = set_station(&text, "LP1", &[Change::Heading(0.5)]);
    }
}
