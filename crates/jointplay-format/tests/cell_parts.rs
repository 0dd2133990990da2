//! Parameters, templates, patterns and parts of cell files.

use jointplay_cell::workcell::{Cell, ParentFrame};
use jointplay_format::cell::{self, EXAMPLE, Errors, expand, read, read_with};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;

fn no_files(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("there is no {name}"))
}

const HEAD: &str = "kind = \"cell\"
name = \"Test\"
robot = \"dual-arm\"
wafer = { diameter_mm = 300, thickness_mm = 0.775, material = \"silicon\" }
budgets = { virtual_joint_norm_um = 60, min_distance_mm = 1, slot_min_distance_mm = 1, plane_urad = 20 }
";

const STATION: &str = "
[[station]]
name = \"S\"
position_mm = [700, 0, 500]
heading_deg = -90
stroke = { below_mm = 4, above_mm = 3, speed_mm_s = 20 }
retract_mm = 10
";

fn cell_of(text: &str) -> Result<Cell, Errors> {
    read(&format!("{HEAD}{text}"), &mut no_files)
}

#[track_caller]
fn cell(text: &str) -> Cell {
    cell_of(text).unwrap_or_else(|errors| panic!("{}", errors.with_excerpt("x.toml")))
}

/// Checks a message and the text above its carets.
#[track_caller]
fn refused(text: &str, blamed: &str, message: &str) {
    let errors = cell_of(text).unwrap_err();
    let all = errors.with_excerpt("x.toml");
    let found = errors.iter().find(|error| error.to_string().contains(message));
    let place = &found.unwrap_or_else(|| panic!("{message:?} is not in\n{all}")).place;
    let above: String = place.text.chars().skip(place.column - 1).take(place.width).collect();
    assert_eq!(above, blamed, "{all}");
}

#[test]
fn every_number_can_be_an_expression_of_the_parameters() {
    let text = STATION.replace("[700, 0, 500]", "[\"reach\", 0, \"2 * level\"]")
        + "slots = \"count - 1\"\npitch_mm = \"pitch\"\nprocess_s = \"max(1, 2)\"
[parameters]
reach = \"500 + pitch * 20\"
pitch = 10
level = 250
count = 4
";
    let found = cell(&text);
    let station = &found.stations[0];
    assert_eq!(station.base_from_station.translation.vector, Vector3::new(0.7, 0.0, 0.5));
    assert_eq!((station.slots, station.pitch, station.process_time), (3, 0.01, 2.0));
    let replaced = |values: &[(&str, f64)]| {
        let values: Vec<_> = values.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
        read_with(&format!("{HEAD}{text}"), &values, &mut no_files)
    };
    let moved = replaced(&[("level", 260.0), ("count", 9.0)]).unwrap();
    assert_eq!(moved.stations[0].base_from_station.translation.vector.z, 0.52);
    assert_eq!(moved.stations[0].slots, 8);
    let message = replaced(&[("levl", 1.0)]).unwrap_err().to_string();
    assert!(
        message.contains("parameter \"levl\" is not known (did you mean `level`?)"),
        "{message}"
    );
    let message = replaced(&[("count", 3.5)]).unwrap_err().to_string();
    assert!(message.contains("`slots` is 2.5, but has to be a whole number"), "{message}");
    let bad = |from: &str, to: &str, blamed: &str, message: &str| {
        assert!(text.contains(from));
        refused(&text.replace(from, to), blamed, message);
    };
    bad("2 * level", "2 * levl", "levl", "unknown name `levl` (did you mean `level`?)");
    bad("2 * level", "2 * ", "", "found the end");
    bad("pitch = 10", "pitch = \"reach\"", "\"reach\"", "in a circle");
    bad("max(1, 2)", "-1", "\"-1\"", "`process_s` is -1, but has to be 0 or more");
    bad("max(1, 2)", "1 / 0", "1 / 0", "has to be a finite number");
    bad("count - 1", "count / 8", "\"count / 8\"", "`slots` is 0.5");
}

#[test]
fn a_station_takes_keys_from_a_template_or_another_station_and_changes_some() {
    let text = format!(
        "{STATION}
[[station]]
name = \"T\"
like = \"S\"
position_mm = [0, 700, 500]
heading_deg = 0

[[station]]
name = \"U\"
like = \"T\"
slots = 5

[[template]]
name = \"rack\"
pitch_mm = 8

[[station]]
name = \"V\"
like = \"rack\"
slots = 5
position_mm = [0, 700, 500]
stroke = {{ below_mm = 4, above_mm = 3, speed_mm_s = 20 }}
retract_mm = 10
"
    );
    // A template of its own for the pitch that U lacks.
    refused(&text, "[[station]]", "the station \"U\" needs `pitch_mm`");
    let found = cell(&text.replace("like = \"T\"\nslots", "like = \"T\"\npitch_mm = 12\nslots"));
    let [s, t, u, v] = found.stations.as_slice() else { panic!() };
    assert_eq!(t.retract_reach, s.retract_reach);
    assert_eq!(t.base_from_station.translation.vector, Vector3::new(0.0, 0.7, 0.5));
    assert_eq!(u.base_from_station, t.base_from_station);
    assert_eq!((u.slots, u.pitch, v.slots, v.pitch), (5, 0.012, 5, 0.008));
    refused(&text.replace("like = \"S\"", "like = \"X\""), "\"X\"", "station or template \"X\"");
    refused(&text.replace("like = \"S\"", "like = \"U\""), "\"T\"", "T → U → T");
    refused(&text.replace("like = \"S\"", "like = 3"), "3", "has to be the name of another table");
}

#[test]
fn a_tilt_replaces_inherited_taught_points_and_a_shape_the_inherited_one() {
    let taught = "taught = { points_mm = [[800, 0, 500], [600, 0, 500.5], [700, 100, 500.25]] }";
    let text = format!(
        "{STATION}{taught}
[[station]]
name = \"T\"
like = \"S\"
tilt = {{ x_deg = 0.1 }}
[[body]]
name = \"a\"
box = {{ size_mm = [1, 2, 3] }}
[[body]]
name = \"b\"
like = \"a\"
cylinder = {{ radius_mm = 1, height_mm = 2 }}
"
    );
    let found = cell(&text);
    let tilt = |station: usize| {
        let normal = found.stations[station].base_from_station.rotation * Vector3::z();
        normal.z.acos().to_degrees()
    };
    assert!((tilt(0) - 0.1432).abs() < 1e-3 && (tilt(1) - 0.1).abs() < 1e-9, "{}", tilt(1));
    assert!(matches!(found.bodies[1].shape, jointplay_cell::geometry::Shape::Cylinder { .. }));
}

#[test]
fn patterns_number_names_and_move_positions() {
    let text = format!(
        "{}repeat = {{ count = 3, step_mm = [0, 0, \"2 * 10\"] }}
[[body]]
name = \"post\"
repeat = {{ count = 4 }}
position_mm = [\"900 * cos(90 * n)\", \"900 * sin(90 * n)\", 0]
heading_deg = \"90 * n\"
box = {{ size_mm = [\"n\", 10, 10] }}
",
        STATION
    );
    let found = cell(&text);
    let stations: Vec<(&str, f64)> = found
        .stations
        .iter()
        .map(|one| (one.name.as_str(), one.base_from_station.translation.vector.z))
        .collect();
    assert_eq!(stations, [("S1", 0.5), ("S2", 0.52), ("S3", 0.54)]);
    let posts: Vec<(&str, Vector3<f64>)> = found
        .bodies
        .iter()
        .map(|one| (one.name.as_str(), one.parent_from_shape.translation.vector))
        .collect();
    assert_eq!(posts.len(), 4);
    assert_eq!(posts[1], ("post2", Vector3::new(-0.9, 0.0, 0.0)));
    // An error in a pattern is reported once, at its place in the file.
    let negative = text.replace("size_mm = [\"n\", 10, 10]", "size_mm = [\"n\", -10, 10]");
    refused(&negative, "-10", "has to be positive");
    assert_eq!(cell_of(&negative).unwrap_err().len(), 1);
    refused(&text.replace("count = 3", "count = 401"), "401", "from 0 to 400");
    let many = text.replace("count = 4", "count = 401");
    assert_eq!(cell_of(&many).unwrap_err().len(), 1, "`n` is known nevertheless");
    refused(&text.replace("count = 3", "cont = 3"), "cont", "did you mean `count`?");
    let with_n = format!("{text}\n[parameters]\nn = 3\n");
    refused(
        &with_n,
        "{ count = 3, step_mm = [0, 0, \"2 * 10\"] }",
        "the parameter `n` hides the number of the copy",
    );
    let taught = "taught = { points_mm = [[800, 0, 500], [600, 0, 500.5], [700, 100, 500]] }\n";
    refused(
        &text.replace("repeat = { count = 3", &format!("{taught}repeat = {{ count = 3")),
        "[0, 0, \"2 * 10\"]",
        "the position follows from `taught`",
    );
}

#[test]
fn a_part_is_a_station_with_its_bodies_placed_in_one_table() {
    let port = "
[[part]]
part = \"foup\"
name = \"LP1\"
position_mm = [-700, 0, 500]
heading_deg = 90
retract_mm = 10
wafers = [1, 3]
wall_mm = 5
tilt = { y_deg = 0.2 }
";
    let found = cell(port);
    let station = &found.stations[0];
    assert_eq!((station.name.as_str(), station.slots, station.pitch), ("LP1", 25, 0.01));
    assert_eq!(found.occupied.iter().map(|slot| slot.slot).collect::<Vec<_>>(), [1, 3]);
    let [shell] = found.bodies.as_slice() else { panic!() };
    assert_eq!((shell.name.as_str(), shell.station), ("LP1-shell", Some(0)));
    // The volume of the shell: the outer box without the inner one, which is open at the front.
    let jointplay_cell::geometry::Shape::Boxes { boxes } = &shell.shape else { panic!() };
    let volume: f64 = boxes.iter().map(|one| one.volume()).sum();
    let expected = 0.350 * 0.335 * 0.300 - 0.340 * 0.330 * 0.290;
    assert!((volume - expected).abs() < 1e-12, "{volume} {expected}");
    // A pure translation and rotation of the station moves the bodies with it.
    let relative = station.base_from_station.inverse() * shell.parent_from_shape;
    assert!((relative.translation.vector - Vector3::new(0.0, 0.0125, 0.120)).norm() < 1e-12);
    let bad = |from: &str, to: &str, blamed: &str, message: &str| {
        assert!(port.contains(from));
        refused(&port.replace(from, to), blamed, message);
    };
    bad("\"foup\"", "\"foop\"", "\"foop\"", "part \"foop\" is not known (did you mean `foup`?)");
    bad("wall_mm = 5", "wal_mm = 5", "wal_mm", "did you mean `wall_mm`?");
    bad("wall_mm = 5", "wall_mm = -5", "-5", "`wall_mm` is -5, but has to be positive");
    bad("wall_mm = 5", "front_mm = 1e12", "\"foup\"", "\"foup\" has an error in line");
    bad("wall_mm = 5", "wall_mm = \"x\"", "x", "unknown name `x`");
    bad("retract_mm = 10\n", "", "[[part]]", "the station \"LP1\" needs `retract_mm`");
    bad("position_mm", "on = \"world\"\nposition_mm", "on", "unknown key `on`");
}

#[test]
fn parts_move_with_links_stations_and_effectors() {
    let text = format!(
        "{STATION}
[[part]]
part = \"blade\"
name = \"blade-A\"
on = {{ effector = \"A\" }}
[[part]]
part = \"slit-valve\"
name = \"SV\"
on = {{ station = \"S\" }}
position_mm = [0, -200, 5]
opening_width_mm = 380
[[part]]
part = \"dual-arm-bodies\"
name = \"robot\"
"
    );
    let found = cell(&text);
    let body = |name: &str| found.bodies.iter().find(|body| body.name == name).unwrap();
    let blade = body("blade-A-plate");
    assert_eq!(blade.parent, ParentFrame::Link { arm: 0, link: 3 });
    let middle = blade.parent_from_shape.translation.vector;
    // The middle of the blade of the example, whose plate is as large.
    assert!((middle - Vector3::new(0.28, -0.175, 0.0084)).norm() < 1e-12, "{middle}");
    let wall = body("SV-wall");
    assert_eq!((wall.parent, wall.station), (ParentFrame::World, Some(0)));
    let at = wall.parent_from_shape.translation.vector;
    assert!((at - Vector3::new(0.5, 0.0, 0.505)).norm() < 1e-12, "{at}");
    assert_eq!(body("robot-hub").parent, ParentFrame::Link { arm: 0, link: 0 });
    refused(&text.replace("effector = \"A\"", "effector = \"C\""), "\"C\"", "known: A, B");
    refused(
        &text.replace("name = \"robot\"", "name = \"robot\"\nheading_deg = 3"),
        "heading_deg",
        "unknown key `heading_deg`",
    );
    refused(
        &text.replace("name = \"SV\"", "name = \"blade-A\""),
        "\"blade-A\"",
        "frame \"blade-A\" is defined twice",
    );
}

#[test]
fn contacts_of_a_part_or_pattern_are_those_of_its_bodies() {
    let text = format!(
        "may_touch = [[\"robot\", \"pin\"]]\n{STATION}
[[body]]
name = \"pin\"
repeat = {{ count = 2 }}
box = {{ size_mm = [1, 1, 1] }}
[[part]]
part = \"dual-arm-bodies\"
name = \"robot\"
"
    );
    let found = cell(&text);
    assert_eq!(found.allowed_pairs.len(), 20);
    assert!(found.allowed_pairs.contains(&[2, 0]) && found.allowed_pairs.contains(&[11, 1]));
    refused(&text.replace("\"pin\"]]", "\"pn\"]]"), "\"pn\"", "body \"pn\" is not known");
}

#[test]
fn parts_can_be_files_and_their_errors_have_the_line_in_them() {
    let part = "kind = \"part\"\nname = \"bench\"\n[parameters]\nside_mm = 10\n[[body]]\nname = \"top\"\nbox = { size_mm = [\"side_mm\", 1, 1] }\n[[zone]]\nname = \"over\"\nrule = \"keep-out\"\nposition_mm = [0, 0, 50]\nbox = { size_mm = [9, 9, 9] }\n";
    let text = format!(
        "{HEAD}{STATION}[[part]]\npart = \"parts/bench.toml\"\nname = \"B\"\nposition_mm = [0, 0, 100]\nside_mm = 20\n"
    );
    let with = |part: &str| {
        read(&text, &mut |name| match name {
            "parts/bench.toml" => Ok(part.as_bytes().to_vec()),
            _ => Err("no such file".to_owned()),
        })
    };
    let found = with(part).unwrap();
    assert_eq!(found.bodies[0].name, "B-top");
    assert_eq!(found.zones[0].name, "B-over");
    let at = found.zones[0].base_from_shape.translation.vector;
    assert!((at - Vector3::new(0.0, 0.0, 0.15)).norm() < 1e-15);
    let damaged = |from: &str, to: &str, message: &str| {
        let errors = with(&part.replace(from, to)).unwrap_err();
        assert!(errors.to_string().contains(message), "{errors}");
        assert_eq!(errors[0].place.text, "part = \"parts/bench.toml\"");
    };
    damaged("size_mm", "sze_mm", "\"parts/bench.toml\" has an error in line 7");
    damaged("\"side_mm\"", "\"side\"", "line 7: unknown name `side` (did you mean `side_mm`?)");
    damaged("[[body]]", "[[body]", "has an error in line 5");
    damaged(
        "kind = \"part\"",
        "kind = \"cell\"",
        "has an error in line 1: kind \"cell\" is not known",
    );
    let outside = text.replace("parts/bench.toml", "../bench.toml");
    let errors = read(&outside, &mut no_files).unwrap_err();
    assert!(errors.to_string().contains("within the cell file's folder"), "{errors}");
}

#[test]
fn all_parts_of_the_library_are_valid_with_their_defaults_and_described() {
    for part in cell::parts() {
        let place = if part.is_station {
            "position_mm = [700, 0, 500]\nheading_deg = -90\nretract_mm = 10"
        } else {
            ""
        };
        let found =
            cell(&format!("{STATION}[[part]]\npart = \"{}\"\nname = \"P\"\n{place}\n", part.name));
        assert!(!found.bodies.is_empty() && !part.description.is_empty(), "{}", part.name);
        for parameter in &part.parameters {
            assert!(!parameter.meaning.is_empty(), "{} of {}", parameter.name, part.name);
        }
        // Every value that is given has an effect, or is an error.
        let meanings = part.text.split("[meaning]").nth(1).unwrap();
        let meanings = meanings.split("\n[").next().unwrap();
        assert_eq!(meanings.matches(" = ").count(), part.parameters.len(), "{}", part.name);
    }
}

#[test]
fn keys_of_a_station_are_known_to_parts() {
    let unknown = STATION.to_owned() + "zzz = 1\n";
    let message = cell_of(&unknown).unwrap_err().to_string();
    let known = message.split("known here: ").nth(1).unwrap();
    let part = "[[part]]\npart = \"foup\"\nname = \"P\"\nzzz = 1\n";
    let message = cell_of(part).unwrap_err().to_string();
    let line = message.lines().find(|line| line.contains("unknown key")).unwrap();
    let of_part: Vec<&str> = line.split("known here: ").nth(1).unwrap().split(", ").collect();
    for key in known.lines().next().unwrap().split(", ") {
        assert!(of_part.contains(&key), "{key} is not in {line}");
    }
}

#[test]
fn runaway_patterns_are_refused() {
    let text = format!(
        "{STATION}[[part]]\npart = \"wafer-rest\"\nname = \"P\"\nslots = 200\nrepeat = {{ count = 400 }}\nposition_mm = [700, 0, 500]\nretract_mm = 10\n"
    );
    refused(&text, "\"wafer-rest\"", "generate more than 4000 tables");
}

/// A cell with parameters, templates, patterns and parts.
fn generated(count: usize, reach: f64, wall: f64, step: f64) -> String {
    format!(
        "{HEAD}
may_touch = [[\"robot\", \"post\"]]
{STATION}
[parameters]
reach = {reach}
wall = {wall}
[[template]]
name = \"served\"
retract_mm = \"wall\"
[[part]]
part = \"dual-arm-bodies\"
name = \"robot\"
[[part]]
part = \"foup\"
name = \"LP\"
like = \"served\"
repeat = {{ count = {count} }}
position_mm = [\"reach * cos(30 * n)\", \"reach * sin(30 * n)\", 500]
heading_deg = \"30 * n - 90\"
wall_mm = \"wall\"
[[part]]
part = \"support-pads\"
name = \"pads\"
on = {{ effector = \"B\" }}
count = {count}
[[body]]
name = \"post\"
repeat = {{ count = {count}, step_mm = [{step}, 0, 0.1] }}
position_mm = [0, \"reach\", 0]
capsule = {{ from_mm = [0, 0, \"-wall\"], to_mm = [0, 0, 1], radius_mm = \"wall\" }}
[[frame]]
name = \"table\"
position_mm = [0, 0, \"wall\"]
tilt = {{ x_deg = 1 }}
[[zone]]
name = \"z\"
rule = \"keep-out\"
on = {{ frame = \"table\" }}
box = {{ size_mm = [1, 1, \"wall\"] }}
"
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn the_expanded_file_is_the_same_cell(
        count in 1_usize..5,
        reach in 600.0..800.0,
        wall in 1.0..20.0,
        step in -50.0..50.0,
    ) {
        let text = generated(count, reach, wall, step);
        let expanded = expand(&text, &[], &mut no_files).unwrap();
        prop_assert!(!expanded.contains("[[part]]") && !expanded.contains("reach"));
        let [cell, again] = [&text, &expanded].map(|text| {
            read(text, &mut no_files).unwrap_or_else(|errors| panic!("{errors}\n{text}"))
        });
        prop_assert_eq!(cell, again);
        prop_assert_eq!(&expand(&expanded, &[], &mut no_files).unwrap(), &expanded);
    }

    #[test]
    fn damaged_files_are_errors_or_cells_but_never_panics(
        cut in 0_usize..3000,
        length in 0_usize..40,
        insert in "[\\[\\]{}=\"a-z0-9 .\n*(-]{0,6}",
    ) {
        let mut text = generated(2, 700.0, 10.0, 5.0);
        let cut = cut.min(text.len());
        let end = (cut + length).min(text.len());
        text.replace_range(cut..end, &insert);
        for error in read(&text, &mut no_files).err().into_iter().flatten() {
            let _ = error.with_excerpt("x");
        }
    }
}

#[test]
fn the_example_expands_to_itself() {
    let expanded = expand(EXAMPLE, &[], &mut no_files).unwrap();
    let [cell, again] = [EXAMPLE, &expanded].map(|text| read(text, &mut no_files).unwrap());
    assert_eq!(cell, again);
}

/// The part of the reference that lists the library.
fn library() -> String {
    let mut text = String::new();
    for part in cell::parts() {
        let kind = if part.is_station { "a station" } else { "bodies" };
        text += &format!("### `{}`\n\n{} ({kind}).\n\n", part.name, part.description);
        text += "| parameter | default | meaning |\n| --- | --- | --- |\n";
        for parameter in &part.parameters {
            let cell::PartParameter { name, default, meaning } = parameter;
            text += &format!("| `{name}` | `{default}` | {meaning} |\n");
        }
        text += "\n";
    }
    text
}

#[test]
fn the_reference_lists_the_parts_of_the_library() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/reference/parts.md");
    let document = std::fs::read_to_string(path).unwrap();
    let (before, rest) = document.split_once("## Library\n\n").unwrap();
    let (_, after) = rest.split_once("## Part files\n").unwrap();
    let expected = format!("{before}## Library\n\n{}## Part files\n{after}", library());
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(path, &expected).unwrap();
    }
    assert!(
        std::fs::read_to_string(path).unwrap() == expected,
        "docs/reference/parts.md differs from the library; rewrite it by\n  INSTA_UPDATE=always cargo test -p jointplay-format --test all cell_parts"
    );
}

/// Height of the lowest point of the bodies of each station above the floor (m).
fn lowest_points(cell: &Cell) -> Vec<f64> {
    let lowest = |station: usize| {
        let bodies = cell.bodies.iter().filter(|body| body.station == Some(station));
        let heights = bodies.flat_map(|body| {
            let vertices = body.shape.surface().vertices;
            vertices.into_iter().map(|[x, y, z]| (body.parent_from_shape * Point3::new(x, y, z)).z)
        });
        heights.fold(f64::INFINITY, f64::min)
    };
    (0..cell.stations.len()).map(lowest).collect()
}

#[test]
fn stations_rest_on_the_floor() {
    // Levelling feet of 5 mm are omitted; LP2 and PM1 are inclined.
    let example = read(EXAMPLE, &mut no_files).unwrap();
    for (height, station) in lowest_points(&example).into_iter().zip(&example.stations) {
        assert!((0.0..0.009).contains(&height), "{}: {height} m", station.name);
    }
    for part in ["foup", "load-port", "aligner", "chamber", "wafer-rest"] {
        let placed = |floor: &str| {
            let text = format!(
                "[[part]]\npart = \"{part}\"\nname = \"P\"\nposition_mm = [700, 0, 650]\nretract_mm = 10\n{floor}"
            );
            lowest_points(&cell(&text))[0]
        };
        let height = placed("floor_mm = 650\n");
        assert!(height.abs() < 1e-12, "{part}: {height} m");
        assert!(placed("") > 0.2, "{part} has no pedestal by default");
    }
}
