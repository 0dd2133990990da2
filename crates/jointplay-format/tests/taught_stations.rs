//! Taught stations of cell files: noise, sensors, reference points, stated uncertainty, and the checks that use them.

use jointplay_cell::check::{Report, ViolationKind};
use jointplay_cell::station::teach::FitResult;
use jointplay_cell::station::{Origin, SlotId, Station};
use jointplay_cell::workcell::Cell;
use jointplay_cell::{IncrementalPlanner, PlanOptions};
use jointplay_format::cell::{EXAMPLE, read};
use jointplay_format::program::parse;

/// The example with other taught points of PM1.
fn text(taught: &str) -> String {
    let start = EXAMPLE.find("taught = {").unwrap();
    let end = start + EXAMPLE[start..].find("] }").unwrap() + 3;
    format!("{}taught = {{ {taught} }}{}", &EXAMPLE[..start], &EXAMPLE[end..])
}

fn cell(text: &str) -> Result<Cell, String> {
    read(text, &mut |_| Err("no files".to_owned())).map_err(|errors| errors.to_string())
}

fn station(taught: &str) -> Station {
    cell(&text(taught)).unwrap().stations[3].clone()
}

const PLANE: &str =
    "points_mm = [[800, 0, 620], [700, 100, 620], [600, 0, 620], [700, -100, 620], [770, 70, 620]]";

#[test]
fn noise_is_that_of_all_points_of_each_or_of_a_sensor() {
    let plane = |taught: &str| match &station(taught).origin {
        Origin::Taught(taught) => taught.plane.clone().unwrap(),
        _ => panic!("not taught"),
    };
    assert_eq!(plane(&format!("noise_um = 2, {PLANE}")).agreement.noise.unwrap(), [2e-6; 5]);
    let each = plane(&format!("noise_um = [2, 2, 4, 2, 8], {PLANE}"));
    assert_eq!(each.agreement.noise.unwrap(), [2e-6, 2e-6, 4e-6, 2e-6, 8e-6]);
    let sensors = "[[sensor]]\nname = \"probe\"\nnoise_um = 3\n\n[[sensor]]\nname = \"laser\"\nnoise_um = 1\n";
    let with = |taught: &str| text(taught).replacen("[wafer]", &format!("{sensors}\n[wafer]"), 1);
    let sensor = cell(&with(&format!(
        "sensor = [\"probe\", \"probe\", \"laser\", \"probe\", \"probe\"], {PLANE}"
    )));
    let Origin::Taught(taught) = &sensor.unwrap().stations[3].origin else { panic!() };
    assert_eq!(
        taught.plane.as_ref().unwrap().agreement.noise.as_ref().unwrap()[1..3],
        [3e-6, 1e-6]
    );
    let unknown = cell(&with(&format!("sensor = \"prob\", {PLANE}"))).unwrap_err();
    assert!(unknown.contains("did you mean") && unknown.contains("probe"), "{unknown}");
}

#[test]
fn references_move_and_turn_the_station() {
    // Wafer centre 0.2 mm farther out, and a pin at (0, 100) that shows a rotation by 1 mrad.
    let found = station(
        "reference_noise_um = 20, references = [{ measured_mm = [700.2, 0.1, 620] }, { station_mm = [0, 100], measured_mm = [800.2, 0.2, 620] }]",
    );
    let origin = found.base_from_station.translation.vector;
    assert!((origin.x - 0.7002).abs() < 1e-7 && (origin.y - 0.0001).abs() < 1e-7, "{origin}");
    let inward = found.base_from_station.rotation * nalgebra::Vector3::y();
    assert!((inward.y - 1e-3).abs() < 1e-6, "{inward}");
    assert_eq!(found.uncertainty.known, [true, true, false, false, false, true]);
    let Origin::Taught(taught) = &found.origin else { panic!() };
    assert_eq!(taught.references.as_ref().unwrap().agreement.result, FitResult::Untested);
    // Nominal parts can have a stated uncertainty.
    let stated = text("references = [{ measured_mm = [700.2, 0.1, 620] }]").replacen(
        "retract_mm",
        "uncertainty = { lateral_um = 30, height_um = 10, tilt_urad = 8 }\nretract_mm",
        1,
    );
    let found = cell(&stated).unwrap().stations[0].uncertainty;
    assert_eq!(found.known, [true, true, true, true, true, false]);
    assert!((found.tilt_deviation().unwrap() - 8e-6).abs() < 1e-18);
}

