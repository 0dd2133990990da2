//! Edits of stations that come from parts, templates and patterns.

use jointplay_cell::station::{Origin, Station};
use jointplay_core::spatial::Tilt;
use jointplay_format::cell::{Change, TaughtNoise, note_station, read, set_station};
use nalgebra::Vector3;

const TEXT: &str = "kind = \"cell\"
name = \"Test\"
robot = \"dual-arm\"
wafer = { diameter_mm = 300, thickness_mm = 0.775, material = \"silicon\" }
budgets = { virtual_joint_norm_um = 60, min_distance_mm = 1, slot_min_distance_mm = 1, plane_urad = 20 }

[parameters]
reach = 700

[[template]]
name = \"port\"
slots = 5
pitch_mm = 10
stroke = { below_mm = 4, above_mm = 3, speed_mm_s = 20 }
retract_mm = 10

# The first port.
[[station]]
name = \"P1\"
like = \"port\"
carrier_axis = { first_mm = [0, 700, 500], last_mm = [0.1, 700, 540] } # measured

[[station]]
name = \"P2\"
like = \"P1\"

[[station]]
name = \"P3\"
like = \"port\"
position_mm = [\"-reach\", 0, 500]
heading_deg = 90

[[part]]
part = \"load-port\"
name = \"LP\"
position_mm = [0, -700, 500]
heading_deg = 180
retract_mm = 10
taught = { points_mm = [[0, -800, 500], [100, -700, 500.1], [-100, -700, 499.9], [0, -600, 500]], noise_um = 2 }

[[part]]
part = \"slit-valve\"
name = \"SV\"
on = { station = \"LP\" }
position_mm = [0, -300, 0]

[[part]]
part = \"chamber\"
name = \"CH\"
repeat = { count = 2 }
position_mm = [\"-700 + 1400 * (n - 1)\", 0, 700]
heading_deg = \"90 - 180 * (n - 1)\"
retract_mm = 10
";

fn station(text: &str, name: &str) -> Station {
    let cell = read(text, &mut |name| Err(format!("there is no {name}")));
    let cell = cell.unwrap_or_else(|errors| panic!("{}", errors.with_excerpt("x.toml")));
    cell.stations.into_iter().find(|station| station.name == name).unwrap()
}

fn place(text: &str, name: &str) -> Vector3<f64> {
    station(text, name).base_from_station.translation.vector
}

fn tilt(text: &str, name: &str) -> f64 {
    let normal = station(text, name).base_from_station.rotation * Vector3::z();
    Tilt::from_normal(&normal).angle
}

/// All other stations are as before.
fn others_unchanged(text: &str, name: &str) {
    for other in ["P1", "P2", "P3", "LP", "CH1", "CH2"].into_iter().filter(|one| *one != name) {
        assert_eq!(station(text, other), station(TEXT, other), "{other}\n{text}");
    }
}

#[test]
fn an_edit_of_a_part_changes_the_table_of_the_part() {
    let to = Vector3::new(0.001, -0.702, 0.5);
    let moved = set_station(TEXT, "LP", &[Change::Position(to), Change::ProcessTime(3.0)]).unwrap();
    assert_eq!((place(&moved, "LP").x, place(&moved, "LP").y), (to.x, to.y));
    assert_eq!(station(&moved, "LP").process_time, 3.0);
    others_unchanged(&moved, "LP");
    let level = set_station(TEXT, "LP", &[Change::Tilt(Tilt::LEVEL)]).unwrap();
    assert_eq!(tilt(&level, "LP"), 0.0);
    others_unchanged(&level, "LP");
    let noted = note_station(TEXT, "LP", &[["a".to_owned(), "b".to_owned()]]).unwrap();
    assert!(
        noted.contains("# Taught in contact: a and b.\n[[part]]\npart = \"load-port\""),
        "{noted}"
    );
}

#[test]
fn an_edit_of_inherited_values_changes_the_station_and_not_its_template() {
    // P2 takes the carrier axis of P1; it moves as a whole.
    let to = Vector3::new(0.01, 0.71, 0.5);
    let moved = set_station(TEXT, "P2", &[Change::Position(to)]).unwrap();
    assert!((place(&moved, "P2") - to).norm() < 1e-12);
    assert!(matches!(station(&moved, "P2").origin, Origin::CarrierAxis(_)));
    assert!((tilt(&moved, "P2") - tilt(TEXT, "P2")).abs() < 1e-9);
    others_unchanged(&moved, "P2");
    let level = set_station(TEXT, "P2", &[Change::Tilt(Tilt::LEVEL)]).unwrap();
    assert_eq!((tilt(&level, "P2"), station(&level, "P2").slots), (0.0, 5));
    others_unchanged(&level, "P2");
    // Taught points in place of the inherited ones, with their noise.
    let text = TEXT.replace("like = \"P1\"", "like = \"LP2\"").replace(
        "name = \"P2\"",
        "name = \"P2\"\nslots = 1\nstroke = { below_mm = 4, above_mm = 3, speed_mm_s = 20 }",
    ) + "[[template]]\nname = \"LP2\"\nposition_mm = [0, 650, 500]\nretract_mm = 10\ntaught = { points_mm = [[0, 750, 500], [100, 650, 500], [-100, 650, 500]], noise_um = 3 }\n";
    let points = [[0.0, 0.75, 0.5], [0.1, 0.65, 0.5], [-0.1, 0.65, 0.5001]].map(Vector3::from);
    let change = Change::Taught { points: points.to_vec(), threshold: 1e-4, noise: None };
    let taught = set_station(&text, "P2", std::slice::from_ref(&change)).unwrap();
    let Origin::Taught(found) = station(&taught, "P2").origin else { panic!("{taught}") };
    let plane = found.plane.unwrap();
    assert_eq!(plane.points, points);
    assert_eq!(plane.agreement.noise.unwrap(), [3e-6; 3]);
    let Change::Taught { points, threshold, .. } = change else { panic!() };
    let noise = Some(TaughtNoise::Equal(1e-6));
    let change = Change::Taught { points, threshold, noise };
    assert!(set_station(&text, "P2", &[change]).unwrap().contains("noise_um = 1"));
}

#[test]
fn copies_expressions_and_parts_that_are_no_stations_are_refused() {
    let refused = |name: &str, change: Change, message: &str| {
        let found = set_station(TEXT, name, &[change]).unwrap_err().to_string();
        assert!(found.contains(message), "{found}");
    };
    let moved = || Change::Position(Vector3::new(0.1, 0.2, 0.3));
    refused("CH2", moved(), "the station \"CH2\" is a copy of \"CH\"");
    refused("CH", moved(), "station \"CH\" is not known");
    refused("P3", moved(), "`position_mm` of the station \"P3\" is an expression");
    let place = set_station(TEXT, "P3", &[moved()]).unwrap_err().place;
    let line = TEXT.lines().nth(place.line - 1).unwrap();
    assert_eq!(&line[place.column - 1..], "[\"-reach\", 0, 500]");
    refused("SV", moved(), "station \"SV\" is not known");
    refused("port", moved(), "station \"port\" is not known");
    let noise = Some(TaughtNoise::Sensor("prob".to_owned()));
    let references = Change::References { references: Vec::new(), noise };
    refused("P1", references, "sensor \"prob\" is not known");
    // Another value of the same station can be changed.
    let turned = set_station(TEXT, "P3", &[Change::Heading(1.0)]).unwrap();
    assert!(turned.contains("[\"-reach\", 0, 500]"));
    others_unchanged(&turned, "P3");
}
