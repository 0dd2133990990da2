//! Shapes and frames of cell files: boxes with openings, tilts as measured, slots that are displaced.

#![expect(clippy::unwrap_used, reason = "a test may fail at this place")]

use jointplay_cell::EntityId;
use jointplay_cell::check::{CheckOptions, Report, check};
use jointplay_cell::program::expand;
use jointplay_cell::trajectory::{TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::Tilt;
use jointplay_format::cell::{EXAMPLE, read};
use jointplay_format::program;
use nalgebra::Vector3;

fn no_files(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("there is no {name}"))
}

/// The example with a part replaced.
fn changed(from: &str, to: &str) -> Result<Cell, String> {
    assert!(EXAMPLE.contains(from), "{from:?} is not in the file");
    read(&EXAMPLE.replacen(from, to, 1), &mut no_files).map_err(|errors| errors.to_string())
}

const LP2_TILT: &str = "tilt = { yaw_deg = 100.0, pitch_deg = 0.8 }";

#[test]
fn a_tilt_measured_about_x_and_y_is_the_rotation_vector_in_the_base_plane() {
    let tilt = |keys: &str| {
        let cell = changed(LP2_TILT, &format!("tilt = {{ {keys} }}")).unwrap();
        Tilt::from_normal(&(cell.stations[1].base_from_station.rotation * Vector3::z()))
    };
    // 0.6° about y and 0.3° about x: √(0.6² + 0.3²) toward atan2(−0.3, 0.6).
    let measured = tilt("x_deg = 0.3, y_deg = 0.6");
    assert!((measured.pitch.to_degrees() - 0.670_820_393_249_937).abs() < 1e-12, "{measured:?}");
    assert!((measured.yaw.to_degrees() + 26.565_051_177_077_99).abs() < 1e-9, "{measured:?}");
    // A rotation about +y tilts the normal toward +x.
    let about_y = tilt("y_deg = 0.6");
    assert!(about_y.yaw.abs() < 1e-12 && (about_y.pitch.to_degrees() - 0.6).abs() < 1e-12);
    let refused = |keys: &str, message: &str| {
        let found = changed(LP2_TILT, &format!("tilt = {{ {keys} }}")).unwrap_err();
        assert!(found.contains(message), "{found}");
    };
    refused("x_deg = 0.3, pitch_deg = 0.6", "either `yaw_deg` and `pitch_deg`, or `x_deg`");
    refused("x_deg = 89, y_deg = 89", "amount to a tilt by 125.865");
    refused("x_deg = 0.1, z_deg = 0.1", "unknown key `z_deg`");
    refused("x_deg = 1.2, y_deg = 1.0", "tilts 1.562° toward -50.2°");
}

#[test]
fn displaced_slots_stay_level_and_follow_the_step() {
    let pitch = "pitch_mm = 10.0";
    let step = changed(pitch, "pitch_mm = 10.0\nslot_step_mm = [0.2, -0.1]").unwrap();
    let plain = changed(pitch, pitch).unwrap();
    let [step, plain] = [&step, &plain].map(|cell| &cell.stations[0]);
    for slot in 1..=25 {
        let (found, before) = (step.slot_frame(slot), plain.slot_frame(slot));
        assert_eq!(found.rotation, before.rotation);
        let shift = before.inverse_transform_point(&found.translation.vector.into());
        let expected = Vector3::new(0.2e-3, -0.1e-3, 0.0) * (slot as f64 - 1.0);
        assert!((shift.coords - expected).norm() < 1e-15, "{slot}: {shift}");
    }
}

/// The four bodies of the slit wall of the example.
fn slit_wall() -> &'static str {
    let from = EXAMPLE.find("[[body]]\nname = \"slit-below\"").unwrap();
    let to = from + EXAMPLE[from..].find("\n# The wall of the cell").unwrap();
    &EXAMPLE[from..to]
}