#[test]
fn invalid_taught_points_name_the_place_the_reason_and_what_works() {
    for (taught, expected) in [
        (
            "points_mm = [[800, 0, 620], [700, 0, 620], [600, 0, 620]]",
            &["from one line", "best near 700, "][..],
        ),
        (
            "points_mm = [[800, 0, 620], [700, 0, 620], [800, 0, 620]]",
            &["points 1 and 3 have the same coordinates"],
        ),
        (&format!("noise_um = 0, {PLANE}"), &["noise_um", "positive"]),
        (&format!("noise_um = [2, 2], {PLANE}"), &["noise_um", "2", "5, one for each point"]),
        (&format!("noise_um = 2, sensor = \"probe\", {PLANE}"), &["both state the noise"]),
        ("threshold_um = 50", &["points_mm", "references"]),
        ("references = [{ station_mm = [1, 2, 3], measured_mm = [700, 0, 620] }]", &["station_mm"]),
        (
            "noise_um = 5, points_mm = [[800, 0, 620], [700, 100, 620], [600, 0, 620.08], [700, -100, 620], [770, 70, 620], [630, 70, 620]]",
            &["taught point 3 deviates most", "measure this point again"],
        ),
    ] {
        let error = cell(&text(taught)).unwrap_err();
        for part in expected {
            assert!(error.contains(part), "{part}: {error}");
        }
    }
}

fn checked(text: &str) -> (Cell, Report) {
    let cell = cell(text).unwrap();
    let program =
        parse("HOME\nTRANSFER LP1 SLOT 3 TO PM1 WITH A\nTRANSFER PM1 TO LP1 SLOT 3 WITH A\n")
            .unwrap();
    let (_, report) =
        IncrementalPlanner::default().plan(&cell, &program, &PlanOptions::default()).unwrap();
    (cell, report)
}

#[test]
fn uncertain_planes_violate_the_plane_budget() {
    let of = |report: &Report| {
        let found = report.violations.iter().filter(|one| one.kind == ViolationKind::PlaneBudget);
        found.map(|one| one.worst).collect::<Vec<_>>()
    };
    let (_, report) = checked(EXAMPLE);
    assert!(report.violations.is_empty(), "{:?}", report.violations);
    // With 3 instead of 1.5 µm of noise, twice the deviation of the tilt is above 20 µrad.
    let noisy = EXAMPLE.replacen("noise_um = 1.5", "noise_um = 3", 1);
    let (cell, report) = checked(&noisy);
    let expanded = 2.0 * cell.stations[3].uncertainty.tilt_deviation().unwrap();
    assert!(expanded > 20e-6);
    let found = of(&report);
    assert_eq!(found.len(), 2, "placed and picked: {:?}", report.violations);
    assert!(found.iter().all(|worst| (worst - expanded).abs() < 1e-9), "{found:?}");
    let accepted =
        noisy.replacen("virtual_joint_norm_um", "coverage_factor = 1\nvirtual_joint_norm_um", 1);
    assert!(of(&checked(&accepted).1).is_empty());
}

#[test]
fn uncertain_carriers_need_more_slot_clearance_at_the_far_slot() {
    // 300 µrad of tilt move slot 25 by 0.07 mm sideways and its edge by 0.05 mm.
    let stated = EXAMPLE.replacen(
        "retract_mm",
        "uncertainty = { lateral_um = 50, height_um = 50, tilt_urad = 300 }\nretract_mm",
        1,
    );
    let cell = cell(&stated).unwrap();
    let margins = cell.slot_margins(&cell.stations[0]);
    assert!(margins[24] > margins[0] + 2.0 * 0.02e-3, "{margins:?}");
    let edge = 2.0 * (50e-6_f64.powi(2) + (0.15_f64 * 300e-6).powi(2)).sqrt();
    assert!((margins[0] - edge).abs() < 1e-9, "{} {edge}", margins[0]);
    assert_eq!(
        cell.slot_margin(SlotId { station: 3, slot: 1 }),
        cell.slot_margins(&cell.stations[3])[0]
    );
    // A clearance that is just kept by the exact station is not by the uncertain one; the remaining budgets hold.
    let wide = |text: &str| text.replacen("plane_urad = 20.0", "plane_urad = 2000.0", 1);
    // The distances in the slots, from the violations of a clearance that no slot has.
    let (_, report) = checked(&wide(EXAMPLE).replacen(
        "slot_min_distance_mm = 1.0",
        "slot_min_distance_mm = 9.0",
        1,
    ));
    let in_slots = report.violations.iter().filter(|one| one.kind == ViolationKind::SlotClearance);
    let distance = in_slots.map(|one| one.worst).fold(f64::INFINITY, f64::min);
    let close = |text: &str| {
        let budget = format!("slot_min_distance_mm = {}", distance * 1e3 - 0.02);
        wide(text).replacen("slot_min_distance_mm = 1.0", &budget, 1)
    };
    let slot_violations = |report: &Report| {
        report.violations.iter().filter(|one| one.kind == ViolationKind::SlotClearance).count()
    };
    assert_eq!(slot_violations(&checked(&close(EXAMPLE)).1), 0);
    assert!(slot_violations(&checked(&close(&stated)).1) > 0);
}
