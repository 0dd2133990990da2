//! Deflections that the platform compensates, and the remaining ones.
#![expect(clippy::unwrap_used, reason = "a test may fail at this place")]

use jointplay_cell::check::{CheckOptions, check};
use jointplay_cell::program::expand;
use jointplay_cell::trajectory::{TrajectoryOptions, plan_trajectory};
use jointplay_format::display_units::DisplayUnits;
use jointplay_format::{cell, program};
use jointplay_report::{self as report, CellReport};

const PROGRAM: &str = "GET LP1 SLOT 1 WITH A\nPUT LP2 SLOT 3 WITH A\nHOME\n";

fn report(changes: &[(&str, &str)]) -> CellReport {
    let mut text = cell::EXAMPLE.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let cell = cell::read(&text, &mut |_| Err("no files".to_owned())).unwrap();
    let steps = expand(&cell, &program::parse(PROGRAM).unwrap()).unwrap();
    let motion = plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap();
    report::cell(
        &cell,
        PROGRAM,
        &motion,
        &check(&cell, &motion, &CheckOptions::default()),
        DisplayUnits::Metric,
    )
}

#[test]
fn compensated_droop_and_sag_are_reported() {
    let report = report(&[]);
    let all = report.compensated.unwrap();
    assert_eq!(all.handoffs, 2);
    // By the cantilever's formula, at the reach of LP1 with the wafer's 127.6 g: E I = 1500 N m², 2.5 kg/m, 0.7 m.
    let (own, tip, reach, stiffness) = (2.5 * 9.806_65, 0.127_6 * 9.806_65, 0.7_f64, 1500.0);
    let drop = reach.powi(3) * (own * reach / 8.0 + tip / 3.0) / stiffness;
    let slope = reach.powi(2) * (own * reach / 6.0 + tip / 2.0) / stiffness;
    assert!((all.droop_um * 1e-6 / drop - 1.0).abs() < 0.02, "{all:?} {drop}");
    assert!((all.slope_mrad * 1e-3 / slope - 1.0).abs() < 0.02, "{all:?} {slope}");
    assert!(all.residual_um < 1e-5 && all.residual_mrad < 1e-8, "{all:?}");
    // The remaining shape of the wafer does not depend on the platform.
    assert!(all.sag_um > 10.0 && all.residual_sag_um > 5.0, "{all:?}");
    let by_instruction: Vec<usize> = report
        .instructions
        .iter()
        .map(|one| one.compensated.as_ref().map_or(0, |some| some.handoffs))
        .collect();
    assert_eq!(by_instruction, [1, 1, 0]);
}

#[test]
fn deviations_beyond_the_tilt_limit_are_reported_where_the_budget_allows_them() {
    // The port tilts inward nearly as far as the platform can; the slope of the arm would have to be added.
    let report = report(&[
        (
            "tilt = { azimuth_deg = 100.0, angle_deg = 0.8 }",
            "tilt = { azimuth_deg = 45.0, angle_deg = 1.49 }",
        ),
        ("plane_urad = 20.0", "plane_urad = 2000.0"),
    ]);
    let put = report.instructions[1].compensated.as_ref().unwrap();
    let missing = 1.49_f64.to_radians() * 1e3 + put.slope_mrad - 1.5_f64.to_radians() * 1e3;
    assert!(missing > 0.9 && (put.residual_mrad - missing).abs() < 0.01, "{put:?} {missing}");
    assert!(report.instructions[0].compensated.as_ref().unwrap().residual_mrad < 1e-8);
    assert_eq!(report.compensated.unwrap().residual_mrad, put.residual_mrad);
}