/// A box with the same slit, displaced along y.
fn one_wall(shift_mm: f64) -> Cell {
    let wall = format!(
        "[[body]]\nname = \"slit\"\nposition_mm = [560.0, 0.0, 625.0]\nbox = {{ size_mm = [20.0, 500.0, 450.0], openings = [{{ position_mm = [0, {shift_mm}, 0], size_mm = [30.0, 360.0, 50.0] }}] }}\n"
    );
    changed(slit_wall(), &wall).unwrap()
}

fn checked(cell: &Cell) -> Report {
    let steps = program::parse("HOME\nTRANSFER LP1 SLOT 1 TO PM1 WITH A\nHOME\n").unwrap();
    let steps = expand(cell, &steps).unwrap();
    let trajectory = plan_trajectory(cell, steps, &TrajectoryOptions::default()).unwrap();
    check(cell, &trajectory, &CheckOptions::default())
}

#[test]
fn a_wall_with_an_opening_is_checked_as_its_four_boxes() {
    let four = changed(slit_wall(), slit_wall()).unwrap();
    let one = one_wall(0.0);
    assert_eq!(four.bodies.len(), one.bodies.len() + 3);
    let (four_report, one_report) = (checked(&four), checked(&one));
    assert!(one_report.violations.is_empty(), "{:#?}", one_report.violations);
    // The least distance of each body of the robot from the wall is that from the nearest of the four.
    let of_slit = |cell: &Cell, entity: EntityId| cell.entity_name(entity).starts_with("slit");
    let nearest = |cell: &Cell, report: &Report| {
        let with_slit = |pair: &[EntityId; 2]| pair.iter().any(|&entity| of_slit(cell, entity));
        let all = report.distances.iter().filter(|found| with_slit(&found.entities));
        all.map(|found| found.distance).fold(f64::INFINITY, f64::min)
    };
    let (by_four, by_one) = (nearest(&four, &four_report), nearest(&one, &one_report));
    assert!(by_four.is_finite() && (by_four - by_one).abs() < 1e-9, "{by_four} {by_one}");
    let count = one_report.distances.iter().filter(|found| {
        found.entities.iter().any(|&entity| of_slit(&one, entity))
            && found.entities.iter().any(|&entity| one.entity_name(entity) == "blade-A")
    });
    assert!(count.count() <= 1, "the four boxes are one body in the report");
}

#[test]
fn a_displaced_opening_is_a_collision_with_the_one_body() {
    let cell = one_wall(60.0);
    let report = checked(&cell);
    let hits: Vec<String> =
        report.violations.iter().map(|violation| violation.describe(&cell)).collect();
    assert!(hits.iter().any(|hit| hit.contains("slit")), "{hits:#?}");
}

#[test]
fn invalid_openings_are_reported_with_their_place() {
    let wall = "box = { size_mm = [600.0, 20.0, 1000.0] }";
    let refused = |openings: &str, message: &str| {
        let text = format!("box = {{ size_mm = [600.0, 20.0, 1000.0], openings = {openings} }}");
        let found = changed(wall, &text).unwrap_err();
        assert!(found.contains(message), "{found}");
    };
    refused(
        "[{ size_mm = [1, 1, 1] }, { position_mm = [0, 900, 0], size_mm = [1, 1, 1] }]",
        "opening 2 has no common interior with the box",
    );
    refused("[{ size_mm = [600, 20, 1000] }]", "remove all of it");
    refused("[{ size_mm = [1, 1] }]", "`size_mm` has 2 entries, but needs 3");
    refused("[{ size = [1, 1, 1] }]", "did you mean `size_mm`?");
    refused("3", "has to be a list");
    let safe = "rule = \"safe\"\nposition_mm = [0.0, 0.0, 600.0]\ncylinder = { radius_mm = 60.0, height_mm = 700.0 }";
    let opened = "rule = \"safe\"\nposition_mm = [0.0, 0.0, 600.0]\nbox = { size_mm = [90, 90, 700], openings = [{ size_mm = [1, 1, 1] }] }";
    let found = changed(safe, opened).unwrap_err();
    assert!(found.contains("a safe zone has no openings"), "{found}");
}
