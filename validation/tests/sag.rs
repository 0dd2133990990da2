//! Wafers that sag and arms that droop: other methods find the same.
//!
//! Provenance and the reasons for the tolerances: `validation/golden/README.md`.

use jointplay::cell::wafer::{Droop, Material, Sag, Support, Wafer, sag};
use jointplay_validation::{Row, golden};

/// Of heights, in q a⁴/D; on its edge the plate hangs 0.07 of it.
const OF_HEIGHT: f64 = 3e-6;
/// Of the highest and the lowest place, which are looked for on a grid, in q a⁴/D.
const OF_EXTREME: f64 = 1.5e-5;
/// Of the value.
const OF_DROOP: f64 = 1e-9;
/// A beam's gravity (m/s²).
const GRAVITY: f64 = 9.80665;

/// A silicon wafer of 300 mm, and the unit that its golden heights count in (m).
fn wafer(poisson: f64) -> (Wafer, f64) {
    let material = Material { name: "silicon".into(), young: 148e9, poisson, density: 2329.0 };
    let wafer = Wafer { diameter: 0.3, thickness: 775e-6, material };
    let unit = wafer.weight_per_area(GRAVITY) * 0.15_f64.powi(4) / wafer.flexural_rigidity();
    (wafer, unit)
}

fn found(row: &Row) -> (Sag, f64) {
    let at = row.number("at").unwrap() * 0.15;
    let support = match row.text("support") {
        "edge" => Support::Edge,
        "three-points" => Support::ThreePoints { radius: at },
        "two-rails" => Support::TwoRails { distance: 2.0 * at },
        other => panic!("unknown support {other:?}"),
    };
    let (wafer, unit) = wafer(row.number("poisson").unwrap());
    (sag(&wafer, &support, GRAVITY).unwrap(), unit)
}

#[test]
fn wafers_sag_as_the_energy_of_polynomials_has_it() {
    let rows = golden("sag.csv");
    assert_eq!(rows.len(), 20);
    for row in &rows {
        let (sag, unit) = found(row);
        for (column, found, tolerance) in [
            ("center", sag.center, OF_HEIGHT),
            ("mean", sag.plane_height, OF_HEIGHT),
            ("deviation", sag.deviation, OF_HEIGHT),
            ("lowest", sag.lowest, OF_EXTREME),
            ("highest", sag.highest, OF_EXTREME),
        ] {
            let off = (found / unit - row.number(column).unwrap()).abs();
            let (support, at) = (row.text("support"), row.text("at"));
            assert!(off <= tolerance, "{support} {at}: {column} is off by {off:e} q a⁴/D");
        }
    }
}

#[test]
fn arms_droop_as_the_boundary_value_problem_has_it() {
    let rows = golden("droop.csv");
    assert_eq!(rows.len(), 9);
    for row in &rows {
        let [stiffness, mass_per_length, load, reach, drop, slope] =
            ["stiffness", "mass_by_length", "load", "reach", "drop", "slope"]
                .map(|column| row.number(column).unwrap());
        let droop = Droop::Cantilever { stiffness, mass_per_length };
        let found = droop.deflection(reach, load, GRAVITY).unwrap();
        for (found, expected) in [(found.drop, drop), (found.slope, slope)] {
            let off = (found / expected - 1.0).abs();
            assert!(off <= OF_DROOP, "{load} {reach}: {found} is off by {off:e}");
        }
    }
}
